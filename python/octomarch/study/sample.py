"""A sample of a picture, windows of pixels spread over all of it, and what settings give there.

`truth` and `errors` come before it, `search` after it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from octomarch._validate import Precision
from octomarch.camera import AnyCamera
from octomarch.march import March, Status
from octomarch.planes import PlaneName
from octomarch.program import compile
from octomarch.render import render
from octomarch.scene import Scene
from octomarch.study.errors import percentiles, ray_errors
from octomarch.study.measure import evaluations
from octomarch.study.truth import Truth, find_truth, told

Window = tuple[int, int, int, int]

_SIDE = 32  # pixels of a window, a multiple of a cone's eight
_PROVEN = 0.5  # of the budget of a study
_LATE = 0.05  # share of rays that may be farther off than the target: what a 95th percentile is
_CAUTION = 2.0  # standard errors by which a sample may differ from the picture by chance
_FEW = 2.3  # with n windows (1 + 2.3 / (n - 1)) times as many: near the quantiles of Student's t


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
class Target:
    """What is asked for: an error of depth, and shares of rays that may end wrong."""

    p95: float
    misses: float
    false_hits: float

    def __str__(self) -> str:
        return f"p95 ≤ {self.p95:g}, misses ≤ {self.misses:g}, false hits ≤ {self.false_hits:g}"


@dataclass(frozen=True, eq=False)
class Trial:
    """What settings gave on windows, one array of errors for each."""

    march: March
    cost: float
    errors: list[NDArray[np.float64]]
    misses: int
    false_hits: int
    rays: int
    share: float
    """Of the picture that was looked at."""

    def meets(self, target: Target, doubt: float = 0.0) -> bool:
        """Tell whether the target is met; with doubt +1 for sure, on the rest of the picture too, with -1 perhaps."""
        return self.late(target.p95, doubt) <= _LATE and self.ends_well(target)

    def late(self, limit: float, doubt: float = 0.0) -> float:
        """Return which share of rays is farther off than `limit`: as seen, or at the most (+1) or the least (-1).

        Windows, not rays, are what was drawn: neighbours err together. The less of the picture is left unseen, the less
        there is to be doubted.
        """
        counts = np.array([errors.size for errors in self.errors], dtype=np.float64)
        bad = np.array([np.count_nonzero(errors > limit) for errors in self.errors], dtype=np.float64)
        n, total = int(np.count_nonzero(counts)), max(float(counts.sum()), 1.0)
        mean = float(bad.sum()) / total
        if not doubt or self.share >= 1:
            return mean
        if n < 2:
            return max(doubt, 0.0)
        spread = float(np.sum((bad - mean * counts) ** 2)) * n / (n - 1)
        deviations = doubt * _CAUTION * (1 + _FEW / (n - 1))
        return mean + deviations * math.sqrt(spread * (1.0 - self.share)) / total

    def ends_well(self, target: Target) -> bool:
        """Tell whether few enough rays miss, and hit where nothing is."""
        return self.misses <= target.misses * self.rays and self.false_hits <= target.false_hits * self.rays

    def numbers(self, truth: str) -> Measured:
        """Return the figures of all windows together."""
        p50, p95, p99 = percentiles(np.concatenate(self.errors))
        return Measured(self.cost, p50, p95, p99, self.misses, self.false_hits, self.rays, truth)


@dataclass(frozen=True, eq=False)
class Part:
    """One window of the sample and its truth."""

    crop: Window
    truth: Truth


@dataclass(frozen=True, eq=False)
class Sample:
    """The windows of a picture on which settings are measured."""

    scene: Scene
    camera: AnyCamera
    size: tuple[int, int]
    precision: Precision
    threads: int | None
    parts: list[Part]
    share: float
    """Of the picture that all windows are."""

    @property
    def truth(self) -> str:
        """How the truth was found."""
        return told([part.truth for part in self.parts])

    def half(self, index: int) -> Sample:
        """Return every other window; the one that there is where nothing of the picture is left unseen."""
        return self if self.share >= 1 else replace(self, parts=self.parts[index::2])

    def trial(self, march: March) -> Trial:
        """Measure settings on all windows."""
        errors, evaluated, misses, false_hits, rays = [], 0.0, 0, 0, 0
        for part in self.parts:
            image = render(
                self.scene,
                self.camera,
                self.size,
                march=march,
                planes=("depth", "status"),
                precision=self.precision,
                crop=part.crop,
                threads=self.threads,
            )
            depth = part.truth.depth
            of_rays = ray_errors(image.depth, depth)
            errors.append(of_rays[~np.isnan(of_rays)])
            evaluated += evaluations(image) * depth.size
            misses += int(np.count_nonzero(np.isfinite(depth) & (image.status == Status.MISS)))
            false_hits += int(np.count_nonzero((depth == np.inf) & (image.status == Status.HIT)))
            rays += depth.size
        return Trial(march, evaluated / rays, errors, misses, false_hits, rays, self.share)


def sampled(
    scene: Scene,
    camera: AnyCamera,
    size: tuple[int, int],
    base: March,
    count: int,
    precision: Precision = "float32",
    threads: int | None = None,
) -> Sample:
    """Return windows of a picture with their truth.

    Raises
    ------
    ValueError
        If nothing is seen in them.

    Examples
    --------
    >>> import octomarch as om
    >>> sample = sampled(om.Scene(om.sphere(1.0)), om.Camera((0, 0, 3), (0, 0, 0)), (320, 240), March(), 32)
    >>> len(sample.parts), round(sample.share, 2)
    (32, 0.4)
    """
    march = base.resolve(compile(scene), camera._ray_origins(size))
    crops = windows(size, count)
    share = _PROVEN / len(crops)
    planes: tuple[PlaneName, ...] = ("depth", "status")
    parts = [
        Part(crop, find_truth(scene, camera, size, march, planes=planes, share=share, crop=crop, threads=threads))
        for crop in crops
    ]
    if not any(np.isfinite(part.truth.depth).any() for part in parts):
        raise ValueError(f"camera must see a surface: none is met in {len(parts)} windows of a picture of {size}")
    pixels = sum(width * height for _, _, width, height in crops)
    return Sample(scene, camera, size, precision, threads, parts, pixels / (size[0] * size[1]))


def windows(size: tuple[int, int], count: int) -> list[Window]:
    """Return windows of pixels spread over a picture, no two of which overlap; one that is all of a small one.

    More windows are those of a smaller number, and others.

    Examples
    --------
    >>> windows((64, 40), 32)
    [(0, 0, 64, 40)]
    >>> len(windows((640, 480), 32))
    32
    """
    width, height = size
    columns, rows = math.ceil(width / _SIDE), math.ceil(height / _SIDE)
    if columns * rows <= count:
        return [(0, 0, width, height)]
    corners = [(_SIDE * column, _SIDE * row) for column, row in _spread(columns, rows, count)]
    return [(x, y, min(_SIDE, width - x), min(_SIDE, height - y)) for x, y in corners]


def _spread(columns: int, rows: int, count: int) -> list[tuple[int, int]]:
    """Return `count` different cells, by the additive recurrence of M. Roberts that fills a square evenly."""
    plastic = 1.32471795724474602596
    found: dict[tuple[int, int], None] = {}
    index = 0
    while len(found) < count:
        u, v = (0.5 + index / plastic) % 1, (0.5 + index / plastic**2) % 1
        found[int(u * columns), int(v * rows)] = None
        index += 1
    return list(found)
