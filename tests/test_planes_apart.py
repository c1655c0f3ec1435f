"""Planes that a shape is united with: the method auto meets them in closed form, and marches the rest in its bounds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om

PRECISIONS = ("float32", "float64")
FLOOR = om.plane(normal=(0, 1, 0), point=(0, -1, 0))
BALL = om.sphere(1.0)
ENHANCED = om.March(method="enhanced", max_distance=200.0)
AUTO = om.March(max_distance=200.0)
HIT, MISS, INSIDE = om.Status.HIT, om.Status.MISS, om.Status.INSIDE


def cast(shape: om.Shape, origin, direction, precision: str = "float64", **options) -> om.Hits:
    march = om.March(**{"max_distance": 200.0, **options})
    return shape.raycast(np.array([origin], float), np.array([direction], float), march=march, precision=precision)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_floor_is_met_where_it_is(precision: str, isa: str):
    for slope in (1.0, 1e-1, 1e-2, 1e-4):
        direction = np.array([math.sqrt(1 - slope * slope), -slope, 0.0])
        hits = (BALL | FLOOR).raycast(
            np.array([[0.0, 3.0, 9.0]]), direction[None], march=om.March(max_distance=1e6), precision=precision, isa=isa
        )
        assert hits.status[0] == HIT
        assert_allclose(hits.t[0], 4.0 / slope, rtol=1e-6 if precision == "float32" else 1e-12)
        assert hits.steps[0] == 0
        assert_allclose(hits.normal[0], [0, 1, 0], atol=1e-6)


def test_only_what_is_left_costs_evaluations(isa: str):
    camera = om.Camera((0, 2, 8), (0, 0, 0))
    image = om.render(BALL | FLOOR, camera, (64, 48), planes=("steps", "object_id"), march=AUTO, isa=isa)
    on_floor = image.object_id == 1
    assert on_floor.sum() > 500
    assert (image.steps[on_floor] == 0).mean() > 0.75
    assert (image.steps[image.object_id == 0] > 0).all()


@pytest.mark.parametrize(
    "shape",
    [
        BALL | FLOOR,
        FLOOR | BALL,
        om.union(om.box(1).translate(3, 0, 0), FLOOR, BALL),
        (FLOOR.paint(om.Material(0.3)) | BALL.paint(om.Material(0.7))) | om.box(1).translate(3, 0, 0),
        (om.plane() | BALL.translate(0, 1, 0)).translate(0, -1, 0),
        (om.plane() | BALL.translate(0, 0.5, 0)).scale(2).translate(0, -1, 0),
        (om.plane(normal=(1, 0, 0), point=(-1, 0, 0)) | BALL).rotate(90, axis="z"),
    ],
)
def test_planes_are_found_wherever_unions_hold_them(shape: om.Shape):
    assert cast(shape, (6, 5, 0), (1, -2, 0)).steps[0] == 0
    assert cast(shape, (6, 5, 0), (1, -2, 0)).t[0] == pytest.approx(6 * math.sqrt(5) / 2 / math.sqrt(5), rel=1e-12)


@pytest.mark.parametrize(
    "shape",
    [
        BALL.union(FLOOR, smooth=0.1),
        BALL & FLOOR,
        FLOOR - BALL,
        ~(BALL | FLOOR),
        (BALL | FLOOR).round(0.1),
        (BALL | FLOOR).repeat((4, 0, 0)),
        (BALL | FLOOR).mirror("x"),
    ],
)
def test_other_planes_stay_where_they_are(shape: om.Shape):
    origins = np.random.default_rng(1).uniform(-6, 6, (200, 3))
    directions = np.random.default_rng(2).normal(size=(200, 3))
    found = shape.raycast(origins, directions, march=AUTO)
    expected = shape.raycast(origins, directions, march=ENHANCED)
    assert_array_equal(found.status, expected.status)
    hit = found.status == HIT
    assert_allclose(found.t[hit], expected.t[hit], rtol=1e-4)


def test_rays_that_begin_in_a_plane_are_inside():
    shape = BALL | FLOOR
    for y in (-1.0, -1.5, -9.0):
        hits = cast(shape, (5, y, 0), (0, 1, 0))
        assert (hits.status[0], hits.t[0]) == (INSIDE, 0.0)
    assert cast(shape, (5, -0.5, 0), (0, 1, 0)).status[0] == MISS
    assert cast(shape, (5, -0.5, 0), (1, 0, 0)).status[0] == MISS
    below = cast(shape, (5, 3, 0), (0, -1, 0), min_distance=6.0)
    assert (below.status[0], below.t[0]) == (INSIDE, 6.0)


def test_what_is_nearer_hides_a_plane_and_a_plane_what_is_farther():
    shape = BALL.translate(0, 3, 0) | FLOOR | BALL.translate(0, -5, 0)
    above = cast(shape, (0, 9, 0), (0, -1, 0))
    assert above.t[0] == pytest.approx(5.0, abs=1e-6)
    beside = cast(shape, (2, 9, 0), (-0.0, -1, 0))
    assert beside.t[0] == pytest.approx(10.0, abs=1e-6)
    assert beside.object_id[0] == 1


def test_planes_beyond_the_end_are_missed():
    shape = BALL | FLOOR
    assert cast(shape, (5, 9, 0), (0, -1, 0), max_distance=9.9).status[0] == MISS
    assert cast(shape, (5, 9, 0), (0, -1, 0), max_distance=10.1).status[0] == HIT


def test_rays_that_are_none_are_invalid():
    origins = np.array([[np.nan, 5, 0], [np.inf, 5, 0], [5, 5, 0], [5, 5, 0]])
    directions = np.array([[0, -1.0, 0], [0, -1, 0], [0, 0, 0], [np.nan, -1, 0]])
    assert_array_equal((BALL | FLOOR).raycast(origins, directions).status, om.Status.INVALID)


def test_planes_alone_are_a_shape():
    corner = FLOOR | om.plane(normal=(1, 0, 0), point=(-1, 0, 0))
    hits = cast(corner, (2, 0, 0), (-1, -1.0, 0))
    assert (hits.t[0], hits.steps[0], hits.status[0]) == (pytest.approx(1.0, abs=1e-12), 0, HIT)
    assert cast(corner, (2, 0, 0), (1, 0, 0)).status[0] == MISS
    assert cast(corner, (2, -3, 0), (1, 0, 0)).status[0] == INSIDE
    assert cast(corner, (2, np.nan, 0), (1, 0, 0)).status[0] == om.Status.INVALID
    scene = om.Scene(corner, lights=[om.DirectionalLight((-1, -1, 0)), om.DirectionalLight((1, -1, 0))], ambient=0.0)
    image = om.render(scene, om.Camera((3, 2, 5), (0, -1, 0)), (40, 30), planes=("color", "normal", "steps"))
    on_floor = image.normal[..., 1] > 0.5
    assert on_floor.sum() > 300
    assert (image.color[on_floor] > 0).all()
    assert image.stats["evaluations"] == image.stats["stages"]["normals"]["evaluations"]


# Against marches without closed forms ---------------------------------------------------------------------------------

unit = st.floats(-1, 1, allow_subnormal=False)
vectors = st.tuples(unit, unit, unit).filter(lambda v: np.linalg.norm(v) > 0.1)
solids = st.sampled_from(
    [om.sphere(0.7), om.box(1.0), om.torus(0.8, 0.2), om.capsule((-1, 0, 0), (1, 0.5, 0), 0.2), om.cylinder(0.4)]
)


@given(solids, st.lists(st.tuples(vectors, st.floats(0.5, 3)), min_size=1, max_size=3), st.integers(0, 2**32 - 1))
@pytest.mark.parametrize("precision", PRECISIONS)
def test_rays_are_those_of_marches(precision: str, solid: om.Shape, planes, seed: int):
    shape = om.union(solid, *(om.plane(normal=n, point=tuple(-h * np.array(n) / np.linalg.norm(n))) for n, h in planes))
    random = np.random.default_rng(seed)
    origins, directions = random.uniform(-4, 4, (64, 3)), random.normal(size=(64, 3))
    marches = [om.March(method=m, max_distance=50.0, max_steps=5000, epsilon=1e-5) for m in ("auto", "plain")]
    found, expected = (shape.raycast(origins, directions, march=m, precision=precision) for m in marches)
    same = found.status == expected.status
    distance = np.abs(shape.distance(found.position))
    # where they differ a ray only grazes something within the hit epsilon
    for i in np.flatnonzero(~same):
        path = origins[i] + np.linspace(0, 50, 20001)[:, None] * unit_of(directions[i : i + 1])
        assert np.abs(shape.distance(path)).min() < 5e-3
    hit = same & (found.status == HIT)
    assert (distance[hit] < 2e-5).all()


def unit_of(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_pictures_are_those_of_enhanced_marches(precision: str, isa: str):
    boxes = om.union(*(om.box(0.5).translate(x, -0.75, z) for x in (-2, 0, 2) for z in (-2, 0, 2)))
    scene = om.Scene(
        boxes | BALL.translate(0, 1, 0) | FLOOR | om.plane(normal=(0, 0, 1), point=(0, 0, -4)),
        lights=[om.DirectionalLight((-1, -2, -1)), om.PointLight((3, 4, 3), 20)],
        ambient=0.2,
    )
    camera = om.Camera((4, 3, 7), (0, 0, 0))
    options = {"planes": ("color", "depth", "status", "object_id"), "precision": precision, "isa": isa}
    found, expected = (om.render(scene, camera, (80, 60), march=m, **options) for m in (AUTO, ENHANCED))
    same = (found.status == expected.status) & (found.object_id == expected.object_id)
    assert same.mean() > 0.995  # edges
    hit = same & (found.status == HIT)
    assert np.quantile(np.abs(found.depth - expected.depth)[hit], 0.99) < 1e-4
    assert np.quantile(np.abs(found.color - expected.color)[hit].max(axis=-1), 0.98) < 0.02


def test_planes_cast_shadows():
    """A wall between the light and half of the floor, and a light that grazes it."""
    wall = om.plane(normal=(-1, 0, 0), point=(2, 0, 0))
    scene = om.Scene(BALL | FLOOR | wall, lights=[om.PointLight((4, 3, 0), 20)], ambient=0.0)
    image = om.render(scene, om.Camera((-3, 3, 6), (0, -1, 0)), (40, 30), march=AUTO)
    assert (image.color == 0).all()


def test_many_planes_are_marched_to():
    slopes = np.linspace(-0.5, 0.5, 40)
    walls = [om.plane(normal=(1, slope, 0), point=(9, 0, 0)) for slope in slopes]
    for count in (16, 17, 40):
        hits = cast(om.union(BALL, *walls[:count]), (30, 4, 0), (-1, 0, 0))
        assert hits.t[0] == pytest.approx(min(21 + 4 * slope for slope in slopes[:count]), abs=1e-5)
        assert (hits.steps[0] > 0) == (count > 16)
