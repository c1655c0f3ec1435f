"""`Shading`: how surfaces are lit once the march has found them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from octomarch import _core
from octomarch import _validate as check
from octomarch.program import Program, program_of

Normals: TypeAlias = Literal["exact", "central", "tetrahedron"]
Shadows: TypeAlias = Literal["none", "hard", "soft"]


@dataclass(frozen=True, init=False)
class Shading:
    """Settings of normals, shadows, ambient occlusion and reflections.

    Parameters
    ----------
    normals : {"exact", "central", "tetrahedron"}
        By forward differentiation through the program; by central differences of six evaluations; by four of them, at
        the corners of a tetrahedron [1]_. What was built by `octomarch.solid` has no differences: there 256
        neighbours of a point in a lattice tell where inside is.
    normal_step : float, optional
        How far from the point differences sample along each axis, and how far its neighbours are, in scene units, > 0.
        None: 1e-3 of the scene's size.
    shadows : {"none", "hard", "soft"}
        Soft shadows have a penumbra: visibility is the least ``shadow_k * distance / t`` along the shadow ray.
    shadow_k : float
        Sharpness of soft shadows, > 0: 2 is very soft, 32 a good value, 128 nearly hard.
    occlusion : int
        Samples of the field along the normal for ambient occlusion, 0 (none) to 64. Sample i of n stands at
        ``occlusion_distance * (i / n)**2`` and weighs 2⁻ⁱ.
    occlusion_distance : float, optional
        Of the farthest of these samples in scene units, > 0. None: 5 % of the scene's size.
    bounces : int
        Mirrors that light may have passed before it reaches the eye, 0 to 64: how often reflections are followed. They
        cost rays where a material's `reflectivity` is not 0.
    reflection_cutoff : float
        Reflections that would weigh less in the picture are not followed, 0 to 1; the weight is the product of the
        reflectivities on the way. A surface whose reflection is not followed shows its own colour unweighted.
    reflection_offset : float
        Height above the surface from which mirror rays leave, in scene units, ≥ 0: lest they hit what they leave. At
        least two hit tolerances.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range; an unknown name is answered with those there are.

    Notes
    -----
    The *scene's size* is the diagonal of `Program.focus`, or 1 when that is None or a single point. The ambient part of
    the light alone is ``lights=[]`` in the `Scene`; ``specular=0`` in a `Material` leaves out its highlight.

    References
    ----------
    .. [1] I. Quilez, "Normals for an SDF", 2015. https://iquilezles.org/articles/normalsSDF

    Examples
    --------
    >>> import octomarch as om
    >>> draft = om.Shading(shadows="none", occlusion=0)
    >>> om.render(om.sphere(1.0), size=(32, 24), shading=draft).stats["stages"]["shadow"]["count"]
    0
    """

    normals: Normals
    normal_step: float | None
    shadows: Shadows
    shadow_k: float
    occlusion: int
    occlusion_distance: float | None
    bounces: int
    reflection_cutoff: float
    reflection_offset: float

    def __init__(
        self,
        normals: Normals = "exact",
        normal_step: float | None = None,
        shadows: Shadows = "soft",
        shadow_k: float = 32.0,
        occlusion: int = 5,
        occlusion_distance: float | None = None,
        bounces: int = 0,
        reflection_cutoff: float = 1e-3,
        reflection_offset: float = 1e-3,
    ) -> None:
        reach = occlusion_distance
        check.set_fields(
            self,
            normals=check.choice("normals", normals, ("exact", "central", "tetrahedron")),
            normal_step=None if normal_step is None else check.positive("normal_step", normal_step),
            shadows=check.choice("shadows", shadows, ("none", "hard", "soft")),
            shadow_k=check.positive("shadow_k", shadow_k),
            occlusion=check.integer("occlusion", occlusion, 0, 64),
            occlusion_distance=None if reach is None else check.positive("occlusion_distance", reach),
            bounces=check.integer("bounces", bounces, 0, 64),
            reflection_cutoff=check.fraction("reflection_cutoff", reflection_cutoff),
            reflection_offset=check.non_negative("reflection_offset", reflection_offset),
        )

    def resolve(self, program: Program) -> Shading:
        """Return these settings with every None replaced by its number for the scene of `program`.

        Examples
        --------
        >>> import octomarch as om
        >>> om.Shading().resolve(om.compile(om.box((3, 4, 12)))).occlusion_distance
        0.65
        """
        program_of("program", program)
        step, reach = self.normal_step, self.occlusion_distance
        return replace(
            self,
            normal_step=1e-3 * program.size if step is None else step,
            occlusion_distance=0.05 * program.size if reach is None else reach,
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
            self.bounces,
            self.reflection_cutoff,
            self.reflection_offset,
        )
