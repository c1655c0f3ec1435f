"""The settings for an error that is wanted: candidates, and the cheapest of them that meets the target on a sample.

`sample` comes before it, `March.for_error` is how users reach it. Settings are chosen by half of the windows and have
to hold on the other half, lest they fit one half by chance. Where few windows leave doubt, more are looked at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.camera import AnyCamera, or_framing
from octomarch.march import March
from octomarch.program import compile
from octomarch.progress import Callback, reporting
from octomarch.scene import Scene
from octomarch.shapes import Shape
from octomarch.study.sample import Sample, Target, Trial, sampled
from octomarch.study.settings import changed

_WINDOWS = (32, 128, 512)
_METHODS = ("auto", "enhanced")
_TOLERANCES = (8.0, 4.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
_EPSILONS = (1e-6, 1e-7, 1e-8, 1e-9)  # of the scene's size, without a pixel tolerance
_STEPS = (16, 32, 64, 128, 256, 512, 1024)
_ENOUGH_STEPS = 8192
_SOLID_STEPS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4)  # of the scene's size


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
    progress: bool | Callback | None,
) -> March:
    """Return the cheapest settings that meet a target on a sample; see `March.for_error`."""
    target = Target(
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
    families = _solid_families(base, program.size) if program.is_solid else _families(base, program.size)
    with reporting(progress, "search", " settings") as report:
        if report is not None:
            report(0, len(families))
        sample = sampled(bare, camera, whole, base, _WINDOWS[0], *options)
        trials = _tuned(sample.half(0), families, target, report)
        for count in _WINDOWS:
            if count > _WINDOWS[0] and sample.share < 1:
                sample = sampled(bare, camera, whole, base, count, *options)
            found, trials = _cheapest(sample, trials, target)
            if found is not None:
                return found
            if sample.share >= 1 or not any(trial.meets(target, -1) for trial in trials):
                break
    raise ValueError(_how_near(sample, trials, target))


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


def _tuned(half: Sample, families: Sequence[list[March]], target: Target, report: Callback | None) -> list[Trial]:
    """Return what was measured on a half of the sample.

    Of each family the member with enough steps comes first: if that misses the target, fewer steps would too. Else all
    are measured up to the least number of steps that meets it for sure.
    """
    trials = []
    for done, family in enumerate(families):
        if report is not None:
            report(done, len(families))
        trials.append(half.trial(family[-1]))
        if not trials[-1].meets(target, -1):
            continue
        for march in family[:-1]:
            trials.append(half.trial(march))
            if trials[-1].meets(target, 1):
                break
    return trials


def _cheapest(sample: Sample, trials: Sequence[Trial], target: Target) -> tuple[March | None, list[Trial]]:
    """Return the cheapest settings that meet the target on one half of a sample for sure, and on the other half.

    And what was measured of those that came before them; of all others that may meet it, where there are none.
    """
    measured = []
    for trial in sorted(trials, key=_cost):
        if not trial.meets(target, -1):
            continue
        measured.append(sample.half(0).trial(trial.march))
        if measured[-1].meets(target, 1) and (sample.share >= 1 or sample.half(1).trial(trial.march).meets(target)):
            found = replace(trial.march)
            object.__setattr__(found, "_measured", sample.trial(found).numbers(sample.truth))
            return found, measured
    return None, measured or list(trials)


def _cost(trial: Trial) -> tuple[float, int]:
    """Return evaluations, and the number of steps to tell equal ones apart."""
    return trial.cost, trial.march.max_steps or 0


def _how_near(sample: Sample, trials: Sequence[Trial], target: Target) -> str:
    """Say which settings came nearest, those with few enough rays that end wrong first."""

    def distance(trial: Trial) -> tuple[bool, float, float]:
        return not trial.ends_well(target), trial.late(target.p95), trial.numbers("").p95

    nearest = sample.trial(min(trials, key=distance).march)
    found = nearest.numbers(sample.truth)
    if nearest.meets(target):
        hint = f"; that it holds beyond the {sample.share:.0%} of the picture looked at is too doubtful"
    else:
        hint = "; precision='float64' comes nearer" if sample.precision == "float32" else ""
    return (
        f"no settings meet {target} in {sample.precision}: the nearest have p95 {found.p95:.3g}, {found.misses} misses "
        f"and {found.false_hits} false hits of {found.rays} rays: {nearest.march}{hint}"
    )
