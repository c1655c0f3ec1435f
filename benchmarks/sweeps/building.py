"""What large scenes cost before the first ray: built from arrays and one by one, compiled, saved, loaded, dropped."""

import gc
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import octomarch as om
from spheres import SMOOTH, balls
from sweeps.plan import Plan, Row, say
from timing import Times

PART = om.box((0.3, 0.5, 0.2)) - om.sphere(0.2)
TURN = 40.0

Builder = Callable[[], om.Shape]


def measure(plan: Plan) -> list[Row]:
    """Return a row for each kind of shapes, their number and the stage, with how much there is of them."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, builders in SHAPES.items():
            for n in plan.counts:
                rows += _scene(name, n, builders(n), plan, Path(folder))
    return rows


def _scene(name: str, n: int, builders: tuple[Builder, Builder], plan: Plan, folder: Path) -> list[Row]:
    """Time all stages in turn, round after round, after a round that only warms up."""
    path, times = folder / "scene.json", dict[str, Times]()
    facts = _round(*builders, path, {})
    for index in range(plan.rounds_of_counts):
        say(f"building {n:,} {name}: round {index + 1} of {plan.rounds_of_counts}")
        _round(*builders, path, times)
    facts |= {"shapes": name, "n": n, "megabytes": path.stat().st_size / 1e6}
    return [{**facts, "stage": stage, "cpu": found.cpu, "wall": found.wall} for stage, found in times.items()]


def _round(from_arrays: Builder, one_by_one: Builder, path: Path, times: dict[str, Times]) -> Row:
    """Time every stage once, and return what does not change from round to round."""

    def stage(name: str, work: Callable[[], object]) -> object:
        return times.setdefault(name, Times()).add(work)

    gc.collect()
    stage("build_one_by_one", one_by_one)
    held: list[om.Shape] = []  # a shape holds its program, once that is compiled
    stage("build", lambda: held.append(from_arrays()))
    stage("compile", lambda: om.compile(held[0]))
    stage("compile_ids", lambda: om.compile(held[0]).attribute_instructions)
    stage("save", lambda: om.Scene(held[0]).save(path))
    facts = {"nodes": held[0]._node.node_count, "instructions": om.compile(held[0]).instructions}
    stage("drop", held.clear)
    stage("load", lambda: om.load(path))
    return facts


def _spheres(n: int) -> tuple[Builder, Builder]:
    """Return scene C from arrays, and the same one by one."""
    recipe = balls(n)
    pairs = list(zip(recipe.radii.tolist(), map(tuple, recipe.centers.tolist()), strict=True))
    return (
        lambda: om.spheres(recipe.centers, recipe.radii, smooth=SMOOTH),
        lambda: om.union(*(om.sphere(radius, center) for radius, center in pairs), smooth=SMOOTH),
    )


def _copies(n: int) -> tuple[Builder, Builder]:
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


SHAPES = {"spheres": _spheres, "copies": _copies}
