"""How thoroughly to measure, and the rounds of a sweep as rows. timing.py comes before it, the sweeps after it."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from timing import measure

Row = dict[str, Any]
Made = TypeVar("Made")


@dataclass(frozen=True)
class Plan:
    """Rounds and sizes. Three rounds suffice for pictures whose rounds have taken `seconds`."""

    rounds: int = 11
    seconds: float = 8.0
    size: tuple[int, int] = (640, 480)
    balls: int = 200
    """Of scene C where their number is not the question."""
    counts: tuple[int, ...] = (10, 100, 1_000, 10_000, 100_000)
    """Of shapes where it is."""
    rounds_of_counts: int = 3
    seconds_of_counts: float = 40.0
    """After which no further round of a number of shapes is begun, nor a picture of a round but the first."""
    whole_limit: float = 5.0
    """Seconds beyond which no picture by the whole program is worth waiting for."""
    sides: tuple[int, ...] = (256, 512, 1024, 2048, 4096)
    """Of square pictures, in pixels."""


FULL = Plan()
QUICK = Plan(rounds=1, size=(64, 48), balls=20, counts=(10, 60), rounds_of_counts=1, sides=(32, 64))


@dataclass(frozen=True)
class Case(Generic[Made]):
    """What is timed, mostly a picture, and what is kept beside its times."""

    key: str
    run: Callable[[], Made]
    facts: Row = field(default_factory=dict)


def say(text: str) -> None:
    """Show how far the run is."""
    print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def timed(cases: list[Case[Made]], plan: Plan, title: str, facts_of: Callable[[Made], Row]) -> list[Row]:
    """Time cases in turn, and return a row for each: its facts, those of its result, and milliseconds of all rounds."""
    say(f"{title}: warming up")
    times, results = measure(
        cases, plan.rounds, lambda done: say(f"{title}: round {done} of {plan.rounds}"), plan.seconds
    )
    return [
        {**case.facts, **facts_of(results[case.key]), "cpu": times[case.key].cpu, "wall": times[case.key].wall}
        for case in cases
    ]
