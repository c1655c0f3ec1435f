"""Shapes of many parts, for tests of programs that are run in parts: all kinds of nodes, and crowds."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import every_node
import octomarch as om


def scattered(count: int, make: Callable[[int], om.Shape], seed: int = 5, spread: float = 2.0) -> list[om.Shape]:
    """Return shapes about the origin, each turned, scaled and moved in its own way."""
    rng = np.random.default_rng(seed)
    return [
        make(i)
        .rotate(float(rng.uniform(-180, 180)), axis=rng.normal(size=3))
        .scale(float(rng.uniform(0.2, 0.5)))
        .translate(*rng.uniform(-spread, spread, 3))
        for i in range(count)
    ]


def balls(count: int, seed: int = 7) -> list[om.Shape]:
    rng = np.random.default_rng(seed)
    return [om.sphere(0.3, center=rng.uniform(-2, 2, 3)).paint(om.Material(float(rng.random()))) for _ in range(count)]


def boxes(count: int) -> list[om.Shape]:
    return scattered(count, lambda i: om.box((1.0, 0.5 + i % 3, 0.7)))


def crowd(count: int = 3000, seed: int = 9) -> om.Shape:
    return om.spheres(np.random.default_rng(seed).uniform(-2, 2, (count, 3)), np.full(count, 0.05), smooth=0.02)


def mixed_crowd() -> om.Shape:
    """Return small shapes of four kinds, so many that rays go alone among them."""
    rng = np.random.default_rng(10)
    kinds = [om.sphere(0.04), om.box((0.07, 0.03, 0.05)), om.capsule((0, 0, 0), (0.06, 0.06, 0), 0.02)]
    turned = [om.cone(0.03, 0.1).rotate(float(rng.uniform(-180, 180)), axis="z") for _ in range(1500)]
    shapes = [kinds[i % 3] for i in range(3000)] + turned
    rng.shuffle(shapes)
    return om.union(*(shape.translate(*rng.uniform(-2, 2, 3)) for shape in shapes), smooth=0.02)


def pins() -> om.Shape:
    """Return copies of a shape that is made of several, turned."""
    pin = (om.cylinder(0.02, 0.2) | om.sphere(0.05, center=(0, 0.1, 0))) - om.box(0.03, center=(0, 0.12, 0.03))
    rng = np.random.default_rng(11)
    matrices = np.tile(np.eye(4), (1100, 1, 1))
    matrices[:, :3, :3] = np.linalg.qr(rng.normal(size=(1100, 3, 3))).Q
    matrices[:, :3, 3] = rng.uniform(-2, 2, (1100, 3))
    return pin.instances(matrices, smooth=0.01)


def crowd_and_more() -> om.Shape:
    """Return a crowd between shapes of which there is one each, cut by others."""
    x, y, z = om.coordinates()
    wavy = om.sphere(0.7).displace(0.05 * om.noise(4 * x, 4 * y, 4 * z, seed=3), lipschitz=0.6)
    turned = om.box((0.5, 1.5, 0.7)).rotate(30, axis=(1, 1, 0)).translate(-1, 0, 1)
    crowds = crowd(1500) | crowd(300, seed=12).scale(2.0)
    return om.union(turned, crowds, wavy, smooth=0.03) - om.box(2.0, center=(1.5, 1.5, 1.5)) - om.sphere(0.9)


def polygon(corners: int) -> om.Shape:
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    radii = 0.5 + 0.3 * (np.arange(corners) % 2)
    return om.polygon(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1))


def everything() -> om.Shape:
    """Return copies of all kinds of nodes but solids, over a floor."""
    kinds = [shape for shape in every_node.shapes() if not om.compile(shape).is_solid]
    painted = [shape.paint(paint) for shape, paint in zip(kinds, every_node.materials() * 2, strict=False)]
    return om.union(
        *scattered(3 * len(painted), lambda i: painted[i % len(painted)], spread=4), om.plane(point=(0, -2, 0))
    )


def deformed() -> om.Shape:
    crowd = om.union(*balls(25), *boxes(25))
    return crowd.twist(25, axis="y").translate(-4, 0, 0) | crowd.bend(12).translate(4, 0, 0)


def noisy() -> om.Shape:
    x, y, z = om.coordinates()
    bumps = 0.05 * om.noise(4 * x, 4 * y, 4 * z, seed=3)
    return om.union(*(shape.displace(bumps, lipschitz=0.6) for shape in balls(20) + boxes(10)), smooth=0.05)


def written() -> om.Shape:
    """Return fields of one's own: with choices by comparisons and constants, and parts that are no number."""
    x, y, z = om.coordinates()

    def one(i: int) -> om.Shape:
        ball = om.length(x - 0.1 * i, y, z) - 0.3
        kinds = [
            om.where((x < 0.02 * i) & (y > -1), ball, abs(ball) + 0.01),
            om.minimum(om.maximum(abs(x) - 0.4, abs(y) - 0.2), om.clamp(z, 0.1 * i, 3.0)),
            om.maximum(om.minimum(ball, 0.5), -0.1) + 0.05 * om.floor(2 * x) * 0,
            om.where((abs(y - 0.9) < 0.1) & (abs(x) + abs(z) < 0.2), om.sqrt(-1 - y * y), ball),
        ]
        return om.field(kinds[i % len(kinds)], lipschitz=1.5, bounds=((-1, -1, -1), (1, 1, 1)))

    return om.union(*scattered(32, one))


SCENES: dict[str, Callable[[], om.Shape]] = {
    "everything": everything,
    "unions": lambda: om.union(*balls(100), *boxes(30)),
    "intersections": lambda: om.union(*(box & box.translate(0.1, 0.2, 0.1) & ~box.scale(0.95) for box in boxes(40))),
    "differences": lambda: om.difference(om.box(3.5), *balls(60), *boxes(20)),
    "smooth unions": lambda: om.union(*balls(60), smooth=0.2),
    "smooth differences": lambda: om.difference(om.box(3.5), *balls(60), smooth=0.1),
    "smooth intersections": lambda: om.intersection(*(~ball for ball in balls(60)), om.box(3), smooth=0.15),
    "metaballs": lambda: om.metaballs(*balls(100), k=5e-4),
    "repeats": lambda: (
        om.union(*(shape.scale(0.4) for shape in balls(40) + boxes(20))).repeat((2.5, 0, 3.0), counts=(2, None, 2))
        | om.plane(point=(0, -1, 0))
    ),
    "deformed": deformed,
    "noise": noisy,
    "expressions": written,
    "polygons": lambda: om.union(
        *scattered(12, lambda i: polygon(10).extrude(0.4) if i % 2 else polygon(8).revolve(0.6))
    ),
    "rotated boxes": lambda: om.union(*boxes(60)),
    "blended boxes": lambda: om.union(*boxes(60), smooth=0.1),
    "shells": lambda: om.union(*(ball.shell(0.1) for ball in balls(60)), smooth=0.05),
    "capsules": lambda: om.capsules(*np.random.default_rng(8).uniform(-2, 2, (2, 80, 3)), np.full(80, 0.1), smooth=0.1),
    "a crowd": crowd,
    "a mixed crowd": mixed_crowd,
    "a crowd of pins": pins,
    "a crowd and more": crowd_and_more,
    "a room": lambda: om.union(om.box(8).shell(0.1), *balls(60)),
}
