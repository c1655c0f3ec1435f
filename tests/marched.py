"""Scenes that every method of marching has to do with, and pictures of them."""

from __future__ import annotations

import functools

import numpy as np

import octomarch as om

SIZE = 96, 72
FAR = 100.0
METHODS = ["auto", "plain", "relaxed", "enhanced"]
LONGER = ["auto", "relaxed", "enhanced"]


def blend() -> om.Shape:
    """Return scene A of the benchmarks."""
    ball, cube = om.sphere(1.0), om.box(1.5).translate(0.9, 0.3, 0.0)
    return ball.union(cube, smooth=0.25) | om.plane(point=(0, -1, 0))


def building() -> om.Shape:
    """Return scene B of the benchmarks."""
    windows = om.box((0.6, 0.8, 0.6)).repeat((1, 1.5, 1))
    return om.box((4, 12, 4)) - windows - om.cylinder(1.2, axis="y") | om.plane(point=(0, -6, 0))


def balls() -> om.Shape:
    """Return balls, so many that rays look for the first."""
    rng = np.random.default_rng(7)
    return om.union(*(om.sphere(0.3, center=rng.uniform(-2, 2, 3)) for _ in range(100)), smooth=0.05)


def crowd() -> om.Shape:
    """Return so many shapes that the octree runs them, one of them nothing that rays look for."""
    return balls() | om.octahedron(0.2)


def twisted() -> om.Shape:
    """Return a field that is far steeper in one place than in others."""
    return om.box((1, 3, 1)).twist(40, axis="y") | om.torus(2, 0.1, axis="y")


SCENES: dict[str, tuple[om.Shape, om.Camera]] = {
    "blend": (blend(), om.Camera((3, 2, 4), (0, 0, 0))),
    "building": (building(), om.Camera((9, 4, 12), (0, 0, 0))),
    "crowd": (crowd(), om.Camera((3, 2, 6), (0, 0, 0))),
    "balls": (balls(), om.Camera((3, 2, 6), (0, 0, 0))),
    "twisted": (twisted(), om.Camera((3, 2, 4), (0, 0, 0))),
}

CAMERAS = {
    "perspective": om.Camera((3, 2, 4), (0, 0, 0)),
    "wide": om.Camera((0.5, 1.5, 2), (0, 0, 0), fov=150),
    "orthographic": om.OrthographicCamera((3, 2, 4), (0, 0, 0), height=5),
    "panoramic": om.PanoramicCamera((2, 2, 2), (0, 0, 0)),
    "inside": om.Camera((0.1, 0.2, 0.3), (3, 0, 0)),
}


@functools.cache
def picture(name: str, precision: str = "float32", **settings) -> om.Image:
    shape, camera = SCENES[name]
    march = om.March(**({"max_distance": FAR} | settings))
    return om.render(shape, camera, SIZE, march=march, precision=precision, planes=("depth", "status", "steps"))
