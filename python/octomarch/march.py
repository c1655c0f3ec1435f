"""How rays are marched: `March` holds the settings, `Status` names what becomes of a ray.

Settings left at None follow from the size of the scene; `March.resolve` is the one place that fills them in, for
queries, renders and the reference alike.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.program import Program, program_of

if TYPE_CHECKING:
    from octomarch.camera import AnyCamera
    from octomarch.scene import Scene
    from octomarch.shapes import Shape
    from octomarch.study.sample import Measured

Method: TypeAlias = Literal["auto", "plain", "relaxed", "enhanced", "fixed", "certified"]
_METHODS = ("auto", "plain", "relaxed", "enhanced", "fixed", "certified")
_STEPS = 256
_CERTIFIED_STEPS = 1024
_DOUBTS_OF_BRACKET = 16
_ROWS = 2**13  # of origins, looked at together


class Status(IntEnum):
    """What became of a ray. The values are part of the file format.

    Examples
    --------
    >>> import octomarch as om
    >>> om.Status(int(om.sphere(1.0).raycast([0, 0, 3], [0, 1, 0]).status)).name
    'MISS'
    """

    HIT = 0
    """A surface was reached."""
    MISS = 1
    """The farthest distance was passed; t is +inf."""
    STEP_LIMIT = 2
    """All steps were spent, or certified steps could not decide; t is the best candidate. No surface lies before it,
    but what fixed steps have missed."""
    INSIDE = 3
    """The ray begins in the solid, or nearer than epsilon to it; t is min_distance, 0 by default."""
    INVALID = 4
    """The field is NaN, or the ray's origin or direction is not finite or its direction zero; t is +inf."""


@dataclass(frozen=True, init=False)
class March:
    """Settings of the march along a ray: sphere tracing, or fixed steps.

    Let r be the field divided by its Lipschitz bound. A ray has hit when r is at most the *hit epsilon*
    ``max(epsilon, 16 u max(|origin|, t), pixel_tolerance * pixel_radius(t))``, where u is the unit roundoff of the
    precision and the pixel radius is half the height of a pixel at t (0 for queries). With fixed steps it has hit when
    r is at most 0: when a sample lies in the solid. Of scenes far from the origin, and of rays from far away, only what
    is left near the scene counts as ``|origin|`` and t, since coordinates count from `Program.anchor` and rays are
    moved along in double first.

    Parameters
    ----------
    method : {"auto", "plain", "relaxed", "enhanced", "fixed", "certified"}
        Of ``"plain"``, sphere tracing [1]_, each step is r. The next two take longer ones, in the hope that the next
        empty sphere touches the last, and go back where it does not, so they find the same surfaces: ``"relaxed"``
        steps by 1.6 r until it has to go back for the first time [2]_, ``"enhanced"`` by what the slope between the
        last two samples lets hope [3]_. ``"auto"`` takes the steps of ``"enhanced"``, and for pictures marches a cone
        about each 8×8 pixels first, at whose end their rays begin [4]_, with cones about 4×4 and 2×2 pixels between
        where the shape's program has 48 instructions or more; rays of crowds of balls, or of what nearly fills the
        balls about it, begin at the first that they come near to instead; planes that the shape is united with,
        such as a floor, it meets in closed form, and marches the rest alone, within its bounds. Of ``"fixed"`` a
        step is ``max(r, step)``, or the hit epsilon where that is more. It also finds solids whose field says no more
        than inside and outside (`octomarch.solid`), which are always marched by it, and may miss what is thinner than
        a step. Shadow rays take longer steps only where the light is clear. ``"certified"`` is for those who must not
        miss anything; see Notes for what it guarantees.
    max_steps : int, optional
        Evaluations per ray at the most, ≥ 1; those of cones are not counted. Rays that spend them all end as
        `Status.STEP_LIMIT`. None: 256; with certified steps 1024; with fixed steps as many as may be needed from
        ``min_distance`` to ``max_distance``.
    epsilon : float, optional
        Absolute hit epsilon in scene units, ≥ 0. None: 1e-6 of the scene's size for renders, 1e-5 for queries, which
        have no pixels to go by.
    pixel_tolerance : float
        Hit epsilon in pixel radii, ≥ 0: 0.5 for a draft, 0.1 is fine.
    max_distance : float, optional
        Farthest distance marched, > 0, in scene units. None: where everything is bounded, enough to pass all of it
        from the eye or any origin; else 1000 times the scene's size, or its distance from the eye if that is more. Ten
        times where there are solids of which only inside and outside are known.
    min_distance : float
        Where t begins, ≥ 0 and less than ``max_distance``, in scene units. Rays that begin in the solid are
        `Status.INSIDE`. Shadow and mirror rays begin at their surface nonetheless.
    finish : {"secant"}, optional
        Refine a hit by the secant through the last two samples. One more evaluation per hit, not counted in the plane
        ``steps``, checks the result: where more than a sixteenth of the hit epsilon is left, the hit stays where it
        was; else it goes on to the root of the secant through that last sample too. A ray that hits with its first
        sample, where its cone has ended, takes two evaluations at the most. With fixed steps, where a field need not
        have a slope, ten more evaluations per hit halve the last step instead; the hit is the end that lies outside.
        None: do not refine.
    bias : float
        By how much each step stays short of r, ≥ 0, in scene units: for fields that say a little more than their
        distance. Steps become ``max(r - bias, r / 2)``, so that rays always get on, and are never longer than that,
        whatever the method; fixed ones become ``max(r - bias, step)``.
    step : float, optional
        Least length of fixed steps, > 0, in scene units. None: 1e-3 of the scene's size.
    prune : bool
        Run long programs in parts where that promises to help: space is divided into cells, in each of which only what
        has a say there of the program is run [5]_. Results are the same, to the bit. Fixed steps never do so. Cells
        are made as rays come to them, and stay with the shape, up to 512 MB or 2 KB an instruction.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or there is a `step` although steps are not fixed; an
        unknown name is answered with those there are.

    Notes
    -----
    The *scene's size* is the diagonal of `Program.focus`, or 1 when that is None or a single point.

    With ``method="certified"`` each status of a ray is a proof about the field that the shape's operators describe over
    real numbers, as far as its Lipschitz bound is true (that of `octomarch.field` may be your own):

    - `Status.MISS`: the field is positive all along the ray. There are no false misses.
    - `Status.HIT`: the ray's first root lies within `bracket` of t, which is the hit epsilon, or 16 times what
      roundings may add up to where that is more. Without `finish` it lies between t and t plus the bracket. There are
      no false hits.
    - `Status.INSIDE`: the field is negative where the ray starts.
    - `Status.STEP_LIMIT`: neither could be shown. The field is positive before t, and whether the ray meets anything is
      not known: it may only graze the surface, nearer than the bracket. Nearly all rays are decided in float64; in
      float32 roundings leave more of them open.

    A step ends where the empty spheres about samples no longer touch. Their radius is r less a bound of what all
    roundings of the program, of the ray's point and of the step may come to, made from the size of each instruction's
    operands [6]_; a `bias` is added to it. A ray hits where a sample is in the solid for certain, and ends no more than
    a bracket after the part that is free for certain. Guarantees are for the ray as the precision holds it: in float32
    the directions of camera rays are off by some 1e-7. Only primary, mirror and query rays are certified. Shapes of
    which no such bound is known raise ValueError: those with `octomarch.solid`, noise, or expressions with other
    functions than sums, products, square roots, sines and cosines, minima and maxima.

    References
    ----------
    .. [1] J. C. Hart, "Sphere tracing", The Visual Computer 12(10), 1996. doi:10.1007/s003710050084
    .. [2] B. Keinert et al., "Enhanced sphere tracing", Smart Tools and Apps for Graphics, 2014.
    .. [3] C. Bálint, G. Valasek, "Accelerating sphere tracing", Eurographics 2018, short papers.
    .. [4] Fulcrum, "8k intro rendering by cone marching", 2012.
    .. [5] W. Barbier et al., "Lipschitz pruning: hierarchical simplification of primitive-based SDFs", Computer
       Graphics Forum 44(2), 2025.
    .. [6] N. J. Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., 2002, ch. 3.

    Examples
    --------
    >>> import octomarch as om
    >>> march = om.March(max_steps=64, epsilon=1e-4)
    >>> int(om.sphere(1.0).raycast([0, 0, 3], [0, 0, -1], march=march).steps)
    2
    >>> fixed = om.March("fixed", step=0.01, min_distance=0.5)
    >>> round(float(om.sphere(1.0).raycast([0, 0, 3], [0, 0, -1], march=fixed).t), 4)
    2.0
    >>> safe = om.March("certified", epsilon=1e-6)
    >>> shell = om.sphere(1.0).shell(1e-3)
    >>> om.Status(int(shell.raycast([0, 0, 3], [0, 0, -1], march=safe, precision="float64").status)).name
    'HIT'
    """

    method: Method
    max_steps: int | None
    epsilon: float | None
    pixel_tolerance: float
    max_distance: float | None
    min_distance: float
    finish: Literal["secant"] | None
    bias: float
    step: float | None
    prune: bool

    def __init__(
        self,
        method: Method = "auto",
        max_steps: int | None = None,
        epsilon: float | None = None,
        pixel_tolerance: float = 0.1,
        max_distance: float | None = None,
        min_distance: float = 0.0,
        finish: Literal["secant"] | None = "secant",
        bias: float = 0.0,
        step: float | None = None,
        prune: bool = True,
    ) -> None:
        check.set_fields(
            self,
            method=check.choice("method", method, _METHODS),
            max_steps=None if max_steps is None else check.integer("max_steps", max_steps, 1),
            epsilon=None if epsilon is None else check.non_negative("epsilon", epsilon),
            pixel_tolerance=check.non_negative("pixel_tolerance", pixel_tolerance),
            max_distance=None if max_distance is None else check.positive("max_distance", max_distance),
            min_distance=check.non_negative("min_distance", min_distance),
            finish=check.choice("finish", finish, ("secant", None)),
            bias=check.non_negative("bias", bias),
            step=None if step is None else check.positive("step", step),
            prune=check.flag("prune", prune),
        )
        if self.max_distance is not None and self.min_distance >= self.max_distance:
            limit = f"max_distance {check.shown(max_distance)}"
            raise ValueError(f"min_distance must be less than {limit}, got {check.shown(min_distance)}")
        if step is not None and method != "fixed":
            raise ValueError(f"step must be None unless method is 'fixed', got {check.shown(step)}")

    def resolve(self, program: Program, origins: ArrayLike, *, pixels: bool = True) -> March:
        """Return these settings with every None replaced by its number.

        Parameters
        ----------
        program : Program
            What is marched.
        origins : array_like of float, shape (..., 3)
            Where rays start: the eye, or the origins of a query. Those not finite are passed over.
        pixels : bool
            True for a render, False for a query.

        Returns
        -------
        March
            With numbers for ``max_steps``, ``epsilon``, ``max_distance`` and, where steps are fixed, ``step``.

        Raises
        ------
        ValueError
            If the method is ``"certified"``, and roundings of the program have no known bound.

        Examples
        --------
        >>> import octomarch as om
        >>> march = om.March().resolve(om.compile(om.box(1.0)), (0, 0, 3))
        >>> round(march.max_distance, 2)
        3.57
        """
        program_of("program", program)
        check.flag("pixels", pixels)
        epsilon, max_distance, step, max_steps = self.epsilon, self.max_distance, self.step, self.max_steps
        if self.method == "certified":
            _require_certifiable(program)
        method: Method = "fixed" if program.is_solid else self.method
        if epsilon is None:
            epsilon = (1e-6 if pixels else 1e-5) * program.size
        if max_distance is None:
            max_distance = _reach(program, check.points("origins", origins).reshape(-1, 3))
            max_distance = max(max_distance, math.nextafter(self.min_distance, math.inf))
        if step is None and method == "fixed":
            step = max(1e-3 * program.size, sys.float_info.min)
        if max_steps is None:
            steps = _CERTIFIED_STEPS if method == "certified" else _STEPS
            max_steps = steps if step is None else _steps_to_pass(max_distance - self.min_distance, step)
        return replace(self, method=method, epsilon=epsilon, max_distance=max_distance, step=step, max_steps=max_steps)

    def bracket(
        self, program: Program, origins: ArrayLike, t: ArrayLike, precision: Precision = "float32"
    ) -> NDArray[np.float64]:
        """Return how far the first root may be from a certified hit; see Notes of the class.

        Parameters
        ----------
        program : Program
            What was marched.
        origins : array_like of float, shape (..., 3)
            Where the rays start.
        t : array_like of float
            Where they hit, in scene units; broadcast against the origins.
        precision : {"float32", "float64"}
            Of the query, or the picture, whose ``pixel_tolerance`` this leaves out.

        Returns
        -------
        ndarray of float64
            Scene units; +inf where the field's roundings are not known.

        Raises
        ------
        ValueError
            If these settings are not resolved, or not certified.

        Examples
        --------
        >>> import octomarch as om
        >>> program = om.compile(om.sphere(1.0))
        >>> march = om.March("certified", epsilon=1e-6).resolve(program, (0, 0, 3))
        >>> float(march.bracket(program, (0, 0, 3), 2.0, "float64"))
        1e-06
        """
        if self.epsilon is None or self.method != "certified":
            raise ValueError("march must be certified and resolved: see March.resolve")
        program_of("program", program)
        precision = check.choice("precision", precision, ("float32", "float64"))
        offset, slope, reach = program._native.doubt(precision)
        away = np.abs(check.points("origins", origins) - np.array(program.anchor)).max(axis=-1)
        far = away + check.broadcastable("t", t, away.shape)
        doubt = np.where(far <= reach, offset + self.bias + slope * far, np.inf)
        bracket: NDArray[np.float64] = np.maximum(_DOUBTS_OF_BRACKET * doubt, self.epsilon)
        return bracket

    @classmethod
    def for_error(
        cls,
        scene: Shape | Scene,
        camera: AnyCamera | None = None,
        p95: float = 1e-4,
        misses: float = 0.0,
        *,
        false_hits: float = 1.0,
        size: tuple[int, int] = (640, 480),
        precision: Precision = "float32",
        max_distance: float | None = None,
        threads: int | None = None,
        progress: bool | Callable[[int, int], None] | None = None,
    ) -> March:
        """Return the cheapest settings whose error is small enough, as measured on a sample of a picture.

        Candidates differ in method, hit epsilon, finish and number of steps. They are rendered in 32 windows of 32×32
        pixels spread over the picture, all of a small one, and held against the truth, as `octomarch.study` does. The
        target has to be met on one half of the windows with two standard errors or more to spare, and on the other half
        too, so that it should hold for the rest of the picture; where that leaves doubt, up to 512 windows are looked
        at. The cheapest settings are those with the fewest evaluations of the field, which are the same on every
        machine.

        Parameters
        ----------
        scene : Shape or Scene
            What is seen; light has no say.
        camera : Camera, OrthographicCamera or PanoramicCamera, optional
            None: one that frames the bounded parts of the shape.
        p95 : float
            Error of depth in scene units, > 0, that 95 of 100 rays may not exceed, of those that meet a surface in the
            picture or in truth. Rays that meet one in only one of the two are infinitely wrong; those that ran out of
            steps count with their candidate.
        misses : float
            Share of the sample's rays that may miss a surface, 0 to 1: 0 for none.
        false_hits : float
            Share that may hit where nothing is, which large hit epsilons do along silhouettes.
        size : (int, int)
            Width and height of the picture in pixels, which the hit epsilon goes by.
        precision : {"float32", "float64"}
            Of the picture.
        max_distance : float, optional
            Of the settings, and of the truth.
        threads
            As for `octomarch.render`.
        progress : bool, callable or Progress, optional
            True shows a bar. A callable gets (families of candidates done, families in all) from time to time, and what
            it raises ends the search. A `Progress` can be cancelled.

        Returns
        -------
        March
            With what was measured of it as `measured`.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range; if no candidate meets the target, saying how near
            the nearest came, or the camera sees no surface.
        SceneError
            If the shape cannot be compiled.
        KeyboardInterrupt, CancelledError
            Ctrl-C and `Progress.cancel` stop the search at once.

        Examples
        --------
        >>> import octomarch as om
        >>> shape = om.sphere(1.0) - om.box(1.2)
        >>> march = om.March.for_error(shape, size=(160, 120), p95=1e-3)
        >>> march.measured.p95 <= 1e-3
        True
        >>> om.render(shape, size=(160, 120), march=march)
        <Image 160×120: color>
        """
        from octomarch.study.search import march_for_error  # here, since it builds on this module

        return march_for_error(scene, camera, p95, misses, false_hits, size, precision, max_distance, threads, progress)

    @property
    def measured(self) -> Measured | None:
        """What `for_error` has measured of these settings; None for others, and for changed copies."""
        found: Measured | None = self.__dict__.get("_measured")
        return found

    def _native(self) -> _core.March:
        """Convert settings that `resolve` has filled."""
        if self.max_steps is None or self.epsilon is None or self.max_distance is None:
            raise ValueError("march must be resolved first: see March.resolve")
        return _core.March(
            self.method,
            self.max_steps,
            self.epsilon,
            self.pixel_tolerance,
            self.max_distance,
            self.min_distance,
            self.bias,
            self.step or 1.0,  # plain marches have none
            self.finish is not None,
            self.prune,
        )


def _is_certifiable(program: Program) -> bool:
    return not program.is_solid and all(math.isfinite(program._native.doubt(p)[0]) for p in ("float32", "float64"))


def _require_certifiable(program: Program) -> None:
    if not _is_certifiable(program):
        raise ValueError(
            "method must not be 'certified' for a shape with operators whose roundings have no known bound: see March"
        )


def _steps_to_pass(distance: float, step: float) -> int:
    """Return how many evaluations pass a distance in fixed steps.

    A step is eight units in the last place of t at the least, of which an addition may lose half of one.
    """
    return min(math.ceil(min(16 / 15 * distance / step, 2**31)) + 2, 2**31 - 1)


@np.errstate(over="ignore")  # what lies too far for a number is as far as numbers go
def _reach(program: Program, origins: NDArray[np.float64]) -> float:
    """Return how far rays from `origins`, and shadow rays from what they hit, may have to go.

    A thousandth is added so that rounding does not lose what lies at the very end.
    """
    lo, hi = (np.array(corner) for corner in program.bounds)
    if np.isfinite(lo).all() and np.isfinite(hi).all():
        reach = 1.001 * max(_farthest(origins, lo, hi), float(np.linalg.norm(hi - lo)))
    else:
        centre = np.mean(program.focus or ((0.0, 0.0, 0.0),), axis=0)
        sizes = 10.0 if program.is_solid else 1000.0  # fixed steps take as long as the way is
        reach = sizes * max(program.size, _farthest(origins, centre, centre))
    return min(max(reach, sys.float_info.min), sys.float_info.max)


def _farthest(origins: NDArray[np.float64], lo: NDArray[np.float64], hi: NDArray[np.float64]) -> float:
    """Return how far a corner of a box is from one of the origins at the most; those not finite are passed over.

    In parts that stay in the cache, which takes a fifth of the time, and between which Ctrl-C is heard.
    """
    farthest = 0.0
    for first in range(0, len(origins), _ROWS):
        part = origins[first : first + _ROWS]
        part = part[np.isfinite(part).all(axis=1)]
        away = np.linalg.norm(np.maximum(np.abs(part - lo), np.abs(part - hi)), axis=1)
        farthest = max(farthest, float(away.max(initial=0.0)))
    return farthest
