"""Solids without distances in the reference: normals by counting, and what light does on them."""

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]

X, Y, Z = om.coordinates()
INSIDE = X * X + 2 * Y * Y + Z * Z <= 1
EGG = om.solid(INSIDE)
FLOOR = om.solid(Y <= -1)
STEPS = om.March("fixed", step=0.02, max_distance=12)
CAMERA = om.Camera((2, 1.5, 3), (0, -0.3, 0))
WHITE = om.Material(color=1, specular=0, roughness=1)


COARSE = 12.5
"""Degrees that a normal may be off: 12.2 is the worst that a lattice of 256 points gives for 20,000 half-spaces."""


def counted(p: Array, h: float) -> Array:
    """Minus the sum of the offsets to the lattice points of a ball that lie inside EGG, of unit length."""
    total = np.zeros(p.shape)
    for cell in itertools.product(range(-4, 5), repeat=3):
        if 0 < np.dot(cell, cell) <= 16:
            offset = np.array(cell) / 4
            q = p + h * offset
            total -= offset * (q[:, :1] ** 2 + 2 * q[:, 1:2] ** 2 + q[:, 2:] ** 2 <= 1)
    return total / np.linalg.norm(total, axis=1, keepdims=True)


@pytest.mark.parametrize("normals", ["exact", "central"])
def test_normals_of_a_picture_count_what_is_inside(normals: str):
    image = om.reference.render(
        EGG, CAMERA, (24, 18), STEPS, om.Shading(normals, normal_step=0.05), planes=("position", "normal", "status")
    )
    hit = image.status == om.Status.HIT
    assert hit.sum() > 50
    p, n = image.position[hit], image.normal[hit]
    assert_allclose(n, counted(p, 0.05), rtol=0, atol=1e-12)
    gradient = p * [1, 2, 1] / np.linalg.norm(p * [1, 2, 1], axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", n, gradient) > np.cos(np.radians(COARSE))).all()


def test_normals_of_rays_are_those_of_a_thousandth_of_the_size():
    shape = EGG & om.box(30.0)  # whose diagonal is the size
    rays = [[0.3, 0.2, 3], [0, 4, 0]], [[0, 0, -1], [0, -1, 0]]
    truth = om.reference.raycast(shape, *rays, march=STEPS)
    assert_allclose(truth.normal, counted(truth.position, 0.03 * np.sqrt(3)), rtol=0, atol=1e-12)
    assert_allclose(shape.raycast(*rays, march=STEPS, precision="float64").normal, truth.normal, rtol=0, atol=1e-12)


def test_a_normal_of_nothing_leads_back_along_the_ray():
    speck = om.solid(om.maximum(abs(X), abs(Y), abs(Z)) <= 0.02)
    hits = om.reference.raycast(speck & om.box(100.0), [0, 0, 3], [0, 0, -1], march=STEPS)
    assert hits.status == om.Status.HIT
    assert_array_equal(hits.normal, [0, 0, 1])


def colors(shape: om.Shape, ambient: float = 0.0, **shading: object) -> tuple[Array, Array]:
    """Colours and positions of the floor around EGG, under light from straight above."""
    scene = om.Scene(shape.paint(WHITE), lights=[om.DirectionalLight((0, -1, 0))], ambient=ambient)
    image = om.reference.render(
        scene, om.Camera((0, 1.5, 4), (0, -1, 0)), (24, 18), STEPS, om.Shading(**shading), ("color", "position")
    )
    floor = image.position[..., 1] < -0.99
    assert floor.sum() > 50
    return image.color[floor], image.position[floor]


def test_shadows_are_hard_whatever_is_asked_for():
    color, position = colors(EGG | FLOOR, shadows="soft", shadow_k=2)
    r = np.hypot(position[:, 0], position[:, 2])
    assert_array_equal(color[r < 0.95], 0)  # what lies under the egg and is seen beside it
    assert_allclose(color[r > 1.05], 1, rtol=1e-12)
    assert 10 < (r < 0.95).sum() < (r > 1.05).sum()


def test_occlusion_needs_distances():
    color, _ = colors(EGG | FLOOR, ambient=1.0, shadows="none", occlusion=5, occlusion_distance=1.0)
    assert_allclose(color, 2, rtol=1e-12)


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_pictures_of_solids_are_those_of_the_reference(precision: str):
    scene = om.Scene(
        (EGG | FLOOR | om.sphere(0.4).translate(1, 0, 1)).paint(om.Material(0.6, reflectivity=0.3)),
        lights=[om.DirectionalLight((-1, -2, -1)), om.SpotLight((2, 3, 3), target=(0, 0, 0), color=9)],
    )
    options = {"march": STEPS, "shading": om.Shading(bounces=2), "planes": ("color", "normal", "status")}
    truth = om.reference.render(scene, CAMERA, (24, 18), dtype=precision, **options)
    found = om.render(scene, CAMERA, (24, 18), precision=precision, **options)
    same = (truth.status == found.status) & (np.abs(truth.normal - found.normal).max(axis=-1) < 1e-6)
    assert same.mean() > (0.9 if precision == "float32" else 0.99)  # a count may go either way at a last bit
    difference = np.abs(found.color - truth.color)[same].max(axis=-1)
    assert np.quantile(difference, 0.95) < (1e-4 if precision == "float32" else 1e-9)
