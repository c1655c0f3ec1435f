"""What a lookup in a grid costs beside closed forms: by points, and in a picture of a ball.

``python benchmarks/grid.py`` prints the tables of docs/guide/import.md and keeps the figures in benchmarks/results.
Times are of processor time on one thread, medians of rounds in which all take turns; a query's own cost, that of a
plane along an axis, is taken off.
"""

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

import grid_tables
import machine
import octomarch as om
import timing

COUNT = 400_000
ROUNDS = 11
SIZES = (32, 128)
KINDS: tuple[Literal["linear", "cubic"], ...] = ("linear", "cubic")
EDGE = 1.5
BOUNDS = ((-EDGE,) * 3, (EDGE,) * 3)
PICTURE = (640, 480)

Row = dict[str, Any]


@dataclass(frozen=True)
class Contender:
    """One of those that take turns."""

    key: str
    run: Callable[[], Any]


def sampled_ball(count: int, kind: Literal["linear", "cubic"]) -> om.Shape:
    x, y, z = np.meshgrid(*[np.linspace(-EDGE, EDGE, count)] * 3, indexing="ij")
    return om.grid(np.sqrt(x * x + y * y + z * z) - 1, BOUNDS, kind)


def _nothing(_done: int) -> None:
    """Show no progress."""


def lookups() -> list[Row]:
    """Measure distances at points in a row, as those of neighbouring rays are, and anywhere in the box."""
    grids = {f"{kind}, {count}³ samples": sampled_ball(count, kind) for kind in KINDS for count in SIZES}
    shapes = {"plane": om.plane(), "sphere": om.sphere(1.0), "box": om.box(2.0, center=(0.1, 0, 0)), **grids}
    anywhere = np.random.default_rng(1).uniform(-EDGE, EDGE, (COUNT, 3))
    side = round(COUNT ** (1 / 3))
    row = np.stack(np.meshgrid(*[np.linspace(-EDGE, EDGE, side)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    rows = []
    for isa in om.isas():
        for places, points in (("in a row", row), ("anywhere", anywhere)):
            contenders = [
                Contender(name, partial(shape.distance, points, isa=isa, threads=1)) for name, shape in shapes.items()
            ]
            times, _ = timing.measure(contenders, ROUNDS, _nothing)
            ns = {name: float(np.median(times[name].cpu)) * 1e6 / len(points) for name in shapes}
            rows += [
                {"shape": name, "isa": isa, "places": places, "ns": ns[name] - ns["plane"]}
                for name in shapes
                if name != "plane"
            ]
    return rows


def pictures() -> list[Row]:
    """Measure the depth of a ball, and how long its grid takes to be made."""
    built: dict[str, tuple[om.Shape, float]] = {"sphere": (om.sphere(1.0), 0.0)}
    for kind in KINDS:
        for count in (*SIZES, 256):
            before = time.process_time()
            shape = sampled_ball(count, kind)
            built[f"{kind}, {count}³ samples"] = shape, (time.process_time() - before) * 1e3
    camera = om.Camera((2, 1.5, 3.5), (0, 0, 0), fov=40)
    contenders = [
        Contender(name, partial(om.render, shape, camera, PICTURE, planes=("depth",), threads=1))
        for name, (shape, _) in built.items()
    ]
    times, images = timing.measure(contenders, ROUNDS, _nothing)
    return [
        {
            "shape": name,
            "slope": om.compile(shape).lipschitz,
            "evaluations": images[name].stats["evaluations"] / (PICTURE[0] * PICTURE[1]),
            "ms": float(np.median(times[name].cpu)),
            "build_ms": build,
        }
        for name, (shape, build) in built.items()
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, metavar="FILE")
    chosen = parser.parse_args()
    description = machine.describe(None)
    machine.warn_when_busy(description)
    other = machine.OtherWork()
    result = {"machine": description, "points": COUNT, "lookups": lookups(), "pictures": pictures()}
    description["busy_processors"] = other.busy_processors()
    for name, table in grid_tables.blocks(result).items():
        print(f"{name}\n\n{table}\n")
    out = chosen.out or machine.result_file(description, "grid-")
    out.write_text(json.dumps(result, indent=1) + "\n")
    print(f"kept in {out}")


if __name__ == "__main__":
    main()
