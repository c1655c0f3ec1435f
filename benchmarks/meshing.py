"""Time, memory and evaluations of meshes, against marching cubes over a dense grid.

``python benchmarks/meshing.py`` prints a table and keeps it in benchmarks/results/meshing-<date>-<processor>.json. Each
mesh is made in a process of its own, whose peak of resident memory above that before the mesh counts. *Dense* is what
the same lattice takes when the field is evaluated at all of its points, by the same engine and in float64, and libigl's
marching cubes runs over them; it ends there, its vertices are where straight lines put them. The peak of three runs,
medians of their times, one thread.
"""

import argparse
import json
import multiprocessing
import resource
import statistics
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import machine
import meshing_tables
import octomarch as om

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "examples" / "gallery"))
from _building import building  # noqa: E402  (the solid of the pictures, from where it is)

RESOLUTIONS = (64, 128, 256, 512)
DENSEST = 256
ROUNDS = 3


def blend() -> om.Shape:
    generator = np.random.default_rng(7)
    return om.spheres(generator.uniform(-1, 1, (200, 3)), generator.uniform(0.08, 0.16, 200), smooth=0.05)


SHAPES: dict[str, Callable[[], om.Shape]] = {
    "ball": lambda: om.sphere(1.0),
    "building": building,
    "200 blended balls": blend,
    "gyroid in a ball": lambda: om.gyroid(0.5, 0.05) & om.sphere(1.0),
}


def lattice(shape: om.Shape, resolution: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the points that a mesh of that resolution has values for at the most, and how many there are per axis."""
    lo, hi = shape.bounds()
    spacing = (hi - lo).max() / resolution
    counts = np.ceil((hi - lo) / spacing - 1e-6).astype(np.int64) + 4
    axes = [(lo + hi)[i] / 2 + spacing * (np.arange(counts[i]) - (counts[i] - 1) / 2) for i in range(3)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), counts


def near(shape: om.Shape, resolution: int) -> dict[str, int]:
    mesh = shape.mesh(resolution, colors=None, threads=1)
    counts = {key: mesh.metadata[key] for key in ("evaluations", "cell_evaluations")}
    return {"triangles": len(mesh.faces), **counts}


def dense(shape: om.Shape, resolution: int) -> dict[str, int]:
    import igl

    points, counts = lattice(shape, resolution)
    _, faces, _ = igl.marching_cubes(shape.distance(points, threads=1), points, *map(int, counts), 0.0)
    return {"triangles": len(faces), "evaluations": len(points), "cell_evaluations": len(points)}


def run(name: str, way: str, resolution: int) -> dict[str, float]:
    """Make one mesh and return what it took; the first one of a ball only loads libraries."""
    shape = SHAPES[name]()
    make = {"near": near, "dense": dense}[way]
    make(om.sphere(1.0), 8)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    wall, cpu = time.perf_counter(), time.process_time()
    counts = make(shape, resolution)
    return {
        "seconds": time.perf_counter() - wall,
        "cpu_seconds": time.process_time() - cpu,
        "megabytes": (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024,
        **counts,
    }


def measure(name: str, way: str, resolution: int) -> dict[str, Any]:
    context = multiprocessing.get_context("spawn")
    found = []
    for _ in range(ROUNDS):
        with ProcessPoolExecutor(1, mp_context=context) as process:
            found.append(process.submit(run, name, way, resolution).result())
    medians = {key: statistics.median(row[key] for row in found) for key in ("seconds", "cpu_seconds")}
    peak = max(row["megabytes"] for row in found)
    return {"shape": name, "way": way, "resolution": resolution, **found[0], **medians, "megabytes": peak}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, metavar="FILE", help="default: a new file in benchmarks/results")
    out = parser.parse_args().out
    description = machine.describe(None)
    machine.warn_when_busy(description)
    rows = []
    for name in SHAPES:
        for resolution in RESOLUTIONS:
            ways = ("near", "dense") if resolution <= DENSEST else ("near",)
            rows += [measure(name, way, resolution) for way in ways]
            print(f"{name}, {resolution}", file=sys.stderr)
    path = out or machine.result_file(description, "meshing-")
    path.write_text(json.dumps({"machine": description, "rows": rows}, indent=1) + "\n", encoding="utf-8")
    print(f"{meshing_tables.table(rows)}\n\n{path}")


if __name__ == "__main__":
    main()
