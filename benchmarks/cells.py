"""What long programs cost by cells of their octree: a first picture, which makes cells, those that follow, and queries.

``python benchmarks/cells.py`` prints the tables of docs/guide/marching.md and keeps the figures in benchmarks/results.
Times are of processor time on one thread, medians over shapes that differ a little in where they are, so that each is
new; ``clock`` is the first picture by the clock, on as many threads as there are processors.
"""

import argparse
import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import cells_tables
import machine
import octomarch as om
from spheres import DIRECTION, FOV, SMOOTH, VOLUME_PER_BALL, balls
from timing import Times

SIZE = (640, 480)
COUNTS = (200, 2000, 10_000, 100_000)
POINTS = 400_000
RAYS = 100_000
PICTURES = 8
SHAPES = 5
WHOLE = 4000
"""Instructions up to which the whole program is run too."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A shape that is made anew for each offset, and how it is looked at."""

    name: str
    build: Callable[[float], om.Shape]
    camera: om.Camera
    planes: tuple[str, ...] = ("depth",)
    lights: tuple[om.DirectionalLight, ...] = ()
    max_distance: float = 100.0

    def render(self, shape: om.Shape, *, prune: bool = True, threads: int | None = 1) -> om.Image:
        march = om.March(max_distance=self.max_distance, prune=prune)
        scene = om.Scene(shape, lights=self.lights)
        return om.render(scene, self.camera, SIZE, planes=self.planes, march=march, threads=threads)


def sparse(n: int) -> Case:
    """Scene C."""
    recipe = balls(n)
    camera = om.Camera(recipe.eye, (0, 0, 0), fov=FOV)

    def build(offset: float) -> om.Shape:
        return om.spheres(recipe.centers + np.float32(offset), recipe.radii, smooth=SMOOTH)

    return Case(f"scene C, {n:,} balls", build, camera, max_distance=recipe.max_distance)


def near(n: int) -> Case:
    """Look from as far from the nearest corner as at 200 balls: they are as large, and few gaps are left."""

    def to_corner(count: int) -> float:
        edge: float = (count * VOLUME_PER_BALL) ** (1 / 3)
        return edge / 2 * sum(DIRECTION)

    distance = to_corner(n) + math.hypot(*balls(200).eye) - to_corner(200)
    x, y, z = (distance * along for along in DIRECTION)
    case = sparse(n)
    return replace(case, name=f"nearer, {n:,} balls", camera=om.Camera((x, y, z), (0, 0, 0), fov=FOV))


def dense(n: int) -> Case:
    """Three balls a unit of volume, seen from nearer."""
    edge = (n / 3) ** (1 / 3)
    random = np.random.default_rng(n)
    centers = random.uniform(-edge / 2, edge / 2, (n, 3))
    radii = random.uniform(0.15, 0.35, n)
    eye = (0.72 * edge, 0.54 * edge, 1.2 * edge)

    def build(offset: float) -> om.Shape:
        return om.spheres(centers + offset, radii, smooth=SMOOTH)

    return Case(f"dense, {n:,} balls", build, om.Camera(eye, (0, 0, 0), fov=FOV), max_distance=max(100.0, 4 * edge))


def turned_copies(shape: om.Shape, n: int, name: str) -> Case:
    """Return a case like scene C, its balls being copies of a shape, turned anyhow."""
    recipe = balls(n)
    matrices = np.tile(np.eye(4), (n, 1, 1))
    matrices[:, :3, :3] = np.linalg.qr(np.random.default_rng(n).normal(size=(n, 3, 3))).Q

    def build(offset: float) -> om.Shape:
        matrices[:, :3, 3] = recipe.centers + np.float32(offset)
        return shape.instances(matrices)

    return replace(sparse(n), name=f"{n:,} {name}", build=build)


def pin() -> om.Shape:
    return om.cylinder(0.1, 1.0) | om.sphere(0.3, center=(0, 0.5, 0))


def chair() -> om.Shape:
    legs = (om.box((0.08, 0.5, 0.08), center=(x, -0.25, z)) for x in (-0.25, 0.25) for z in (-0.25, 0.25))
    return om.union(om.box((0.6, 0.08, 0.6)), om.box((0.6, 0.6, 0.08), center=(0, 0.3, 0.26)), *legs)


def sticks(n: int) -> Case:
    """Half of scene C's balls, and sticks for the others."""
    recipe = balls(n)
    to = recipe.centers + np.random.default_rng(n).normal(scale=0.4, size=(n, 3))
    half = n // 2

    def build(offset: float) -> om.Shape:
        centers, ends = recipe.centers + np.float32(offset), to + np.float32(offset)
        return om.spheres(centers[:half], recipe.radii[:half], smooth=SMOOTH) | om.capsules(
            centers[half:], ends[half:], np.full(half, 0.1)
        )

    return replace(sparse(n), name=f"{half:,} balls and as many sticks", build=build)


def odd_one(n: int) -> Case:
    case = sparse(n)
    return replace(case, name=f"{n:,} balls and a box", build=lambda offset: case.build(offset) | om.box(0.5))


SUN = (om.DirectionalLight((-1, -2, -1)),)
NEAR = om.Camera((4, 3, 5), (0, 0, 0))


def turned_boxes(offset: float) -> om.Shape:
    random = np.random.default_rng(1)
    angles, places = random.uniform(0, 180, 300), random.uniform(-2, 2, (300, 3)) + offset
    boxes = (om.box(0.2).rotate(angle, "y").translate(*place) for angle, place in zip(angles, places, strict=True))
    return om.union(*boxes) | om.plane(point=(0, -2, 0))


def stars(offset: float) -> om.Shape:
    """Ten stars of 50 edges carved into a drum, on a floor: from most places all are about as far."""
    around = np.arange(50) * (2 * np.pi / 50)
    radii = np.where(np.arange(50) % 2 == 0, 0.25, 0.15)
    star = om.polygon(np.stack([radii * np.cos(around), radii * np.sin(around)], axis=1)).extrude(0.3)
    carved = star.translate(offset, 0, 1.1)
    drum = om.cylinder(1.05, 0.8) - om.union(*(carved.rotate(36 * i, "y") for i in range(10)))
    return drum | om.plane(point=(0, -0.5, 0))


def cases(largest: int) -> list[Case]:
    counts = [n for n in COUNTS if n <= largest]
    return [
        *(sparse(n) for n in counts),
        *(near(n) for n in counts if n > 200),
        *(dense(n) for n in counts),
        odd_one(20_000),
        sticks(20_000),
        turned_copies(pin(), 20_000, "pins, turned"),
        turned_copies(chair(), 5000, "chairs, turned"),
        Case("300 turned boxes on a floor, shaded", turned_boxes, NEAR, ("color",), SUN),
        Case("10 stars carved into a drum, shaded", stars, NEAR, ("color",), SUN),
    ]


def measure(case: Case) -> Row:
    processor, clock, whole = [], Times(), Times()
    stats: list[Any] = []
    for k in range(SHAPES):
        shape = case.build(1e-3 * k)
        times = Times()
        stats = [times.add(partial(case.render, shape)).stats for _ in range(PICTURES)]
        processor.append(times.cpu)
        fresh = case.build(1e-3 * k + 5e-4)
        clock.add(partial(case.render, fresh, threads=None))
    median = np.median(processor, axis=0) / 1e3
    shape = case.build(0.0)
    instructions = om.compile(shape).instructions
    for _ in range(SHAPES if instructions <= WHOLE else 0):
        whole.add(partial(case.render, shape, prune=False))
    cells = [found["cells"] for found in stats]
    return {
        "case": case.name,
        "instructions": instructions,
        "first": float(median[0]),
        "next": float(median[1]),
        "last": float(median[-1]),
        "clock": float(np.median(clock.wall)) / 1e3,
        "whole": float(np.median(whole.cpu)) / 1e3 if whole.cpu else None,
        "evaluations": stats[-1]["evaluations"],
        "cells": [cells[0], sum(cells)],
        "bytes": [stats[0]["cell_bytes"], stats[-1]["cell_bytes"]],
    }


def queries(n: int) -> Row:
    """Ask for distances at points, scattered or on a lattice, and for hits of rays from them, within scene C's cube."""
    case = sparse(n)
    edge = (n * VOLUME_PER_BALL) ** (1 / 3)
    random = np.random.default_rng(n)
    scattered = random.uniform(-edge / 2, edge / 2, (POINTS, 3))
    along = np.linspace(-edge / 2, edge / 2, round(POINTS ** (1 / 3)))
    lattice = np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3)
    directions = random.normal(size=(RAYS, 3))
    asked: dict[str, Callable[[om.Shape], object]] = {
        "scattered": lambda shape: shape.distance(scattered, precision="float32", threads=1),
        "lattice": lambda shape: shape.distance(lattice, precision="float32", threads=1),
        "rays": lambda shape: shape.raycast(scattered[:RAYS], directions, precision="float32", threads=1),
    }
    row: Row = {"case": case.name}
    for name, ask in asked.items():
        processor = []
        for k in range(SHAPES):
            shape = case.build(1e-3 * k)
            om.compile(shape)
            times = Times()
            for _ in range(3):
                times.add(partial(ask, shape))
            processor.append(times.cpu)
        row[name] = (np.median(processor, axis=0)[[0, -1]] / 1e3).tolist()
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=int, default=100_000, metavar="N", help="balls at the most")
    parser.add_argument("--out", type=Path, metavar="FILE")
    chosen = parser.parse_args()
    description = machine.describe(None)
    machine.warn_when_busy(description)
    other = machine.OtherWork()
    rows = []
    for case in cases(chosen.largest):
        rows.append(measure(case))
        print(rows[-1], flush=True)
    asked = []
    for n in (n for n in COUNTS if n <= chosen.largest):
        asked.append(queries(n))
        print(asked[-1], flush=True)
    result = {"machine": description, "pictures": PICTURES, "rows": rows, "queries": asked}
    description["busy_processors"] = other.busy_processors()
    for name, table in cells_tables.blocks(result).items():
        print(f"{name}\n\n{table}\n")
    out = chosen.out or machine.result_file(description, "cells-")
    out.write_text(json.dumps(result, indent=1) + "\n")
    print(f"kept in {out}")


if __name__ == "__main__":
    main()
