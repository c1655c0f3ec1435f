"""From times to rows: medians, spreads and ratios, as a table and as JSON. timing.py comes before it."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from contenders import Contender, Outcome
from scenes import Scene
from timing import Agreement, Times, compare, ratio

# What is wanted of the engine: speed against the scalar march by instruction set, its share of the hand-written block's
# speed, and the gain from a second thread.
WANTED_OVER_SCALAR = {"avx2": 10.0, "avx512": 13.0}
WANTED_OF_BLOCK = 0.9
WANTED_TWO_THREADS = 1.9


@dataclass(frozen=True)
class Row:
    """One contender in one scene. Ratios are medians over rounds; times are milliseconds."""

    scene: str
    isa: str
    key: str
    label: str
    median: float
    quartiles: tuple[float, float]
    fastest: float
    over_scalar: float
    over_scalar_cpu: float
    evaluations: float
    lane_use: float
    agreement: Agreement


def rows(scene: Scene, contenders: list[Contender], times: dict[str, Times], outcomes: dict[str, Outcome]) -> list[Row]:
    """Summarise a scene. The native scalar march has no fellow of its own flags: it is held against the first scalar.

    Evaluations are those that rays needed, which the scalar march counts; lane use is their share of what was computed.
    """
    found = []
    first = next(contender.isa for contender in contenders)
    for contender in contenders:
        key, isa = contender.key, contender.isa
        scalar = f"{first if isa == 'native' else isa}/scalar"
        wall, outcome = times[key].wall, outcomes[key]
        one_lane = key.endswith(("/scalar", "/skip"))
        evaluations = outcome.computed if one_lane else outcomes[scalar].computed
        low, median, high = np.percentile(wall, [25, 50, 75])
        found.append(
            Row(
                scene=scene.name,
                isa=isa,
                key=key,
                label=contender.label,
                median=float(median),
                quartiles=(float(low), float(high)),
                fastest=min(wall),
                over_scalar=ratio(times[scalar].wall, wall),
                over_scalar_cpu=ratio(times[scalar].cpu, times[key].cpu),
                evaluations=evaluations,
                lane_use=evaluations / outcome.computed,
                agreement=compare(outcome.depth, outcomes[scalar].depth),
            )
        )
    return found


@dataclass(frozen=True)
class Verdict:
    """The engine in one scene on one instruction set, beside what is wanted of it (None: nothing)."""

    scene: str
    isa: str
    over_scalar: float
    over_scalar_wanted: float | None
    of_block: float
    of_block_wanted: float
    two_threads: float
    two_threads_wanted: float
    two_threads_processors: float  # that the machine gave the two threads: less than 2 where other work took its share

    @property
    def fulfilled(self) -> bool:
        return (
            self.over_scalar >= (self.over_scalar_wanted or 0.0)
            and self.of_block >= self.of_block_wanted
            and self.two_threads >= self.two_threads_wanted
        )


def verdicts(scene: Scene, isas: list[str], times: dict[str, Times]) -> list[Verdict]:
    found = []
    for isa in isas:
        engine, two_threads = times[f"{isa}/engine1"].wall, times[f"{isa}/engine2"]
        found.append(
            Verdict(
                scene=scene.name,
                isa=isa,
                over_scalar=ratio(times[f"{isa}/scalar"].wall, engine),
                over_scalar_wanted=WANTED_OVER_SCALAR.get(isa),
                of_block=ratio(times[f"{isa}/block"].wall, engine),
                of_block_wanted=WANTED_OF_BLOCK,
                two_threads=ratio(engine, two_threads.wall),
                two_threads_wanted=WANTED_TWO_THREADS,
                two_threads_processors=ratio(two_threads.cpu, two_threads.wall),
            )
        )
    return found


def table(found: list[Row]) -> str:
    """Lay out rows for a terminal."""
    header = f"{'':4}{'':8}{'':32}{'median':>8}{'quartiles':>17}{'× scalar':>10}{'(CPU)':>8}{'evals':>8}{'lanes':>7}"
    lines = [header + f"{'hits ≠':>8}{'t ≠':>8}{'max |Δt|':>10}"]
    for row in found:
        agreement = row.agreement
        quartiles = f"{row.quartiles[0]:.2f}–{row.quartiles[1]:.2f}"
        lines.append(
            f"{row.scene:4}{row.isa:8}{row.label:32}{row.median:8.2f}{quartiles:>17}{row.over_scalar:10.2f}"
            f"{row.over_scalar_cpu:8.2f}{row.evaluations:8.2f}{row.lane_use:7.3f}"
            f"{agreement.different_hits:8}{agreement.different_depths:8}{agreement.largest_difference:10.1e}"
        )
    return "\n".join(lines)


def conclusion(found: list[Verdict]) -> str:
    """Say for every scene and instruction set how the engine does, and what was wanted."""
    lines = []
    for verdict in found:
        wanted = f" (wanted {verdict.over_scalar_wanted:.0f})" if verdict.over_scalar_wanted else ""
        lines.append(
            f"{verdict.scene} {verdict.isa:7} engine {verdict.over_scalar:5.2f} × scalar{wanted}, "
            f"{verdict.of_block:.2f} of the block by hand (wanted {verdict.of_block_wanted}), "
            f"two threads {verdict.two_threads:.2f} × one on {verdict.two_threads_processors:.2f} processors "
            f"(wanted {verdict.two_threads_wanted})"
            f"{'' if verdict.fulfilled else '  ← short'}"
        )
    return "\n".join(lines)


def as_json(
    machine: dict[str, Any], settings: dict[str, Any], found: list[Row], ends: list[Verdict], times: dict[str, Any]
) -> dict[str, Any]:
    """Return everything that is kept of a run, the single times included."""
    return {
        "machine": machine,
        "settings": settings,
        "rows": [asdict(row) for row in found],
        "verdicts": [asdict(verdict) | {"fulfilled": verdict.fulfilled} for verdict in ends],
        "milliseconds": times,
    }
