"""`Shading`: how surfaces are lit once the march has found them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from octomarch import _core
from octomarch import _validate as check
from octomarch.program import Program

Normals: TypeAlias = Literal["exact", "central"]
Shadows: TypeAlias = Literal["none", "hard", "soft"]


@dataclass(frozen=True, init=False)
class Shading:
    """Settings of normals, shadows and ambient occlusion.

    Parameters
    ----------
    normals : {"exact", "central"}
        By forward differentiation through the program, or by central differences of six evaluations.
    normal_step : float, optional
        Half the width of a central difference in scene units, > 0. None: 1e-3 of the scene's size.
    shadows : {"none", "hard", "soft"}
        Soft shadows have a penumbra: visibility is the least ``shadow_k * distance / t`` along the shadow ray.
    shadow_k : float
        Sharpness of soft shadows, > 0: 2 is very soft, 32 a good value, 128 nearly hard.
    occlusion : int
        Samples of the field along the normal for ambient occlusion, 0 (none) to 64. Sample i of n stands at
        ``occlusion_distance * (i / n)**2`` and weighs 2⁻ⁱ.
    occlusion_distance : float, optional
        Of the farthest of these samples in scene units, > 0. None: 5 % of the scene's size.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range; an unknown name is answered with those there are.

    Notes
    -----
    The *scene's size* is the diagonal of `Program.focus`, or 1 when that is None or a single point.

    Examples
    --------
    >>> import octomarch as om
    >>> draft = om.Shading(shadows="none", occlusion=0)
    >>> om.render(om.sphere(1.0), size=(32, 24), shading=draft).stats["shadow_rays"]
    0
    """

    normals: Normals
    normal_step: float | None
    shadows: Shadows
    shadow_k: float
    occlusion: int
    occlusion_distance: float | None

    def __init__(
        self,
        normals: Normals = "exact",
        normal_step: float | None = None,
        shadows: Shadows = "soft",
        shadow_k: float = 32.0,
        occlusion: int = 5,
        occlusion_distance: float | None = None,
    ) -> None:
        reach = occlusion_distance
        check.set_fields(
            self,
            normals=check.choice("normals", normals, ("exact", "central")),
            normal_step=None if normal_step is None else check.positive("normal_step", normal_step),
            shadows=check.choice("shadows", shadows, ("none", "hard", "soft")),
            shadow_k=check.positive("shadow_k", shadow_k),
            occlusion=check.integer("occlusion", occlusion, 0, 64),
            occlusion_distance=None if reach is None else check.positive("occlusion_distance", reach),
        )

    def resolve(self, program: Program) -> Shading:
        """Return these settings with every None replaced by its number for the scene of `program`.

        Examples
        --------
        >>> import octomarch as om
        >>> om.Shading().resolve(om.compile(om.box((3, 4, 12)))).occlusion_distance
        0.65
        """
        step, reach = self.normal_step, self.occlusion_distance
        return Shading(
            self.normals,
            1e-3 * program.size if step is None else step,
            self.shadows,
            self.shadow_k,
            self.occlusion,
            0.05 * program.size if reach is None else reach,
        )

    def _native(self) -> _core.Shading:
        """Convert settings that `resolve` has filled."""
        if self.normal_step is None or self.occlusion_distance is None:
            raise ValueError("shading must be resolved first: see Shading.resolve")
        return _core.Shading(
            self.normals,
            self.normal_step,
            self.shadows,
            self.shadow_k,
            self.occlusion,
            self.occlusion_distance,
            0,
            1e-3,
            1e-3,
        )
