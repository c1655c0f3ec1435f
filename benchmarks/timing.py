"""Paired timing: in every round each contender runs once, so that whatever else the machine does meets all of them.

contenders.py and sweeps/ come before it, report.py and the tables after it.
"""

import gc
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

LEAST_ROUNDS = 3

Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)


class Timed(Protocol[Result_co]):
    """What can be timed; `key` tells it from the others."""

    @property
    def key(self) -> str: ...

    @property
    def run(self) -> Callable[[], Result_co]: ...


@dataclass
class Times:
    """Milliseconds per round: by the clock on the wall, and of processor time over all threads."""

    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)

    def add(self, run: Callable[[], Result]) -> Result:
        """Run once more, and return what that returns."""
        wall, cpu = time.perf_counter_ns(), time.process_time_ns()
        result = run()
        self.cpu.append((time.process_time_ns() - cpu) / 1e6)
        self.wall.append((time.perf_counter_ns() - wall) / 1e6)
        return result


def measure(
    contenders: Sequence[Timed[Result_co]], rounds: int, progress: Callable[[int], None], seconds: float = math.inf
) -> tuple[dict[str, Times], dict[str, Result_co]]:
    """Run `rounds` rounds after one that only warms up, and return times, and what the first one returned, by key.

    The order moves on by one each round, so that no contender always comes first. After `seconds` three rounds suffice.
    """
    outcomes = {contender.key: contender.run() for contender in contenders}
    times = {contender.key: Times() for contender in contenders}
    gc.collect()
    gc.disable()
    start = time.perf_counter()
    try:
        for index in range(rounds):
            if index >= LEAST_ROUNDS and time.perf_counter() - start > seconds:
                break
            shift = index % len(contenders)
            for contender in (*contenders[shift:], *contenders[:shift]):
                times[contender.key].add(contender.run)
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
