"""Paired timing: in every round each contender runs once, so that whatever else the machine does meets all of them.

contenders.py comes before it, report.py after it.
"""

import gc
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contenders import Contender, Outcome


@dataclass
class Times:
    """Milliseconds per round: by the clock on the wall, and of processor time over all threads."""

    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)


def measure(
    contenders: list[Contender], rounds: int, progress: Callable[[int], None]
) -> tuple[dict[str, Times], dict[str, Outcome]]:
    """Run `rounds` rounds after one that only warms up, and return times and outcomes by key.

    The order moves on by one each round, so that no contender always comes first.
    """
    outcomes = {contender.key: contender.run() for contender in contenders}
    times = {contender.key: Times() for contender in contenders}
    gc.collect()
    gc.disable()
    try:
        for index in range(rounds):
            shift = index % len(contenders)
            for contender in contenders[shift:] + contenders[:shift]:
                wall, cpu = time.perf_counter_ns(), time.process_time_ns()
                contender.run()
                times[contender.key].cpu.append((time.process_time_ns() - cpu) / 1e6)
                times[contender.key].wall.append((time.perf_counter_ns() - wall) / 1e6)
            progress(index + 1)
    finally:
        gc.enable()
    return times, outcomes


def ratio(slower: list[float], faster: list[float]) -> float:
    """Return the median over rounds of slower ÷ faster."""
    return float(np.median(np.divide(slower, faster)))


@dataclass(frozen=True)
class Agreement:
    """How one depth plane differs from another: pixels, and scene units."""

    different_hits: int
    different_depths: int
    median_difference: float
    largest_difference: float


def compare(depth: NDArray[np.float32], reference: NDArray[np.float32]) -> Agreement:
    """Compare two depth planes; differences of t are over the pixels where both have a hit."""
    hit, expected = np.isfinite(depth), np.isfinite(reference)
    both = hit & expected
    difference = np.abs(depth[both].astype(np.float64) - reference[both])
    differing = difference[difference > 0]
    return Agreement(
        different_hits=int(np.count_nonzero(hit != expected)),
        different_depths=int(differing.size),
        median_difference=float(np.median(differing)) if differing.size else 0.0,
        largest_difference=float(differing.max(initial=0.0)),
    )
