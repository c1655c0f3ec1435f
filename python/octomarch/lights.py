"""Where light comes from: directional, point and spot lights. `scene.Scene` takes them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import ColorLike, Vec3, VectorLike


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
        return _core.Light("directional", check.direction("direction", self.direction), self.color, 0, _DOWN, 1.0, 0.0)


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
        return _core.Light("point", self.position, self.color, self.decay, _DOWN, 1.0, 0.0)


@dataclass(frozen=True, init=False)
class SpotLight:
    """Light from one point into a cone, weaker with the distance and towards the cone's edge.

    Parameters
    ----------
    position : sequence of three floats
        World frame, scene units.
    target : sequence of three floats, optional
        A point that the middle of the cone hits, not the light's own position. Either this or `direction`.
    direction : sequence of three floats, optional
        Where the middle of the cone points, of any length but zero.
    color : float or sequence of three floats
        Irradiance in the middle of the cone at a distance of one scene unit, linear RGB ≥ 0; one number means grey.
    angle : float
        Of the whole cone in degrees, from edge to edge, 1 to 180. Nothing is lit outside.
    softness : float
        Share of the cone's angle over which the light comes up from its edge, 0 (a hard edge) to 1 (up to its middle),
        as the smoothstep of the angle's cosine.
    decay : int
        Irradiance falls as 1 / distance**decay: 2 as in nature, 1, or 0 for no fall at all.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite, or outside its range; if not exactly one of `target` and
        `direction` is given.

    Examples
    --------
    >>> import octomarch as om
    >>> lamp = om.SpotLight(position=(0, 4, 0), target=(1, 0, 0), color=40, angle=50)
    >>> lamp.direction
    (1.0, -4.0, 0.0)
    """

    position: Vec3
    direction: Vec3
    color: Vec3
    angle: float
    softness: float
    decay: int

    def __init__(
        self,
        position: VectorLike,
        target: VectorLike | None = None,
        direction: VectorLike | None = None,
        color: ColorLike = (1.0, 1.0, 1.0),
        angle: float = 40.0,
        softness: float = 0.2,
        decay: int = 2,
    ) -> None:
        width = check.finite("angle", angle)
        if not 1 <= width <= 180:
            raise ValueError(f"angle must lie in [1, 180], got {check.shown(angle)}")
        start = check.point("position", position)
        check.set_fields(
            self,
            position=start,
            direction=_aim(start, target, direction),
            color=check.color("color", color),
            angle=width,
            softness=check.fraction("softness", softness),
            decay=check.integer("decay", decay, 0, 2),
        )

    def _native(self) -> _core.Light:
        aim = check.direction("direction", self.direction)
        half = math.radians(self.angle) / 2
        inner = half * (1 - max(self.softness, _HARDEST))
        return _core.Light("spot", self.position, self.color, self.decay, aim, math.cos(inner), math.cos(half))


Light: TypeAlias = DirectionalLight | PointLight | SpotLight

_HARDEST = 1e-3  # softness of a hard edge: in float32 the cosines of edge and middle must differ
_DOWN: Vec3 = (0.0, -1.0, 0.0)


def _aim(position: Vec3, target: VectorLike | None, direction: VectorLike | None) -> Vec3:
    if (target is None) == (direction is None):
        given = "none" if target is None else f"{check.shown(target)} and {check.shown(direction)}"
        raise ValueError(f"target or direction must be given, one of them; got {given}")
    if target is None:
        check.direction("direction", direction)
        return check.vector("direction", direction)
    x, y, z = (there - here for here, there in zip(position, check.point("target", target), strict=True))
    if x == y == z == 0:
        raise ValueError(f"target must not be the light's position, got {check.shown(target)}")
    return check.point("target, seen from position,", (x, y, z))
