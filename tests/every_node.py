"""A shot that is made of every kind of node, light and setting, for tests that must not miss one."""

from __future__ import annotations

import functools
import itertools

import numpy as np

import octomarch as om


def shapes() -> list[om.Shape]:
    """Return shapes that together hold every kind of node of a shape."""
    x, y, z = om.coordinates()
    wave = 0.05 * om.sin(4 * x) * om.cos(4 * y)
    ball, cube = om.sphere(0.8), om.box((0.5, 0.7, 0.9))
    flat = om.rectangle((0.4, 0.6)) | om.polygon([(0.5, 0), (0.9, 0.1), (0.6, 0.7)])
    return [
        ball.union(cube, smooth=0.1) & ~om.box(0.2, form="exterior") - om.box(0.1, form="maximum"),
        om.metaballs(ball, om.torus(0.7, 0.1, axis="z"), om.cylinder(0.2, 0.9, axis=(1, 2, 3)), k=0.05),
        om.plane((0, 1, 0.1), (0, -1, 0)) & om.cylinder(0.1, axis="x") & om.capsule((0, 0, 0), (0.3, 0.1, 0), 0.07),
        om.capped_cone(0.4, 0.2, 0.6, axis="y") | om.octahedron(0.4) | om.pyramid(0.3, 0.6),
        om.grid(grid_values() - 0.2, ((-0.6, -0.7, -0.8), (0.7, 0.6, 0.5))),
        om.grid(grid_values() - 0.3, ((-0.6, -0.5, -0.8), (0.7, 0.6, 0.5)), "cubic"),
        om.field(om.sqrt(x * x + y * y + z * z) - 0.3, lipschitz=1),
        om.field(om.length(x, y) - 0.3, lipschitz=1, bounds=((-1, -1, -0.5), (1, 1, 0.5))),
        om.solid((abs(x) < 0.2) & (y <= 0.3) & ~(z < -0.2)) & om.sphere(0.5),
        ball.displace(wave, lipschitz=0.4).round(0.05).shell(0.02),
        flat.extrude(0.3) | flat.revolve(0.5),
        cube.translate(0.1, 0.2, 0.3).rotate(33, axis=(1, 1, 0)).scale(1.3).stretch((1, 1.5, 0.7)),
        cube.repeat((2, 0, 3), counts=(3, None, None)).mirror("x").elongate((0.1, 0, 0.2)),
        cube.twist(30, axis="y") | cube.bend(20),
    ]


def grid_values() -> np.ndarray:
    """Return samples that are no distances."""
    i, j, k = np.meshgrid(np.arange(5), np.arange(6), np.arange(7), indexing="ij")
    return np.hypot(i - 2, j - 2.5) / 5 + np.cos(k) / 8


def materials() -> list[om.Material]:
    """Return materials that together hold every kind of expression."""
    x, y, z = om.coordinates()
    nx, ny, nz = om.normals()
    picture = np.linspace(0, 1, 24, dtype=np.float32).reshape(2, 4, 3) ** 2
    numbers = [
        om.floor(x) + om.exp(-abs(y)) - om.log(1 + z * z) / 3,
        om.tan(x / 4) * om.asin(om.clamp(y, -1, 1)) + om.acos(om.clamp(z, -1, 1)) * om.atan(x),
        om.minimum(om.atan2(y, x), om.maximum(om.mod(z, 0.3), om.power(abs(x), 0.7))),
        om.where(x <= y, om.noise(3 * x, 3 * y, 3 * z, seed=7), -z),
        om.where(x < y, nx, ny * nz) ** 3,
    ]
    colors = [om.Texture(a, b, 0.25) for a, b in itertools.pairwise(numbers)]
    pictures = [om.image_texture(picture), om.image_texture(picture, mapping="spherical"), om.checker(0.1, 0.9)]
    return [
        om.Material((0.8, 0.1, 0.1), roughness=0.3, specular=0.5, metallic=1.0, reflectivity=0.25),
        *(om.Material(color, roughness=om.clamp(x, 0.1, 0.9)) for color in colors + pictures),
    ]


@functools.cache
def everything() -> om.Shot:
    """Return the shot: shapes in a row, each of a material of its own."""
    painted = (shape.translate(3 * i, 0, 0) for i, shape in enumerate(shapes()))
    paints = [materials()[i % len(materials())] for i in range(len(shapes()))]
    lights = [
        om.DirectionalLight((-1, -2, -1.5), (1, 0.9, 0.8)),
        om.PointLight((2, 5, 2), 30, decay=1),
        om.SpotLight((0, 4, 1), direction=(0.1, -1, 0), color=20, angle=50, softness=0.3),
    ]
    scene = om.Scene(
        om.union(*(shape.paint(paint) for shape, paint in zip(painted, paints, strict=True))),
        sky=om.GradientSky([(-5, 0.05), (0, (0.9, 0.4, 0.1)), (90, (0.02, 0.02, 0.1))], axis=(0.1, 1, 0)),
        ambient=(0.1, 0.2, 0.3),
        lights=lights,
    )
    return om.Shot(
        scene,
        om.Camera((12, 9, 30), (17, 0, 0), (0.1, 1, 0), fov=50),
        (64, 36),
        march=om.March(max_steps=200, epsilon=1e-4, max_distance=100),
        shading=om.Shading(normals="central", shadows="hard", occlusion=3, bounces=1),
        planes=("color", "depth", "material_id"),
        precision="float64",
        samples=2,
        crop=(3, 2, 40, 30),
    )
