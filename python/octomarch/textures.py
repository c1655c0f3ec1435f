"""`Texture`: a colour at each point, as three expressions; checkers, stripes, noise, and pictures laid onto surfaces.

Expressions come before it (`expressions`, `functions`); a `materials.Material` takes a texture as its colour.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, Never, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._pixels import Picture, pixels
from octomarch._validate import AxisLike, Precision
from octomarch.choices import mix, smoothstep, where
from octomarch.expressions import Expression, ExpressionLike, coordinates, normals, operand
from octomarch.functions import absolute, atan2, clamp, floor, length, mod
from octomarch.noises import fractal_noise

Colorful: TypeAlias = "Texture | Sequence[ExpressionLike] | NDArray[Any]"
ColorExpression: TypeAlias = "ExpressionLike | Colorful"

_REPEAT, _HOLD, _REPEAT_ALONG_U = 1, 0, 2  # as in nodes.def


class Texture:
    """A colour at each point: three expressions, one for each of linear red, green and blue.

    Textures combine like numbers: ``a + b``, ``a - b``, ``a * b`` with textures, colours, expressions and numbers,
    component by component; `octomarch.mix` and `octomarch.where` choose between them. Below 0 a colour counts as 0.

    Parameters
    ----------
    red, green, blue : Expression or float
        Linear, of the position in the coordinates of the painted shape.

    Raises
    ------
    TypeError, ValueError
        If a component is neither a number nor an expression.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> rainbow = om.Texture(0.5 + 0.5 * om.sin(x), 0.5 + 0.5 * om.sin(y), 0.5)
    >>> rainbow.evaluate([0, 0, 0]).tolist()
    [0.5, 0.5, 0.5]
    >>> half = 0.5 * rainbow
    >>> om.sphere(1.0).paint(om.Material(color=half))
    <Shape paint, 16 nodes>
    """

    __slots__ = ("components",)
    __array_ufunc__ = None  # so that `array * texture` asks the texture, which takes three numbers

    components: tuple[Expression, Expression, Expression]
    """Red, green and blue."""

    def __init__(self, red: ExpressionLike, green: ExpressionLike, blue: ExpressionLike) -> None:
        names = ("red", "green", "blue")
        nodes = [operand(name, value) for name, value in zip(names, (red, green, blue), strict=True)]
        check.set_fields(self, components=tuple(Expression(node) for node in nodes))

    def __setattr__(self, name: str, value: object) -> Never:
        raise AttributeError(f"textures are immutable: cannot set {name!r}")

    def __delattr__(self, name: str) -> Never:
        raise AttributeError(f"textures are immutable: cannot delete {name!r}")

    def __copy__(self) -> Texture:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Texture:
        return self

    def __eq__(self, other: object) -> bool:
        return self.components == other.components if isinstance(other, Texture) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.components)

    def __repr__(self) -> str:
        return f"<Texture {', '.join(component._node.kind for component in self.components)}>"

    def __add__(self, other: ColorExpression) -> Texture:
        return _combined("add", self, other)

    def __radd__(self, other: ColorExpression) -> Texture:
        return _combined("add", other, self)

    def __sub__(self, other: ColorExpression) -> Texture:
        return _combined("subtract", self, other)

    def __rsub__(self, other: ColorExpression) -> Texture:
        return _combined("subtract", other, self)

    def __mul__(self, other: ColorExpression) -> Texture:
        return _combined("multiply", self, other)

    def __rmul__(self, other: ColorExpression) -> Texture:
        return _combined("multiply", other, self)

    def evaluate(
        self,
        points: ArrayLike,
        *,
        precision: Precision = "float64",
        threads: int | None = None,
        isa: str | None = None,
    ) -> NDArray[np.floating[Any]]:
        """Return the colours at points, shape (..., 3); see `Expression.evaluate`.

        Examples
        --------
        >>> import octomarch as om
        >>> om.checker(0, 1).evaluate([[0, 0, 0], [1, 0, 0]]).tolist()
        [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]
        """
        planes = [c.evaluate(points, precision=precision, threads=threads, isa=isa) for c in self.components]
        return np.stack(planes, axis=-1)


def is_colorful(value: object) -> bool:
    """Tell whether `value` has three components, and is no single number."""
    return isinstance(value, Texture) or (np.iterable(value) and not isinstance(value, str))


def texture(name: str, value: object) -> Texture:
    """Return what is taken for a colour as a texture: one, a number or expression (grey), or three of them."""
    if isinstance(value, Texture):
        return value
    if isinstance(value, Expression) or check.is_number(value):
        grey = Expression(operand(name, value))
        return Texture(grey, grey, grey)
    items = check.sequence(name, value, "a texture, or one or three numbers or expressions")
    if len(items) != 3:
        raise ValueError(f"{name} must have three components, got {check.shown(value)}")
    red, green, blue = (Expression(operand(f"{name}[{i}]", item)) for i, item in enumerate(items))
    return Texture(red, green, blue)


def checker(a: ColorExpression, b: ColorExpression, size: float | Sequence[float | None] = 1.0) -> Texture:
    """Return cubes of two textures in turn, as on a chessboard.

    Parameters
    ----------
    a, b : Texture, or one or three numbers or expressions
        `a` fills the cube about the origin.
    size : float or sequence of three floats
        Edges along x, y and z, > 0; None for an axis without change: ``(1, None, 1)`` makes a floor's pattern whatever
        its height. One number serves all axes.

    Returns
    -------
    Texture

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or no axis changes.

    Examples
    --------
    >>> import octomarch as om
    >>> tiles = om.checker((0.9, 0.9, 0.9), 0.1, size=(0.5, None, 0.5))
    >>> tiles.evaluate([[0, 7, 0], [0.5, 7, 0]]).tolist()
    [[0.9, 0.9, 0.9], [0.1, 0.1, 0.1]]
    """
    edges = [size] * 3 if not np.iterable(size) else check.sequence("size", size, "one number or three")
    if len(edges) != 3:
        raise ValueError(f"size must be one number or three, got {check.shown(size)}")
    cells = [
        floor(point / check.positive("size", edge) + 0.5)
        for point, edge in zip(coordinates(), edges, strict=True)
        if edge is not None
    ]
    if not cells:
        raise ValueError(f"size must hold a number, got {check.shown(size)}")
    total = cells[0]
    for cell in cells[1:]:
        total = total + cell
    return where(mod(total, 2.0), texture("b", b), texture("a", a))


def stripes(
    a: ColorExpression, b: ColorExpression, width: float = 1.0, axis: AxisLike = "x", soft: float = 0.0
) -> Texture:
    """Return layers of two textures in turn.

    Parameters
    ----------
    a, b : Texture, or one or three numbers or expressions
        `a` fills the layer about the origin.
    width : float
        Of each layer in scene units, > 0.
    axis : {"x", "y", "z"} or sequence of three floats
        Across the layers, of any length but zero.
    soft : float
        Share of the width over which a layer passes into the next, 0 (hard edges) to 1.

    Returns
    -------
    Texture

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> om.stripes(0, 1, width=0.5).evaluate([[0.2, 0, 0], [0.3, 0, 0], [0.8, 0, 0]]).tolist()
    [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]
    """
    step, softness = check.positive("width", width), check.fraction("soft", soft)
    across = [component / step for component in check.direction("axis", check.axis("axis", axis))]
    terms = [factor * point for factor, point in zip(across, coordinates(), strict=True) if factor]
    along = terms[0]
    for term in terms[1:]:
        along = along + term
    # |w| runs from 0 in the middle of a's layers to 1 in the middle of b's
    distance = absolute(along - 2.0 * floor(along / 2.0 + 0.5))
    if softness == 0:
        return where(distance < 0.5, texture("a", a), texture("b", b))
    weight = smoothstep(0.5 - 0.5 * softness, 0.5 + 0.5 * softness, distance)
    return mix(texture("a", a), texture("b", b), weight)


def noise_texture(
    a: ColorExpression, b: ColorExpression, size: float = 1.0, octaves: int = 4, seed: int = 0
) -> Texture:
    """Return clouds of two textures: their mix by `octomarch.fractal_noise`.

    Parameters
    ----------
    a, b : Texture, or one or three numbers or expressions
        `a` is seen where the noise is -1 or less, `b` where it is 1 or more.
    size : float
        Of the largest clouds in scene units, > 0.
    octaves, seed : int
        As for `octomarch.fractal_noise`.

    Returns
    -------
    Texture

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> om.noise_texture(0, 1, size=0.5).evaluate([0.5, 1, -2]).tolist()
    [0.5, 0.5, 0.5]
    """
    unit = check.positive("size", size)
    x, y, z = (point / unit for point in coordinates())
    weight = clamp(0.5 + 0.5 * fractal_noise(x, y, z, octaves=octaves, seed=seed), 0.0, 1.0)
    return mix(texture("a", a), texture("b", b), weight)


def image_texture(
    source: Picture,
    mapping: Literal["planar", "spherical", "triplanar"] = "planar",
    *,
    size: float | Sequence[float] | None = None,
    axis: Literal["x", "y", "z"] | None = None,
    wrap: Literal["repeat", "clamp"] | None = None,
    sharpness: float | None = None,
) -> Texture:
    """Return a picture laid onto space, looked up bilinearly.

    ===========  ===================================================================================================
    planar       along `axis`, as a slide projector does; seen upright from the side the axis points to
    spherical    by longitude and latitude about `axis`: the picture's middle lies where the next axis points (z for
                 "y", x for "z", y for "x"), its seam on the other side
    triplanar    from the three axes at once, each weighted by the share of the surface's normal along it, raised to
                 `sharpness`; for materials only
    ===========  ===================================================================================================

    Parameters
    ----------
    source : path or ndarray
        An EXR file (linear), a PNG or JPEG file (sRGB), or an array (height, width, 3) or (height, width) of linear
        floats or sRGB bytes, row 0 at the top.
    mapping : {"planar", "spherical", "triplanar"}
        Where each part of the picture lies.
    size : float or (float, float), optional
        Width and height of the picture in scene units, > 0, about the origin; a single number is the width and keeps
        the picture's proportions. None: 1. Planar and triplanar only.
    axis : {"x", "y", "z"}, optional
        None: "z" for planar, "y" for spherical. Triplanar has none.
    wrap : {"repeat", "clamp"}, optional
        What lies beyond the picture: the picture again (None as well), or its edge drawn out. Planar and triplanar.
    sharpness : float, optional
        1 (wide blends between the three pictures) to 64 (narrow ones). None: 4. Triplanar only.

    Returns
    -------
    Texture

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or the mapping has no use for it.
    OSError
        If the file cannot be opened, is of another kind or damaged.

    Examples
    --------
    >>> import numpy as np, octomarch as om
    >>> picture = np.array([[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
    >>> om.image_texture(picture, size=2).evaluate([[-0.5, 0, 9], [0, 0, 0], [0.5, 0, 0]]).tolist()
    [[1.0, 0.0, 0.0], [0.5, 0.0, 0.5], [0.0, 0.0, 1.0]]
    """
    check.choice("mapping", mapping, tuple(_OPTIONS))
    options = {"size": size, "axis": axis, "wrap": wrap, "sharpness": sharpness}
    for name, value in options.items():
        if value is not None and name not in _OPTIONS[mapping]:
            raise ValueError(f"{name} is not used by the {mapping} mapping, got {check.shown(value)}")
    colors = pixels("source", source)
    if mapping == "spherical":
        along = _AXES[check.choice("axis", "y" if axis is None else axis, tuple(_AXES))]
        return _looked_up(_core.image(colors), *_spherical(coordinates(), along), _REPEAT_ALONG_U)
    width, height = _size(size, colors.shape[1] / colors.shape[0])
    kinds = {"repeat": _REPEAT, "clamp": _HOLD}
    edges = kinds[check.choice("wrap", "repeat" if wrap is None else wrap, tuple(kinds))]
    image = _core.image(colors)
    point = coordinates()
    if mapping == "planar":
        along = _AXES[check.choice("axis", "z" if axis is None else axis, tuple(_AXES))]
        return _looked_up(image, *_planar(point, along, width, height), edges)
    exponent = 4.0 if sharpness is None else check.finite("sharpness", sharpness)
    if not 1 <= exponent <= 64:
        raise ValueError(f"sharpness must lie in [1, 64], got {check.shown(sharpness)}")
    weights = [absolute(component) ** exponent for component in normals()]
    total = weights[0] + weights[1] + weights[2]
    sides = [_looked_up(image, *_planar(point, i, width, height), edges) * (weights[i] / total) for i in range(3)]
    return sides[0] + sides[1] + sides[2]


def _size(size: float | Sequence[float] | None, aspect: float) -> tuple[float, float]:
    if size is None or check.is_number(size):
        width = check.positive("size", 1.0 if size is None else size)
        return width, width / aspect
    items = check.sequence("size", size, "one number or two")
    if len(items) != 2:
        raise ValueError(f"size must be one number or two, got {check.shown(size)}")
    return check.positive("size[0]", items[0]), check.positive("size[1]", items[1])


def _planar(point: Sequence[Expression], axis: int, width: float, height: float) -> tuple[Expression, Expression]:
    """Return (u, v) of a picture about the origin that is seen upright against `axis`, y up (−z up along y)."""
    x, y, z = point
    across, up = ((-z, y), (x, -z), (x, y))[axis]
    return across / width + 0.5, up / height + 0.5


def _spherical(point: Sequence[Expression], axis: int) -> tuple[Expression, Expression]:
    """Return (u, v) from longitude and latitude about `axis`, u growing to the right as seen from outside."""
    front, right, up = point[(axis + 1) % 3], point[(axis + 2) % 3], point[axis]
    longitude, latitude = atan2(right, front), atan2(up, length(right, front))
    return longitude * (0.5 / math.pi) + 0.5, latitude * (1.0 / math.pi) + 0.5


def _looked_up(image: _core.Node, u: Expression, v: Expression, wrap: int) -> Texture:
    channels = (Expression(_core.texel(image, u._node, v._node, channel, wrap)) for channel in range(3))
    return Texture(*channels)


def _combined(kind: str, a: ColorExpression, b: ColorExpression) -> Texture:
    """Return an operation for Python's operators, which ask the other operand where this one does not know it."""
    if not all(is_colorful(value) or isinstance(value, Expression) or check.is_number(value) for value in (a, b)):
        return cast("Texture", NotImplemented)
    pairs = zip(texture("the operand", a).components, texture("the operand", b).components, strict=True)
    return Texture(*(Expression(_core.expression(kind, [u._node, v._node])) for u, v in pairs))


_AXES = {"x": 0, "y": 1, "z": 2}
_OPTIONS = {
    "planar": ("size", "axis", "wrap"),
    "spherical": ("axis",),
    "triplanar": ("size", "wrap", "sharpness"),
}
