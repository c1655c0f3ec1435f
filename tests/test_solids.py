"""Solids of which only inside and outside are known: fixed steps find them, counting neighbours finds their normals."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om

x, y, z = om.coordinates()
INSIDE = x * x + y * y + z * z <= 1
BALL = om.solid(INSIDE) & om.box(2.5)
CAMERA = om.Camera((2, 1.5, 3), (0, 0, 0))
SIZE = (40, 30)
MARCH = om.March(step=0.01, method="fixed")
COARSE = 12.5
"""Degrees that a normal may be off: 12.2 is the worst that a lattice of 256 points gives for 20,000 half-spaces."""
PLANES = ("depth", "position", "normal", "status", "object_id", "color")


def test_only_solids_are_solid():
    assert om.compile(BALL).is_solid
    assert om.compile(om.sphere(1.0) | om.solid(x <= 0).rotate(30)).is_solid
    assert not om.compile(om.sphere(1.0)).is_solid
    assert not om.compile(om.field(x - 1)).is_solid


def test_solids_are_found_where_their_condition_begins(isa: str, precision: str):
    """A distance field of the same ball is hit at the same depth, but for one halving of a step ten times."""
    options = {"planes": PLANES, "march": MARCH, "precision": precision, "isa": isa}
    solid = om.render(BALL, CAMERA, SIZE, **options)
    ball = om.render(om.sphere(1.0), CAMERA, SIZE, **{**options, "march": om.March(pixel_tolerance=0)})
    both = (solid.status == om.Status.HIT) & (ball.status == om.Status.HIT)
    assert both.sum() > 200
    assert (solid.status != ball.status).mean() < 0.02  # what is thinner than a step near the rim
    depth = solid.depth[both] - ball.depth[both]
    grazing = np.abs((ball.normal * (ball.position - CAMERA.eye)).sum(-1))[both] < 0.5
    assert np.abs(depth[~grazing]).max() < MARCH.step / 500
    off = np.degrees(np.arccos(np.clip((solid.normal * ball.normal).sum(-1)[both], -1, 1)))
    assert off.max() < COARSE
    assert np.median(off) < 4


def test_normals_of_a_half_space_are_across_it(isa: str, precision: str):
    floor = om.solid(y <= 0) & om.box((9, 9, 9), center=(0, -4, 0))
    hits = floor.raycast([0.1, 3, 0.2], [0, -1, 0], march=MARCH, precision=precision, isa=isa)
    assert_allclose(hits.normal, [0, 1, 0], atol=1e-6)
    assert_allclose(hits.t, 3, atol=MARCH.step / 1000)


def test_a_point_without_neighbours_inside_faces_the_ray(isa: str):
    """A grain smaller than the lattice of neighbours has no side: its normal is against the ray."""
    grain = om.solid(x * x + y * y + z * z <= 1e-8) & om.box(2.0)
    hits = grain.raycast([0, 0, 1.00001], [0, 0, -1], march=om.March("fixed", step=1e-4), isa=isa)
    assert hits.status == om.Status.HIT
    assert_array_equal(hits.normal, [0, 0, 1])


def test_solids_cost_their_neighbours_and_no_occlusion(isa: str):
    scene = om.Scene(BALL, lights=[om.DirectionalLight((-1, -2, -1))], ambient=0.5)
    image = om.render(scene, CAMERA, SIZE, planes=PLANES, march=MARCH, isa=isa)
    hits = (image.status == om.Status.HIT).sum()
    assert image.stats["stages"]["normals"]["evaluations"] == 256 * hits
    assert image.stats["stages"]["occlusion"]["evaluations"] == 0


def test_shadows_of_solids_are_hard(isa: str):
    above = om.OrthographicCamera((0, 6, 0), (0, 0, 0), up=(0, 0, -1), height=3)
    floor = om.box((4, 1, 4), center=(0, -0.5, 0))
    block = om.solid((om.absolute(x) <= 0.5) & (om.absolute(z) <= 0.5) & (y <= 2) & (y >= 1)) & om.box(6)
    scene = om.Scene(
        (floor | block).paint(om.Material(1, specular=0)), lights=[om.DirectionalLight((1, -1, 0))], ambient=0
    )
    image = om.render(scene, above, (24, 24), planes=("color", "position"), march=MARCH, isa=isa)
    on_floor = np.abs(image.position[..., 1]) < 0.01
    px, pz = image.position[..., 0][on_floor], image.position[..., 2][on_floor]
    lit = image.color[..., 0][on_floor]
    depth = np.minimum(np.minimum(px - 0.5, 2.5 - px), 0.5 - np.abs(pz))  # within the shadow where > 0
    assert (depth > 0.05).sum() > 10
    assert_array_equal(lit[depth > 0.02], 0)
    assert_allclose(lit[depth < -0.02], np.sqrt(0.5), rtol=1e-5)


def test_solids_are_marched_by_fixed_steps_whatever_is_asked_for():
    program = om.compile(BALL)
    assert om.March().resolve(program, CAMERA.eye).method == "fixed"
    image = om.render(BALL, CAMERA, SIZE, planes="status")
    assert (image.status == om.Status.HIT).sum() > 200
    assert set(np.unique(image.status)) == {om.Status.HIT, om.Status.MISS}
    hits = BALL.raycast([0, 0, 3], [0, 0, -1])
    assert_allclose(hits.t, 2, atol=1e-5)


def test_solids_without_end_are_marched_a_while(isa: str):
    hits = om.solid(y <= 0).raycast([[0, 2, 0], [0, 2, 0]], [[0, -1, 0], [0, 1, 0]], isa=isa)
    assert_array_equal(hits.status, [om.Status.HIT, om.Status.MISS])


def test_solids_have_equal_bits_on_all_isas_and_threads(precision: str):
    scene = om.Scene(BALL.paint(om.Material(0.5, reflectivity=0.5)), lights=[om.PointLight((3, 3, 3), 9)])
    options = {"planes": PLANES, "march": MARCH, "precision": precision, "shading": om.Shading(bounces=1)}
    expected = om.render(scene, CAMERA, SIZE, isa="scalar", threads=1, **options)
    for isa in om.isas():
        found = om.render(scene, CAMERA, SIZE, isa=isa, threads=2, **options)
        for plane in PLANES:
            assert_array_equal(getattr(found, plane), getattr(expected, plane), f"{isa} {plane}")


@pytest.mark.parametrize("shadows", ["none", "soft"])
def test_pictures_of_solids_are_those_of_the_reference(shadows: str, precision: str):
    """Both march alike; rounding sends few samples to the other side of the surface, each worth a neighbour's turn."""
    scene = om.Scene(BALL, lights=[om.DirectionalLight((-1, -2, -1))], ambient=0.25)
    options = {"march": om.March("fixed", step=0.05), "shading": om.Shading(shadows=shadows)}
    planes = ("color", "depth", "status")
    truth = om.reference.render(scene, CAMERA, SIZE, planes=planes, **options)
    image = om.render(scene, CAMERA, SIZE, planes=planes, precision=precision, **options)
    assert (image.status != truth.status).mean() < 0.01
    same = (image.status == om.Status.HIT) & (truth.status == om.Status.HIT)
    assert np.quantile(np.abs(image.depth[same] - truth.depth[same]), 0.98) < 0.05 / 1000
    error = np.abs(image.color - truth.color).max(-1)[same]
    assert np.median(error) < 1e-5
    assert (error > 0.02).mean() < 0.03
