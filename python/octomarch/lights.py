"""Where light comes from: directional and point lights, and the sky that rays see when they hit nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import ColorLike, Vec3, VectorLike
from octomarch.expressions import coordinates
from octomarch.functions import dot, maximum


@dataclass(frozen=True, init=False)
class DirectionalLight:
    """Light from very far away, like the sun: parallel rays of the same strength everywhere.

    Parameters
    ----------
    direction : sequence of three floats
        Where the light travels to, of any length but zero; (0, -1, 0) shines straight down.
    color : float or sequence of three floats
        Irradiance on a surface that faces the light, linear RGB ≥ 0; one number means grey.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite, or the direction is zero.

    Examples
    --------
    >>> import octomarch as om
    >>> om.DirectionalLight(direction=(0, -2, 0), color=0.5)
    DirectionalLight(direction=(0.0, -2.0, 0.0), color=(0.5, 0.5, 0.5))
    """

    direction: Vec3
    color: Vec3

    def __init__(self, direction: VectorLike, color: ColorLike = (1.0, 1.0, 1.0)) -> None:
        check.direction("direction", direction)
        check.set_fields(self, direction=check.vector("direction", direction), color=check.color("color", color))

    def _native(self) -> _core.Light:
        return _core.Light(
            "directional", check.direction("direction", self.direction), self.color, 0, (0.0, -1.0, 0.0), 1.0, 0.0
        )


@dataclass(frozen=True, init=False)
class PointLight:
    """Light from one point, weaker with the distance.

    Parameters
    ----------
    position : sequence of three floats
        World frame, scene units.
    color : float or sequence of three floats
        Irradiance at a distance of one scene unit, linear RGB ≥ 0; one number means grey.
    decay : int
        Irradiance falls as 1 / distance**decay: 2 as in nature, 1, or 0 for no fall at all.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite, or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> om.PointLight(position=(2, 5, 2), color=(30, 28, 25)).decay
    2
    """

    position: Vec3
    color: Vec3
    decay: int

    def __init__(self, position: VectorLike, color: ColorLike = (1.0, 1.0, 1.0), decay: int = 2) -> None:
        check.set_fields(
            self,
            position=check.point("position", position),
            color=check.color("color", color),
            decay=check.integer("decay", decay, 0, 2),
        )

    def _native(self) -> _core.Light:
        return _core.Light("point", self.position, self.color, self.decay, (0.0, -1.0, 0.0), 1.0, 0.0)


Light: TypeAlias = DirectionalLight | PointLight


@dataclass(frozen=True, init=False)
class Sky:
    """What a ray sees that hits nothing: ``toward * max(d·axis, 0) + away * max(-d·axis, 0) + base``.

    ``d`` is the unit direction of the ray. The sky gives no light to surfaces; `Scene.ambient` stands for that.

    Parameters
    ----------
    axis : sequence of three floats
        Direction in which ``toward`` is seen, of any length but zero.
    toward, away, base : float or sequence of three floats
        Radiance along the axis, against it, and everywhere; linear RGB ≥ 0, one number means grey.

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

    def __init__(
        self,
        axis: VectorLike = (0.0, 1.0, 0.0),
        toward: ColorLike = (0.05, 0.18, 0.40),
        away: ColorLike = (0.02, 0.02, 0.02),
        base: ColorLike = (0.40, 0.48, 0.58),
    ) -> None:
        check.direction("axis", axis)
        check.set_fields(
            self,
            axis=check.vector("axis", axis),
            toward=check.color("toward", toward),
            away=check.color("away", away),
            base=check.color("base", base),
        )

    def _native(self) -> _core.Sky:
        along = dot(coordinates(), check.direction("axis", self.axis))
        ahead, behind = maximum(along, 0.0), maximum(-along, 0.0)
        channels = zip(self.toward, self.away, self.base, strict=True)
        return _core.Sky([(ahead * a + behind * b + c)._node for a, b, c in channels])
