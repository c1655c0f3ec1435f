"""What surfaces are made of. Shapes are painted with a `Material`; rendering reads it once per hit."""

from __future__ import annotations

from dataclasses import dataclass

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import ColorLike, Vec3


@dataclass(frozen=True, init=False)
class Material:
    """Surface under Lambert and Phong shading.

    The diffuse part is ``(1 - metallic) * color``; the highlight has the colour ``specular`` (white) for a non-metal
    and ``color`` for a metal, and the Phong exponent ``2 / roughness**4 - 2``, clamped to [1, 8192] [1]_.

    Parameters
    ----------
    color : float or sequence of three floats
        Linear RGB, each ≥ 0; one number means grey.
    roughness : float
        0 (a small, sharp highlight) to 1 (dull).
    specular : float
        Strength of the highlight of a non-metal, 0 to 1.
    metallic : float
        0 to 1.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, or outside its range.

    References
    ----------
    .. [1] B. Karis, "Specular BRDF reference", 2013.

    Examples
    --------
    >>> import octomarch as om
    >>> red = om.Material(color=(0.8, 0.1, 0.1), roughness=0.3)
    >>> red.color
    (0.8, 0.1, 0.1)
    >>> om.sphere(1.0).paint(red)
    <Shape paint, 2 nodes>
    """

    color: Vec3
    roughness: float
    specular: float
    metallic: float

    def __init__(
        self,
        color: ColorLike = (0.8, 0.8, 0.8),
        roughness: float = 0.5,
        specular: float = 0.3,
        metallic: float = 0.0,
    ) -> None:
        check.set_fields(
            self,
            color=check.color("color", color),
            roughness=check.fraction("roughness", roughness),
            specular=check.fraction("specular", specular),
            metallic=check.fraction("metallic", metallic),
        )

    def _native(self) -> _core.Material:
        return _core.Material(self.color, self.roughness, self.specular, self.metallic)
