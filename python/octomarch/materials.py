"""What surfaces are made of. Shapes are painted with a `Material`; rendering reads it once per hit.

Expressions and textures come before it (`expressions`, `textures`): every property may change from point to point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import ColorLike, Vec3
from octomarch.expressions import Expression, ExpressionLike, operand
from octomarch.textures import ColorExpression, Texture, texture


@dataclass(frozen=True, init=False)
class Material:
    """Surface under Lambert and Phong shading, each property a number or an expression.

    The diffuse part is ``(1 - metallic) * color`` (J. H. Lambert); the highlight is the modified Phong model [1]_: it
    has the colour ``specular`` (white) for a non-metal and ``color`` for a metal, mixed by `metallic`, and the exponent
    ``2 / roughness**4 - 2``, clamped to [1, 8192], by which it is as wide as the microfacet lobe of that roughness
    [2]_.

    Expressions are those of the position in the coordinates of the painted shape (`octomarch.coordinates`), which move
    with it, and of its unit normal there (`octomarch.normals`). Where they leave the ranges below they are clamped.

    Parameters
    ----------
    color : float or sequence of three floats, Texture, or one or three expressions
        Linear RGB, each ≥ 0; one number means grey.
    roughness : float or Expression
        0 (a small, sharp highlight) to 1 (dull).
    specular : float or Expression
        Strength of the highlight of a non-metal, 0 to 1.
    metallic : float or Expression
        0 to 1.
    reflectivity : float or Expression
        Share of the mirror image in what is seen, 0 to 1, where `Shading.bounces` is at least 1.

    Raises
    ------
    TypeError, ValueError
        If an argument is neither a number nor an expression, or a number outside its range.

    References
    ----------
    .. [1] B. T. Phong, "Illumination for computer generated pictures", CACM 18(6), 1975. doi:10.1145/360825.360839
    .. [2] B. Karis, "Specular BRDF reference", 2013.

    Examples
    --------
    >>> import octomarch as om
    >>> red = om.Material(color=(0.8, 0.1, 0.1), roughness=0.3)
    >>> red.color
    (0.8, 0.1, 0.1)
    >>> om.sphere(1.0).paint(red)
    <Shape paint, 6 nodes>
    >>> x, y, z = om.coordinates()
    >>> om.Material(color=(0.5 + 0.5 * x, 0.5, 0.5), roughness=om.clamp(y, 0.1, 0.9)).color
    <Texture add, constant, constant>
    """

    color: Vec3 | Texture
    roughness: float | Expression
    specular: float | Expression
    metallic: float | Expression
    reflectivity: float | Expression

    def __init__(
        self,
        color: ColorLike | ColorExpression = (0.8, 0.8, 0.8),
        roughness: ExpressionLike = 0.5,
        specular: ExpressionLike = 0.3,
        metallic: ExpressionLike = 0.0,
        reflectivity: ExpressionLike = 0.0,
    ) -> None:
        check.set_fields(
            self,
            color=_color(color),
            roughness=_fraction("roughness", roughness),
            specular=_fraction("specular", specular),
            metallic=_fraction("metallic", metallic),
            reflectivity=_fraction("reflectivity", reflectivity),
        )

    def _native(self) -> _core.Material:
        rest = (self.roughness, self.specular, self.metallic, self.reflectivity)
        components = texture("color", self.color).components
        return _core.Material([operand("material", slot) for slot in (*components, *rest)])

    @classmethod
    def _from_native(cls, native: _core.Material) -> Material:
        """Return what a painted node holds; a file may have brought numbers beyond the ranges, which are kept."""
        red, green, blue, *rest = native.slots
        names = ("roughness", "specular", "metallic", "reflectivity")
        material = cls.__new__(cls)
        check.set_fields(material, color=_collapsed([red, green, blue]))
        check.set_fields(material, **{name: _number(node) for name, node in zip(names, rest, strict=True)})
        return material


def _color(value: object) -> Vec3 | Texture:
    """Return a colour as three numbers where it is the same everywhere, and as a texture elsewhere."""
    if check.is_number(value):
        return check.color("color", value)
    if not isinstance(value, (Texture, Expression)):
        items = check.sequence("color", value, "three numbers")
        if not any(isinstance(item, Expression) for item in items):
            return check.color("color", value)
    color = _collapsed([component._node for component in texture("color", value).components])
    return color if isinstance(color, Texture) else check.color("color", color)


def _collapsed(nodes: Sequence[_core.Node]) -> Vec3 | Texture:
    red, green, blue = (_core.constant_value(node) for node in nodes)
    if red is None or green is None or blue is None:
        return Texture(*map(Expression, nodes))
    return red, green, blue


def _fraction(name: str, value: object) -> float | Expression:
    if not isinstance(value, Expression):
        return check.fraction(name, value)
    number = _number(value._node)
    return value if isinstance(number, Expression) else check.fraction(name, number)


def _number(node: _core.Node) -> float | Expression:
    value = _core.constant_value(node)
    return Expression(node) if value is None else value
