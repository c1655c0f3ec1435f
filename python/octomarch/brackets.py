"""Certified first roots: where rays meet a shape, proven by interval arithmetic. Part of `octomarch.reference`.

The search walks the nodes of a shape like the rest of the reference, but over pieces of rays instead of points: each
operation gives bounds of all values on the piece, rounded outward. It knows nothing of programs, of packets and of
Lipschitz bounds, takes no step that could be too long, and so can tell which of two marches is right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch.camera import AnyCamera, or_framing
from octomarch.march import March
from octomarch.program import compile
from octomarch.queries import _rays
from octomarch.scene import Scene
from octomarch.shapes import Shape

__all__ = ["Brackets", "Verdict", "certified", "certified_picture"]


class Verdict(IntEnum):
    """What `reference.certified` has proven of a ray. Values are those of `Status` where the meanings meet.

    Examples
    --------
    >>> import octomarch as om
    >>> found = om.reference.certified(om.sphere(1.0), [[0, 0, 3], [0, 3, 0]], [0, 0, -1])
    >>> [om.reference.Verdict(int(status)).name for status in found.status]
    ['HIT', 'MISS']
    """

    HIT = 0
    """The field is positive before t_lo and ≤ 0 at t_hi, and these are within the tolerance of each other."""
    MISS = 1
    """The field is positive all along the ray."""
    UNDECIDED = 2
    """The field is positive before t_lo, and more could not be proven: the ray may only touch the surface, the field
    may be no number there, or the evaluations are spent. t_hi is +inf where no point with a field ≤ 0 was found."""
    INSIDE = 3
    """The field is ≤ 0 where the ray starts."""
    INVALID = 4
    """The ray's origin or direction is not finite, or its direction zero."""


@dataclass(frozen=True, eq=False)
class Brackets:
    """What is proven of rays, as arrays with their leading shape; made by `reference.certified`.

    Examples
    --------
    >>> import octomarch as om
    >>> found = om.reference.certified(om.sphere(1.0), [0, 0, 3], [0, 0, -1])
    >>> bool(found.t_lo <= 2 <= found.t_hi), bool(found.t_hi - found.t_lo < 1e-9)
    (True, True)
    """

    t_lo: NDArray[np.float64]
    """The field is positive from the ray's start up to here; +inf for a MISS and for INVALID rays."""
    t_hi: NDArray[np.float64]
    """Here the field is ≤ 0; +inf where no such point is known."""
    status: NDArray[np.uint8]
    """What is proven: see `reference.Verdict`."""


def certified(
    scene: Shape | Scene,
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: float = 0.0,
    max_distance: float | None = None,
    *,
    tolerance: float = 1e-10,
    max_evaluations: int = 4096,
    threads: int | None = None,
) -> Brackets:
    """Find where rays first meet a shape, with proof.

    A hit is the first t at which the field is ≤ 0: before ``t_lo`` it is proven to be positive, at ``t_hi`` to be ≤ 0,
    and ``t_hi - t_lo`` is at most `tolerance` times ``t_hi``. That holds for the field over real numbers that the nodes
    describe: every operation is bounded by interval arithmetic with outward rounding [1]_, along with its rate of
    change along the ray, and pieces of the ray are cut until their bounds decide. No Lipschitz bound is believed.

    Parameters
    ----------
    scene : Shape or Scene
        What the rays may hit.
    origins, directions : array_like of float, shape (..., 3)
        World frame, scene units; the shapes are broadcast. t counts in lengths of the directions.
    t_min : float
        Where rays start, ≥ 0.
    max_distance : float, optional
        Where they end, in scene units from the origin, > 0; +inf searches to 1e150. None: as far as
        `octomarch.Shape.raycast` goes (see `octomarch.March`), which is beyond the whole of a bounded shape.
    tolerance : float
        Of hits, relative; in [1e-14, 1).
    max_evaluations : int
        Of the field over pieces of one ray. Those that would need more are UNDECIDED.
    threads : int, optional
        Threads at the most; None for all cores.

    Returns
    -------
    Brackets
        ``t_lo``, ``t_hi`` and ``status`` (see `reference.Verdict`) with the leading shape of the rays.

    Raises
    ------
    TypeError, ValueError
        If arrays hold no real numbers, their last axis is not 3, or their shapes do not broadcast; if an option is of a
        wrong type or outside its range.
    KeyboardInterrupt
        Ctrl-C stops the search at once.

    References
    ----------
    .. [1] R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis", SIAM, 2009.
       doi:10.1137/1.9780898717716

    Examples
    --------
    >>> import octomarch as om
    >>> shape = om.torus(1.0, 0.25).union(om.sphere(0.5), smooth=0.2)
    >>> truth = om.reference.certified(shape, [0, 0.1, 3], [0, 0, -1])
    >>> hit = shape.raycast([0, 0.1, 3], [0, 0, -1], march=om.March(epsilon=1e-9))
    >>> bool(abs(hit.t - truth.t_lo) < 1e-8)
    True
    """
    shape = _shape(scene)
    starts, aims, leading = _rays(origins, directions)
    first = check.non_negative("t_min", t_min)
    if max_distance is None:
        max_distance = March().resolve(compile(shape), origins, pixels=False).max_distance
    limits = _limits(max_distance, tolerance, max_evaluations)
    found = _core.reference_certified(shape._node, starts, aims, first, *limits, check.threads(threads))
    return Brackets(**{name: values.reshape(leading) for name, values in found.items()})


def certified_picture(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (160, 120),
    max_distance: float | None = None,
    *,
    tolerance: float = 1e-10,
    max_evaluations: int = 4096,
    crop: Sequence[int] | None = None,
    threads: int | None = None,
) -> Brackets:
    """Find what is seen at the centre of each pixel, with proof: the truth for planes ``depth`` and ``status``.

    The rays are those of `octomarch.render`, made in float64, from the eye on.

    Parameters
    ----------
    scene : Shape or Scene
        What is seen.
    camera : Camera, OrthographicCamera or PanoramicCamera, optional
        None: one that frames the bounded parts of the shape.
    size : (int, int)
        Width and height in pixels.
    max_distance, tolerance, max_evaluations, threads
        As for `reference.certified`; None: as far as `octomarch.render` goes.
    crop : (int, int, int, int), optional
        x, y, width and height of what is computed, in pixels of the whole picture; None for all of it.

    Returns
    -------
    Brackets
        Arrays of shape (height, width), row 0 at the top.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.
    KeyboardInterrupt
        Ctrl-C stops the search at once.

    Examples
    --------
    >>> import numpy as np, octomarch as om
    >>> solid = om.sphere(1.0) - om.box(1.2)
    >>> truth = om.reference.certified_picture(solid, size=(32, 24))
    >>> image = om.render(solid, size=(32, 24), planes=("depth", "status"), precision="float64")
    >>> bool(np.mean(truth.status == image.status) > 0.99)
    True
    """
    shape = _shape(scene)
    width, height = check.size(size)
    window = check.crop(crop, (width, height))
    program = compile(shape)
    camera = or_framing(camera, program, (width, height))
    if max_distance is None:
        max_distance = March().resolve(program, camera._ray_origins((width, height))).max_distance
    limits = _limits(max_distance, tolerance, max_evaluations)
    found = _core.reference_certified_picture(
        shape._node, camera._native(), width, height, window, 0.0, *limits, check.threads(threads)
    )
    return Brackets(**found)


def _shape(scene: Shape | Scene) -> Shape:
    if isinstance(scene, Scene):
        return scene.shape
    if not isinstance(scene, Shape):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    return scene


def _limits(max_distance: float | None, tolerance: float, max_evaluations: int) -> tuple[float, float, int]:
    """Return what bounds a search, once it is found to be in range."""
    farthest = check.number("max_distance", max_distance)
    if not farthest > 0:
        raise ValueError(f"max_distance must be > 0, got {check.shown(max_distance)}")
    accuracy = check.number("tolerance", tolerance)
    if not 1e-14 <= accuracy < 1:
        raise ValueError(f"tolerance must lie inside [1e-14, 1), got {check.shown(tolerance)}")
    return farthest, accuracy, check.integer("max_evaluations", max_evaluations, 1)
