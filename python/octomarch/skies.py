"""What rays see that hit nothing: skies of a few colours, of gradients, of pictures, and of expressions of one's own.

Every sky is three expressions of the ray's unit direction, which stands in the place of the point (`textures` comes
before), and costs an evaluation for each ray that sees it; one colour costs none. A sky gives no light to surfaces, but
is seen in mirrors. `scene.Scene` takes one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._pixels import Picture, pixels
from octomarch._validate import ColorLike, Vec3, VectorLike
from octomarch.expressions import Expression, coordinates
from octomarch.functions import asin, atan2, clamp, length, maximum
from octomarch.textures import ColorExpression, Texture, texture

_UP: Vec3 = (0.0, 1.0, 0.0)


class _Sky:
    """What all skies have in common."""

    def texture(self) -> Texture:
        """Return the sky's colours as a texture whose point is the unit direction of a ray; see `Texture.evaluate`.

        Examples
        --------
        >>> import octomarch as om
        >>> om.Sky(toward=(0, 0, 1), away=0, base=0.5).texture().evaluate([0, 1, 0]).tolist()
        [0.5, 0.5, 1.5]
        """
        raise NotImplementedError

    def _native(self) -> _core.Sky:
        red, green, blue = (component._node for component in self.texture().components)
        return _core.Sky((red, green, blue))


@dataclass(frozen=True, init=False)
class Sky(_Sky):
    """A sky of two colours: ``toward * max(d·axis, 0) + away * max(-d·axis, 0) + base``.

    ``d`` is the unit direction of the ray.

    Parameters
    ----------
    axis : sequence of three floats
        Direction in which ``toward`` is seen, of any length but zero.
    toward, away, base : float or sequence of three floats
        Radiance along the axis, against it, and everywhere; linear RGB ≥ 0, one number means grey.
    clamped : bool
        False leaves out both ``max``: ``(toward - away) * d·axis + base``, and 0 where that is negative.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite or negative, or the axis is zero.

    Examples
    --------
    >>> import octomarch as om
    >>> om.Sky(toward=0, away=0, base=1).base
    (1.0, 1.0, 1.0)
    """

    axis: Vec3
    toward: Vec3
    away: Vec3
    base: Vec3
    clamped: bool

    def __init__(
        self,
        axis: VectorLike = _UP,
        toward: ColorLike = (0.05, 0.18, 0.40),
        away: ColorLike = (0.02, 0.02, 0.02),
        base: ColorLike = (0.40, 0.48, 0.58),
        clamped: bool = True,
    ) -> None:
        check.direction("axis", axis)
        check.set_fields(
            self,
            axis=check.vector("axis", axis),
            toward=check.color("toward", toward),
            away=check.color("away", away),
            base=check.color("base", base),
            clamped=check.flag("clamped", clamped),
        )

    def texture(self) -> Texture:  # noqa: D102  the base class says what it is
        along = _along(check.direction("axis", self.axis))
        ahead, behind = (maximum(along, 0), maximum(-along, 0)) if self.clamped else (along, -along)
        return texture("base", self.base) + _weighted(self.toward, ahead) + _weighted(self.away, behind)


@dataclass(frozen=True, init=False)
class ConstantSky(_Sky):
    """The same colour everywhere.

    Parameters
    ----------
    color : float or sequence of three floats
        Radiance, linear RGB ≥ 0; one number means grey.

    Raises
    ------
    TypeError, ValueError
        If the colour is of a wrong type, not finite or negative.

    Examples
    --------
    >>> import octomarch as om
    >>> scene = om.Scene(om.sphere(1.0), sky=om.ConstantSky(0))
    >>> om.render(scene, size=(16, 12)).color[0, 0].tolist()
    [0.0, 0.0, 0.0]
    """

    color: Vec3

    def __init__(self, color: ColorLike) -> None:
        check.set_fields(self, color=check.color("color", color))

    def texture(self) -> Texture:  # noqa: D102
        return texture("color", self.color)


@dataclass(frozen=True, init=False)
class GradientSky(_Sky):
    """Colours at elevations, and between them what lies between.

    Parameters
    ----------
    stops : iterable of (float, color)
        Elevations in degrees, from -90 (straight down) to 90 (straight up), each above the one before; each with its
        radiance, linear RGB ≥ 0, one number meaning grey. Between two stops the colour changes in proportion to the
        angle; beyond the outermost ones it stays.
    axis : sequence of three floats
        Where up is, of any length but zero.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or there is no stop.

    Examples
    --------
    >>> import octomarch as om
    >>> dusk = om.GradientSky([(-5, 0.05), (0, (0.9, 0.4, 0.1)), (30, (0.2, 0.2, 0.5)), (90, (0.02, 0.02, 0.1))])
    >>> dusk.texture().evaluate([0.5, 0.75**0.5, 0]).round(3).tolist()  # at 60 degrees
    [0.11, 0.11, 0.3]
    """

    stops: tuple[tuple[float, Vec3], ...]
    axis: Vec3

    def __init__(self, stops: Iterable[tuple[float, ColorLike]], axis: VectorLike = _UP) -> None:
        pairs = check.sequence("stops", stops, "a sequence of (elevation, color)")
        check.direction("axis", axis)
        check.set_fields(self, stops=_checked_stops(pairs), axis=check.vector("axis", axis))

    def texture(self) -> Texture:  # noqa: D102
        elevation = asin(clamp(_along(check.direction("axis", self.axis)), -1, 1)) * (180 / math.pi)
        (start, first), *rest = self.stops
        result = texture("stops", first)
        for end, color in rest:
            passed = clamp((elevation - start) / (end - start), 0, 1)
            result = result + _weighted(_difference(color, first), passed)
            start, first = end, color
        return result


@dataclass(frozen=True, init=False)
class EnvironmentMap(_Sky):
    """A picture all around: equirectangular, as panoramic cameras and many collections of surroundings make them.

    Its middle is seen along -z, its right half towards +x, its upper edge along +y: what a `PanoramicCamera` records
    that looks along -z.

    Parameters
    ----------
    image : path or ndarray
        An EXR file (linear), a PNG or JPEG file (sRGB), or an array (height, width, 3) or (height, width) of linear
        floats or sRGB bytes, row 0 at the top; usually twice as wide as high. It is read at once.
    rotation : float
        Degrees by which the surroundings are turned about the y axis, right-handed.
    intensity : float
        Factor of all colours, ≥ 0.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.
    OSError
        If the file cannot be opened, is of another kind or damaged.

    Examples
    --------
    >>> import numpy as np, octomarch as om
    >>> halves = np.array([[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]])  # blue on the left, red on the right
    >>> om.EnvironmentMap(halves, intensity=2).texture().evaluate([[-1, 0, 0], [1, 0, 0]]).tolist()
    [[0.0, 0.0, 2.0], [2.0, 0.0, 0.0]]
    """

    image: NDArray[np.float32] = field(repr=False, compare=False)
    rotation: float
    intensity: float
    _node: _core.Node = field(init=False, repr=False)

    def __init__(self, image: Picture, rotation: float = 0.0, intensity: float = 1.0) -> None:
        colors = pixels("image", image)
        colors.flags.writeable = False
        check.set_fields(
            self,
            _node=_core.image(colors),
            image=colors,
            rotation=check.finite("rotation", rotation),
            intensity=check.non_negative("intensity", intensity),
        )

    def texture(self) -> Texture:  # noqa: D102
        x, y, z = coordinates()
        column = atan2(x, -z) * (0.5 / math.pi) + (0.5 + self.rotation / 360 % 1)
        row = atan2(y, length(x, z)) * (1 / math.pi) + 0.5
        texels = (_core.texel(self._node, column._node, row._node, channel, _REPEAT_ALONG_U) for channel in range(3))
        return Texture(*(Expression(texel) for texel in texels)) * self.intensity

    def __reduce__(self) -> tuple[Any, ...]:
        return EnvironmentMap, (self.image, self.rotation, self.intensity)


@dataclass(frozen=True, init=False)
class CustomSky(_Sky):
    """A sky of one's own: any texture, seen in the direction that stands in the place of the point.

    Parameters
    ----------
    color : Texture, or one or three numbers or expressions
        Radiance, linear RGB, of the unit direction (``x, y, z = om.coordinates()``). Below 0 it counts as 0.

    Raises
    ------
    TypeError, ValueError
        If the colour is of a wrong type, or looks at the normal of a surface.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> sun = 20 * om.smoothstep(0.995, 0.999, om.dot((x, y, z), (0.6, 0.64, 0.48)))
    >>> om.CustomSky((0.3 + sun, 0.4 + sun, 0.6 + 0.3 * y + sun))
    CustomSky(color=<Texture add, add, add>)
    """

    color: Texture

    def __init__(self, color: ColorExpression) -> None:
        colors = texture("color", color)
        if any(_core.uses_normal(component._node) for component in colors.components):
            raise ValueError("color must not look at normals: where the sky is there is no surface")
        check.set_fields(self, color=colors)

    def texture(self) -> Texture:  # noqa: D102
        return self.color


AnySky: TypeAlias = Sky | ConstantSky | GradientSky | EnvironmentMap | CustomSky

_REPEAT_ALONG_U = 2  # as in nodes.def


def _along(axis: Vec3) -> Expression:
    """Return d·axis, without the terms that are 0."""
    terms = [factor * component for factor, component in zip(axis, coordinates(), strict=True) if factor]
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def _weighted(color: Vec3, weight: Expression) -> Texture:
    """Return a colour times an expression; what is 0 stays a number, so that equal channels cost nothing."""
    return Texture(*(component * weight if component else 0.0 for component in color))


def _difference(a: Vec3, b: Vec3) -> Vec3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _checked_stops(pairs: list[object]) -> tuple[tuple[float, Vec3], ...]:
    if not pairs:
        raise ValueError("stops must hold at least one (elevation, color), got none")
    stops: list[tuple[float, Vec3]] = []
    for i, pair in enumerate(pairs):
        items = check.sequence(f"stops[{i}]", pair, "(elevation, color)")
        if len(items) != 2:
            raise ValueError(f"stops[{i}] must be (elevation, color), got {check.shown(pair)}")
        elevation = check.finite(f"the elevation of stops[{i}]", items[0])
        if not (stops[-1][0] if stops else -math.inf) < elevation or not -90 <= elevation <= 90:
            raise ValueError(f"elevations in stops must rise within [-90, 90], got {check.shown(elevation)}")
        stops.append((elevation, check.color(f"the color of stops[{i}]", items[1])))
    return tuple(stops)
