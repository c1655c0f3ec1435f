"""What one setting costs and how wrong it is: evaluations, paired times, and errors against the truth.

`settings` and `truth` come before it, `rows` keep what it finds.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from octomarch.camera import AnyCamera
from octomarch.empty import expected
from octomarch.image import Image
from octomarch.planes import PlaneName
from octomarch.progress import Callback
from octomarch.render import render
from octomarch.scene import Scene
from octomarch.study import flip
from octomarch.study.errors import depth_errors, normal_angles, percentiles, status_counts
from octomarch.study.rows import Measures
from octomarch.study.settings import Setting
from octomarch.study.truth import Answer

_PLANES: tuple[PlaneName, ...] = ("color", "depth", "normal", "status")
_SHADING = ("normals", "materials", "occlusion", "shadow", "reflection", "sky")


@dataclass(frozen=True)
class Subject:
    """What is rendered with each setting, and how often that is timed."""

    scene: Scene
    camera: AnyCamera
    size: tuple[int, int]
    rounds: int
    threads: int | None = None
    isa: str | None = None

    def picture(self, setting: Setting, planes: tuple[PlaneName, ...] = _PLANES) -> Image:
        """Render with a setting."""
        with expected():
            return render(
                self.scene,
                self.camera,
                self.size,
                march=setting.march,
                shading=setting.shading,
                planes=planes,
                precision=setting.precision,
                threads=self.threads,
                isa=self.isa,
            )


@dataclass(frozen=True, eq=False)
class Measurement:
    """All that is needed to measure one setting, on whatever machine."""

    subject: Subject
    setting: Setting
    base: Setting
    truth: Answer
    reach: float
    """How far rays go where the setting does not say."""


def measure(work: Measurement, progress: Callback | None = None) -> Measures:  # noqa: ARG001  pictures ask by themselves
    """Return what a setting costs, in time beside the base, and how far its picture is from the truth."""
    subject, setting, base, truth = work.subject, work.setting, work.base, work.truth
    image = subject.picture(setting)
    rays = image.stats["rays"]
    normal_p50, normal_p95, _ = percentiles(normal_angles(image.normal, truth.normal))
    limit = work.reach if setting.march.max_distance is None else setting.march.max_distance
    depth_times = paired_times(subject, setting, base, ("depth",))
    picture_times = paired_times(subject, setting, base, ("color",))
    return Measures(
        evaluations=evaluations(image),
        shading_evaluations=sum(image.stats["stages"][stage]["evaluations"] for stage in _SHADING) / rays,
        **vars(depth_errors(image.depth, image.status, truth.depth, limit)),
        normal_p50=normal_p50,
        normal_p95=normal_p95,
        **status_counts(image.status),
        flip=_flip(truth.levels, image.to_srgb()),
        depth_ms=depth_times[0],
        depth_ratio=depth_times[1],
        picture_ms=picture_times[0],
        picture_ratio=picture_times[1],
    )


def evaluations(image: Image) -> float:
    """Return how often the field was evaluated for each camera ray, its share of cones included.

    Examples
    --------
    >>> import octomarch as om
    >>> evaluations(om.render(om.sphere(1.0), size=(32, 24))) > 1
    True
    """
    stages = image.stats["stages"]
    return float((stages["primary"]["evaluations"] + stages["cones"]["evaluations"]) / image.stats["rays"])


def paired_times(
    subject: Subject, setting: Setting, base: Setting, planes: tuple[PlaneName, ...]
) -> tuple[float | None, float | None]:
    """Return the median milliseconds of a picture, and the median ratio to the base's in the same round.

    Processor time over all threads, which other work on the machine disturbs least. Each round renders both, the other
    one first from round to round.
    """
    if not subject.rounds:
        return None, None
    own: list[float] = []
    others: list[float] = []
    for index in range(subject.rounds):
        for mine in (True, False) if index % 2 else (False, True):
            chosen = setting if mine else base
            (own if mine else others).append(_milliseconds(partial(subject.picture, chosen, planes)))
    return float(np.median(own)), float(np.median(np.divide(own, others)))


def _milliseconds(run: Callable[[], object]) -> float:
    start = time.process_time_ns()
    run()
    return max(time.process_time_ns() - start, 1) / 1e6


def _flip(reference: NDArray[np.uint8], picture: NDArray[np.uint8]) -> float | None:
    return float(flip.flip_map(reference, picture).mean()) if flip.available() else None
