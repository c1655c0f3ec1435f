"""The settings for an error that is wanted: candidates, a sample of the picture, and the cheapest that meet the target.

`truth` and `errors` come before it, `March.for_error` is how users reach it. The sample is windows of pixels of the
picture that is meant, spread over all of it. Settings are chosen by half of them and have to hold on the other half,
lest they fit one half by chance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.camera import AnyCamera, or_framing
from octomarch.march import March, Status
from octomarch.program import compile
from octomarch.render import Progress, _reporting, render
from octomarch.scene import Scene
from octomarch.shapes import Shape
from octomarch.study.errors import percentiles, ray_errors
from octomarch.study.settings import changed
from octomarch.study.truth import Truth, find_truth, told

Window = tuple[int, int, int, int]

_SIDE = 32  # pixels of a window, a multiple of a cone's eight
_WINDOWS = 32
_PROVEN = 0.5  # of the budget of a study
_LATE = 0.05  # share of rays that may be farther off than the target: what a 95th percentile is
_CAUTION = 2.0  # standard errors that a sample is taken to be better than the picture, by chance
_METHODS = ("auto", "enhanced")
_TOLERANCES = (8.0, 4.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
_EPSILONS = (1e-6, 1e-7, 1e-8, 1e-9)  # of the scene's size, without a pixel tolerance
_STEPS = (16, 32, 64, 128, 256, 512, 1024)
_ENOUGH_STEPS = 8192
_SOLID_STEPS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4)  # of the scene's size


@dataclass(frozen=True)
class Measured:
    """What `March.for_error` has measured of the settings that it returns.

    Examples
    --------
    >>> import octomarch as om
    >>> march = om.March.for_error(om.sphere(1.0), size=(64, 48), p95=1e-4)
    >>> march.measured.p95 <= 1e-4, march.measured.misses
    (True, 0)
    """

    evaluations: float
    """Of the field for each camera ray, cones included."""
    p50: float
    """Error of depth in scene units that half of the rays that meet a surface, in the picture or in truth, do not
    exceed; those that meet one in only one of them count as infinitely wrong."""
    p95: float
    """The same for 95 of 100 rays."""
    p99: float
    """The same for 99 of 100 rays."""
    misses: int
    """Rays of the sample that miss a surface."""
    false_hits: int
    """Rays of the sample that hit where nothing is."""
    rays: int
    """Rays of the sample."""
    truth: str
    """How the truth was found."""


@dataclass(frozen=True)
class _Target:
    p95: float
    misses: float
    false_hits: float

    def __str__(self) -> str:
        return f"p95 ≤ {self.p95:g}, misses ≤ {self.misses:g}, false hits ≤ {self.false_hits:g}"


@dataclass(frozen=True, eq=False)
class _Part:
    """One window of the sample and its truth."""

    crop: Window
    truth: Truth


@dataclass(frozen=True)
class _Sample:
    """The windows of a picture on which settings are measured."""

    scene: Scene
    camera: AnyCamera
    size: tuple[int, int]
    precision: Precision
    threads: int | None
    parts: list[_Part]
    share: float
    """Of the picture that the windows are."""

    def half(self, index: int) -> _Sample:
        """Return every other window; all of them where nothing of the picture is left unseen."""
        return self if self.share >= 1 else replace(self, parts=self.parts[index::2])


@dataclass(frozen=True, eq=False)
class _Trial:
    """What settings gave on windows, one array of errors for each."""

    march: March
    cost: float
    errors: list[NDArray[np.float64]]
    misses: int
    false_hits: int
    rays: int

    def late(self, limit: float, share: float) -> float:
        """Return which share of rays is farther off than `limit`, by an estimate on the safe side.

        Windows, not rays, are what was drawn: neighbours err together. The less of the picture is left unseen, the less
        there is to be cautious about.
        """
        counts = np.array([errors.size for errors in self.errors], dtype=np.float64)
        bad = np.array([np.count_nonzero(errors > limit) for errors in self.errors], dtype=np.float64)
        n, total = len(counts), max(float(counts.sum()), 1.0)
        mean = float(bad.sum()) / total
        if n < 2 or share >= 1:
            return mean
        spread = float(np.sum((bad - mean * counts) ** 2)) * n / (n - 1)
        return mean + _CAUTION * math.sqrt(spread * (1.0 - share)) / total

    def meets(self, target: _Target, share: float) -> bool:
        return self.late(target.p95, share) <= _LATE and self.ends_well(target)

    def ends_well(self, target: _Target) -> bool:
        return self.misses <= target.misses * self.rays and self.false_hits <= target.false_hits * self.rays

    def numbers(self, truth: str) -> Measured:
        p50, p95, p99 = percentiles(np.concatenate(self.errors))
        return Measured(self.cost, p50, p95, p99, self.misses, self.false_hits, self.rays, truth)


def march_for_error(
    scene: Shape | Scene,
    camera: AnyCamera | None,
    p95: float,
    misses: float,
    false_hits: float,
    size: tuple[int, int],
    precision: Precision,
    max_distance: float | None,
    threads: int | None,
    progress: bool | Progress | None,
) -> March:
    """Return the cheapest settings that meet a target on a sample; see `March.for_error`."""
    target = _Target(
        check.positive("p95", p95), check.fraction("misses", misses), check.fraction("false_hits", false_hits)
    )
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    whole = check.size(size)
    options = check.precision(precision), check.threads(threads) or None
    base = March(max_distance=max_distance)
    program = compile(scene)
    camera = or_framing(camera, program, whole)
    bare = scene if isinstance(scene, Scene) else Scene(scene)
    sample = _sampled(bare, camera, whole, base, *options)
    families = _solid_families(base, program.size) if program.is_solid else _families(base, program.size)
    with _reporting(progress, "search", " settings") as report:
        trials = _tuned(sample, families, target, report)
    return _chosen(sample, trials, target)


def windows(size: tuple[int, int], count: int = _WINDOWS) -> list[Window]:
    """Return windows of pixels spread over a picture, no two of which overlap; all of a small one.

    Examples
    --------
    >>> windows((64, 40))
    [(0, 0, 32, 32), (32, 0, 32, 32), (0, 32, 32, 8), (32, 32, 32, 8)]
    >>> len(windows((640, 480)))
    32
    """
    width, height = size
    tiles = [(x, y) for y in range(0, height, _SIDE) for x in range(0, width, _SIDE)]
    if len(tiles) > count:
        tiles = [tiles[i] for i in _spread(math.ceil(width / _SIDE), math.ceil(height / _SIDE), count)]
    return [(x, y, min(_SIDE, width - x), min(_SIDE, height - y)) for x, y in tiles]


def _spread(columns: int, rows: int, count: int) -> list[int]:
    """Return `count` different tiles, by the additive recurrence of M. Roberts that fills a square evenly."""
    plastic = 1.32471795724474602596
    found: dict[int, None] = {}
    index = 0
    while len(found) < count:
        u, v = (0.5 + index / plastic) % 1, (0.5 + index / plastic**2) % 1
        found[int(v * rows) * columns + int(u * columns)] = None
        index += 1
    return list(found)


def _sampled(
    scene: Scene, camera: AnyCamera, size: tuple[int, int], base: March, precision: Precision, threads: int | None
) -> _Sample:
    """Return the windows of a picture with their truth."""
    march = base.resolve(compile(scene), camera._ray_origins(size))
    crops = windows(size)
    parts = [
        _Part(
            crop,
            find_truth(scene, camera, size, march, planes=("depth", "status"), share=share, crop=crop, threads=threads),
        )
        for share in [_PROVEN / len(crops)]
        for crop in crops
    ]
    if not any(np.isfinite(part.truth.depth).any() for part in parts):
        raise ValueError(f"camera must see a surface: none is met in {len(parts)} windows of a picture of {size}")
    pixels = sum(width * height for _, _, width, height in crops)
    return _Sample(scene, camera, size, precision, threads, parts, pixels / (size[0] * size[1]))


def _families(base: March, size: float) -> list[list[March]]:
    """Return candidates that differ in the number of steps alone, fewest first, with enough for every ray last."""
    tolerances: list[dict[str, Any]] = [{"pixel_tolerance": tolerance} for tolerance in _TOLERANCES]
    tolerances += [{"pixel_tolerance": 0.0, "epsilon": factor * size} for factor in _EPSILONS]
    kinds = [
        changed(base, method=method, finish=finish, **tolerance)
        for method in _METHODS
        for finish in ("secant", None)
        for tolerance in tolerances
    ]
    return [[replace(kind, max_steps=steps) for steps in (*_STEPS, _ENOUGH_STEPS)] for kind in kinds]


def _solid_families(base: March, size: float) -> list[list[March]]:
    """Return candidates where steps are fixed: as many as are needed, of different lengths."""
    return [
        [changed(base, method="fixed", step=factor * size, finish=finish)]
        for factor in _SOLID_STEPS
        for finish in ("secant", None)
    ]


def _tuned(sample: _Sample, families: Sequence[list[March]], target: _Target, report: Progress | None) -> list[_Trial]:
    """Return what was measured on the first half of the sample.

    Of each family the member with enough steps comes first: if that fails, fewer steps would fail too. Else it is the
    least number of steps that does not.
    """
    half, trials = sample.half(0), []
    for done, family in enumerate(families):
        if report is not None:
            report(done, len(families))
        trials.append(_trial(half, family[-1]))
        if not trials[-1].meets(target, sample.share):
            continue
        for march in family[:-1]:
            trials.append(_trial(half, march))
            if trials[-1].meets(target, sample.share):
                break
    return trials


def _chosen(sample: _Sample, trials: list[_Trial], target: _Target) -> March:
    """Return the cheapest settings that meet the target on both halves. Raise ValueError where none does."""
    truth = told([part.truth for part in sample.parts])
    for trial in sorted(trials, key=lambda trial: (trial.cost, trial.march.max_steps or 0)):
        if trial.meets(target, sample.share):
            other = _trial(sample.half(1), trial.march)
            if other.meets(target, 1.0):
                found = replace(trial.march)
                object.__setattr__(found, "_measured", _trial(sample, trial.march).numbers(truth))
                return found
    raise ValueError(_how_near(sample, trials, target, truth))


def _how_near(sample: _Sample, trials: list[_Trial], target: _Target, truth: str) -> str:
    """Say which settings came nearest, those with few enough rays that end wrong first."""

    def distance(trial: _Trial) -> tuple[bool, float, float]:
        return not trial.ends_well(target), trial.late(target.p95, sample.share), trial.numbers(truth).p95

    nearest = _trial(sample, min(trials, key=distance).march)
    found = nearest.numbers(truth)
    hint = "; precision='float64' comes nearer" if sample.precision == "float32" else ""
    return (
        f"no settings meet {target} in {sample.precision}: the nearest have p95 {found.p95:.3g}, {found.misses} misses "
        f"and {found.false_hits} false hits of {found.rays} rays: {nearest.march}{hint}"
    )


def _trial(sample: _Sample, march: March) -> _Trial:
    """Measure settings on the windows of a sample."""
    errors, evaluated, misses, false_hits, rays = [], 0, 0, 0, 0
    for part in sample.parts:
        image = render(
            sample.scene,
            sample.camera,
            sample.size,
            march=march,
            planes=("depth", "status"),
            precision=sample.precision,
            crop=part.crop,
            threads=sample.threads,
        )
        depth = part.truth.depth
        of_rays = ray_errors(image.depth, depth)
        errors.append(of_rays[~np.isnan(of_rays)])
        evaluated += image.stats["primary_evaluations"] + image.stats["cone_evaluations"]
        misses += int(np.count_nonzero(np.isfinite(depth) & (image.status == Status.MISS)))
        false_hits += int(np.count_nonzero((depth == np.inf) & (image.status == Status.HIT)))
        rays += depth.size
    return _Trial(march, evaluated / rays, errors, misses, false_hits, rays)
