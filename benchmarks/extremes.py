"""Errors in extreme cases: far from the origin, from far away, grazing rays, fields that are lower bounds, differences.

``python benchmarks/extremes.py`` prints the tables of docs/guide/numerics.md and keeps the figures in
benchmarks/results/extremes.json. All are counts and errors, so they are the same on every machine.
"""

import argparse
import json
import math
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import extreme_tables
import octomarch as om

ROOT = Path(__file__).resolve().parents[1]
PRECISIONS: tuple[Literal["float32", "float64"], ...] = ("float32", "float64")
SIZE = (160, 120)
TRUTH = om.March("plain", max_steps=100_000, epsilon=1e-12, pixel_tolerance=0, max_distance=20)

Array = NDArray[np.float64]
Row = dict[str, Any]

BALL, CUBE = om.sphere(1.0), om.box(1.5, center=(0.9, 0.3, 0))
BLEND = BALL.union(CUBE, smooth=0.25) - om.cylinder(0.25, 4).rotate(40, "z")


def degrees_between(a: Array, b: Array) -> Array:
    """Return angles between unit vectors, by the half chord, which keeps small ones."""
    chord = np.linalg.norm(a.astype(np.float64) - b, axis=-1)
    angles: Array = np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1)))
    return angles


def far_from_the_origin() -> list[Row]:
    """Measure a scene and its camera at offsets that no binary grid holds, against the truth at 0."""
    planes = ("depth", "normal", "status")
    eye, towards = np.array([3.1, 2.3, 4.1]), np.array([0.3, 1, -0.7]) / math.sqrt(1.58)
    truth = om.render(BLEND, om.Camera(eye, (0, 0, 0)), SIZE, march=TRUTH, planes=planes, precision="float64")
    rows = []
    for precision in PRECISIONS:
        for distance in (0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8):
            at = distance * towards
            camera = om.Camera(eye + at, at)
            image = om.render(BLEND.translate(*at), camera, SIZE, planes=planes, precision=precision)
            wanted, hit = (picture.status == om.Status.HIT for picture in (truth, image))
            both = wanted & hit
            depth = np.abs(image.depth[both] - truth.depth[both])
            angle = degrees_between(image.normal[both], truth.normal[both])
            rows.append(
                {
                    "precision": precision,
                    "offset": distance,
                    "hits": int(wanted.sum()),
                    "lost": int((wanted & (image.status == om.Status.MISS)).sum()),
                    "depth_p50": float(np.median(depth)),
                    "depth_p99": float(np.quantile(depth, 0.99)),
                    "degrees_p95": float(np.quantile(angle, 0.95)),
                }
            )
    return rows


def from_far_away() -> list[Row]:
    """Measure a ball that fills the picture, seen from farther and farther away, alone and on a floor without end."""
    towards = np.array([2, 3, 6]) / 7
    across = np.hypot(*np.meshgrid(*[((np.arange(120) + 0.5) / 120 * 2 - 1) * 1.1] * 2))
    shapes = {"alone": BALL, "on a floor": BALL | om.plane(point=(0, -1, 0))}
    rows = []
    for precision, name in [*((precision, "alone") for precision in PRECISIONS), (PRECISIONS[0], "on a floor")]:
        for distance in (10.0, 1e2, 1e4, 1e6, 1e8):
            angle = math.degrees(2 * math.atan2(1.1, distance))
            camera = om.Camera(distance * towards, (0, 0, 0), fov=angle)
            planes = ("status", "position")
            image = om.render(shapes[name], camera, (120, 120), planes=planes, precision=precision)
            wanted = across < 0.99  # from 10 the outline is a little smaller than the ball
            hit = wanted & (image.status == om.Status.HIT)
            off = np.abs(np.linalg.norm(image.position[hit].astype(np.float64), axis=-1) - 1)
            rows.append(
                {
                    "precision": precision,
                    "ball": name,
                    "distance": distance,
                    "missed": int((wanted & ~hit).sum()),
                    "off_p50": float(np.median(off)),
                    "off_p95": float(np.quantile(off, 0.95)),
                    "off_most": float(off.max()),
                    "depth_unit": float(np.spacing(np.array(distance, precision))),
                }
            )
    return rows


def grazing() -> list[Row]:
    """Measure rays that meet a plane at small angles from a unit above it."""
    rows = []
    for angle in (10.0, 1.0, 0.1):
        sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
        row: Row = {"degrees": angle, "formula": math.log(1e4) / -math.log1p(-sine)}
        for method in ("plain", "auto"):
            march = om.March(method, epsilon=1e-4, max_steps=100_000, max_distance=1e4)
            row[method] = int(om.plane().raycast([0, 1, 0], [cosine, -sine, 0], march=march).steps)
        few = om.March("plain", epsilon=1e-4, max_distance=1e4)
        hit = om.plane().raycast([0, 1, 0], [cosine, -sine, 0], march=few)
        row |= {"status": om.Status(int(hit.status)).name, "height": float(1 - hit.t * sine)}
        rows.append(row)
    return rows


def nearest(points: Array, surface: Array) -> Array:
    """Return distances of points to the nearest of many surface points."""
    least = np.full(len(points), np.inf)
    for part in np.array_split(surface, 200):
        gaps = np.linalg.norm(points[:, None] - part, axis=-1)
        least = np.minimum(least, gaps.min(axis=1))
    return least


def on_sphere(count: int) -> Array:
    """Return points spread evenly over the unit sphere."""
    k = np.arange(count) + 0.5
    height, turn = 1 - 2 * k / count, math.pi * (1 + math.sqrt(5)) * k
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)


def on_cube(count: int) -> Array:
    """Return points on the faces of CUBE."""
    side = np.linspace(-0.75, 0.75, math.isqrt(count // 6))
    u, v = (grid.ravel() for grid in np.meshgrid(side, side))
    faces = [np.insert(np.stack([u, v], 1), axis, end, axis=1) for axis in range(3) for end in (-0.75, 0.75)]
    points: Array = np.concatenate(faces) + np.array([0.9, 0.3, 0])
    return points


def lower_bounds() -> list[Row]:
    """Measure how much of the true distance fields say that are bounds of it, at points up to 2 from the surface."""
    sphere, cube = on_sphere(100_000), on_cube(100_000)
    in_ball, in_cube = BALL.distance(cube) <= 0, CUBE.distance(sphere) <= 0
    cases: dict[str, tuple[om.Shape, Array]] = {
        f"stretched by {ratio:g}, 1, 1": (BALL.stretch((ratio, 1, 1)), sphere * [ratio, 1, 1])
        for ratio in (2.0, 10.0, 20.0)
    }
    cases["a ball less a cube"] = (BALL - CUBE, np.concatenate([sphere[~in_cube], cube[in_ball]]))
    cases["a ball within a cube"] = (BALL & CUBE, np.concatenate([sphere[in_cube], cube[in_ball]]))
    rng = np.random.default_rng(4)
    rows = []
    for name, (shape, surface) in cases.items():
        near = surface[rng.choice(len(surface), 600)] + rng.uniform(-2, 2, size=(600, 3))
        tip = surface[surface[:, 0].argmax()] + np.array([1, 0, 0]) * np.linspace(0.1, 2, 20)[:, None]
        points = np.concatenate([near, tip])
        field = shape.distance(points)
        outside = field > 0.05
        share = field[outside] / nearest(points[outside], surface)
        least, most = float(share.min()), float(share.max())
        rows.append({"shape": name, "least": least, "p50": float(np.median(share)), "most": most})
    return rows


def differences() -> list[Row]:
    """Measure normals of a ball by differences over steps in parts of its size, and exact ones."""
    camera = om.Camera((1, 2, 3), (0, 0, 0))
    rows = []
    for precision in PRECISIONS:
        for normals in ("exact", "central", "tetrahedron"):
            for step in (1e-2, 3e-3, 1e-3, 1e-4, 1e-5) if normals != "exact" else (None,):
                shading = om.Shading(normals=normals, normal_step=step)
                planes = ("normal", "position", "status")
                image = om.render(BALL, camera, SIZE, shading=shading, planes=planes, precision=precision)
                hit = image.status == om.Status.HIT
                true = image.position[hit].astype(np.float64)
                angle = degrees_between(image.normal[hit], true / np.linalg.norm(true, axis=1)[:, None])
                rows.append(
                    {
                        "precision": precision,
                        "normals": normals,
                        "step": step,
                        "degrees_p95": float(np.quantile(angle, 0.95)),
                    }
                )
    return rows


def folds() -> Row:
    """Measure what the order of blends changes, and what a repeat would overestimate that looked at one cell only."""
    rng = np.random.default_rng(2)
    points = rng.normal(size=(20_000, 3))
    third = om.sphere(0.8, center=(0.3, 1, 0))
    one_way, other_way = (om.union(*shapes, smooth=0.3) for shapes in ((BALL, CUBE, third), (third, CUBE, BALL)))
    order = one_way.distance(points) - other_way.distance(points)
    content = om.sphere(0.2, center=(0.25, 0.1, -0.2)) | om.box((0.1, 0.3, 0.1), center=(-0.2, -0.2, 0.25))
    points = rng.uniform(-0.5, 0.5, size=(5_000, 3))
    steps = range(-2, 3)
    copies = om.union(*[content.translate(i, j, k) for i in steps for j in steps for k in steps]).distance(points)
    one, ours = content.distance(points) - copies, content.repeat((1, 1, 1)).distance(points) - copies
    return {
        "order": float(np.abs(order).max()),
        "one_cell_share": float((one > 1e-9).mean()),
        "one_cell_most": float(one.max()),
        "ours_most": float(max(ours.max(), 0.0)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, metavar="FILE", default=ROOT / "benchmarks" / "results" / "extremes.json")
    out = parser.parse_args().out
    result = {
        "offsets": far_from_the_origin(),
        "distances": from_far_away(),
        "grazing": grazing(),
        "bounds": lower_bounds(),
        "differences": differences(),
        "folds": folds(),
    }
    for name, table in extreme_tables.blocks(result).items():
        print(f"{name}\n\n{table}\n")
    out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
