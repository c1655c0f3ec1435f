"""What large scenes cost before the first ray: built from arrays and one by one, compiled, saved and loaded.

``python benchmarks/building.py`` prints a table and keeps it in benchmarks/results/building.json. Times are medians of
processor time over the rounds, in which all stages run in turn. tables.py puts the table into the guide.
"""

import argparse
import gc
import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

import hand_tables
import machine
import octomarch as om
from spheres import SMOOTH, balls

RESULTS = Path(__file__).resolve().parent / "results"
COUNTS = (10, 100, 1_000, 10_000, 100_000)
PART = om.box((0.3, 0.5, 0.2)) - om.sphere(0.2)
TURN = 40.0
Result = TypeVar("Result")


@dataclass(frozen=True)
class Row:
    """One kind of scene at one size. Times are milliseconds."""

    shapes: str
    n: int
    build: float
    """From arrays."""
    build_one_by_one: float
    compile: float
    """The distance program."""
    compile_ids: float
    """The program for object ids and materials, made when a picture first asks for them."""
    save: float
    load: float
    drop: float
    """Until nothing is left of shape and program."""
    nodes: int
    instructions: int
    megabytes: float
    """Of the scene file."""


class Clock:
    """Processor time of named stages, round after round."""

    def __init__(self) -> None:
        self.times: dict[str, list[float]] = {}

    def time(self, stage: str, work: Callable[[], Result]) -> Result:
        before = time.process_time_ns()
        result = work()
        self.times.setdefault(stage, []).append((time.process_time_ns() - before) / 1e6)
        return result

    def medians(self) -> dict[str, Any]:
        return {stage: float(np.median(times)) for stage, times in self.times.items()}


def spheres(n: int) -> tuple[Callable[[], om.Shape], Callable[[], om.Shape]]:
    """Return scene C from arrays, and the same one by one."""
    recipe = balls(n)
    pairs = list(zip(recipe.radii.tolist(), map(tuple, recipe.centers.tolist()), strict=True))
    return (
        lambda: om.spheres(recipe.centers, recipe.radii, smooth=SMOOTH),
        lambda: om.union(*(om.sphere(radius, center) for radius, center in pairs), smooth=SMOOTH),
    )


def copies(n: int) -> tuple[Callable[[], om.Shape], Callable[[], om.Shape]]:
    """Return n scaled and turned copies of a shape, placed by matrices, and much the same by methods."""
    recipe = balls(n)
    turn: NDArray[np.float64] = np.reshape(om.sphere(1.0).rotate(TURN, "x")._node.parameters, (3, 3))
    matrices = np.empty((n, 3, 4))
    matrices[:, :, :3] = turn * 4.0 * recipe.radii[:, None, None]
    matrices[:, :, 3] = recipe.centers
    places = list(zip((4.0 * recipe.radii).tolist(), map(tuple, recipe.centers.tolist()), strict=True))
    return (
        lambda: PART.instances(matrices),
        lambda: om.union(*(PART.scale(size).rotate(TURN, "x").translate(center) for size, center in places)),
    )


SHAPES = {"spheres": spheres, "copies": copies}


def one_round(
    from_arrays: Callable[[], om.Shape], one_by_one: Callable[[], om.Shape], path: Path, clock: Clock
) -> dict[str, int]:
    """Time every stage once, and return what does not change from round to round."""
    gc.collect()
    clock.time("build_one_by_one", one_by_one)
    held = [clock.time("build", from_arrays)]  # which holds its program, once that is compiled
    clock.time("compile", lambda: om.compile(held[0]))
    clock.time("compile_ids", lambda: om.compile(held[0]).attribute_instructions)
    clock.time("save", lambda: om.Scene(held[0]).save(path))
    facts = {"nodes": held[0]._node.node_count, "instructions": om.compile(held[0]).instructions}
    clock.time("drop", held.clear)
    clock.time("load", lambda: om.load(path))
    return facts


def measure(name: str, n: int, rounds: int, folder: Path) -> Row:
    """Return the medians over `rounds`, after a round that only warms up."""
    builders, path, clock = SHAPES[name](n), folder / "scene.json", Clock()
    facts = one_round(*builders, path, Clock())
    for _ in range(rounds):
        one_round(*builders, path, clock)
    return Row(shapes=name, n=n, **clock.medians(), **facts, megabytes=path.stat().st_size / 1e6)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, nargs="+", default=COUNTS, help="numbers of shapes")
    parser.add_argument("--repeat", type=int, default=7, metavar="N", help="rounds")
    parser.add_argument("--out", type=Path, metavar="FILE", default=RESULTS / "building.json")
    chosen = parser.parse_args()
    about: dict[str, Any] = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "commit": machine.commit(),
        "processor": machine.processor(),
        "octomarch": om.__version__,
        "numpy": np.__version__,
    }
    other_work = machine.OtherWork()
    with tempfile.TemporaryDirectory() as folder:
        rows = [asdict(measure(name, n, chosen.repeat, Path(folder))) for name in SHAPES for n in chosen.n]
    about["busy_processors_during"] = other_work.busy_processors()
    result = {"machine": about, "rounds": chosen.repeat, "rows": rows}
    print(hand_tables.building(result))
    chosen.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
