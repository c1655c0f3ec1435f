"""The scalar reference against closed forms, brute force and finite differences: nothing here runs a compiled program
to find out what is right.
"""

import signal
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]
Oracle = Callable[[Array], Array]

ROUNDING = 1e-13  # of float64 for coordinates of a few units and a dozen operations
ROUNDING32 = 1e-5  # the same for float32
DIFFERENCE_STEP = 1e-6  # of central differences: its cube and the rounding over it are both near 1e-10
POINTS = np.random.default_rng(7).normal(scale=1.5, size=(500, 3))


def norm(v: Array) -> Array:
    return np.sqrt((v * v).sum(axis=-1))


def corner(q: Array) -> Array:
    """Distance to a box of any dimension from |p| - half size."""
    return norm(np.maximum(q, 0)) + np.minimum(q.max(axis=-1), 0)


def radial(p: Array) -> Array:
    return norm(p[..., [0, 2]])


def segment(p: Array, a: Array, b: Array) -> Array:
    share = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return norm(p - a - share[..., None] * (b - a))


PRIMITIVES: dict[str, tuple[om.Shape, Oracle]] = {
    "sphere": (om.sphere(1.2), lambda p: norm(p) - 1.2),
    "box": (om.box((1, 2, 3)), lambda p: corner(np.abs(p) - [0.5, 1, 1.5])),
    "plane": (om.plane((1, 2, 2), (0, 1, 0)), lambda p: p @ [1 / 3, 2 / 3, 2 / 3] - 2 / 3),
    "cylinder": (om.cylinder(0.7), lambda p: radial(p) - 0.7),
    "cylinder along x": (om.cylinder(0.7, axis="x"), lambda p: norm(p[..., 1:]) - 0.7),
    "capped": (om.cylinder(0.7, 2), lambda p: corner(np.stack([radial(p) - 0.7, np.abs(p[..., 1]) - 1], -1))),
    "torus": (om.torus(1, 0.3), lambda p: np.hypot(radial(p) - 1, p[..., 1]) - 0.3),
    "leaning torus": (
        om.torus(1, 0.3, axis=(2, -1, 2)),
        lambda p: np.hypot(norm(np.cross(p, np.array([2, -1, 2]) / 3)) - 1, p @ np.array([2, -1, 2]) / 3) - 0.3,
    ),
    "capsule": (
        om.capsule((1, 0, 0), (-1, 1, 0.5), 0.2),
        lambda p: segment(p, np.array([1.0, 0, 0]), np.array([-1, 1, 0.5])) - 0.2,
    ),
}

LIMITS = {
    "point": om.sphere(0),
    "flat box": om.box((0, 2, 0)),
    "line": om.cylinder(0),
    "disc": om.cylinder(1, 0),
    "stick": om.cylinder(0, 2),
    "circle": om.torus(1, 0),
    "ball as torus": om.torus(0, 1),
    "ball as capsule": om.capsule((0, 0, 0), (0, 0, 0), 1),
    "segment": om.capsule((0, -1, 0), (0, 1, 0), 0),
}


@pytest.fixture(params=PRIMITIVES)
def primitive(request: pytest.FixtureRequest) -> tuple[om.Shape, Oracle]:
    return PRIMITIVES[request.param]


def test_distance_is_the_closed_form(primitive: tuple[om.Shape, Oracle]):
    shape, oracle = primitive
    assert_allclose(om.reference.distance(shape, POINTS), oracle(POINTS), rtol=0, atol=ROUNDING)


def test_distance_in_float32_is_close_and_float32(primitive: tuple[om.Shape, Oracle]):
    shape, oracle = primitive
    values = om.reference.distance(shape, POINTS, dtype="float32")
    assert values.dtype == np.float32
    assert_allclose(values, oracle(POINTS), rtol=0, atol=ROUNDING32)


@pytest.mark.parametrize("name", LIMITS)
def test_limit_shapes_are_finite_where_nothing_has_a_direction(name: str):
    points = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    assert np.isfinite(om.reference.distance(LIMITS[name], points)).all()
    assert (norm(om.reference.gradient(LIMITS[name], points)) <= 1 + ROUNDING).all()


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_nested_shapes_follow_their_definitions(data: st.DataObject):
    shape, oracle = data.draw(nested)
    expected = oracle(POINTS[:100])
    found = om.reference.distance(shape, POINTS[:100])
    assert_allclose(found, expected, rtol=1e-12, atol=100 * ROUNDING)


def blend(a: Array, b: Array, k: float) -> Array:
    smooth = np.maximum(k - np.abs(a - b), 0) ** 2 / (4 * k) if k > 0 else 0.0
    return np.minimum(a, b) - smooth


def turned(p: Array, degrees: float) -> Array:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return p @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def grown(children: st.SearchStrategy[tuple[om.Shape, Oracle]]) -> st.SearchStrategy[tuple[om.Shape, Oracle]]:
    amount = st.floats(-2, 2)
    smooth = st.sampled_from([0.0, 0.05, 0.5])

    def united(a, b, k):
        return a[0].union(b[0], smooth=k), lambda p: blend(a[1](p), b[1](p), k)

    def intersected(a, b, k):
        return a[0].intersection(b[0], smooth=k), lambda p: -blend(-a[1](p), -b[1](p), k)

    def subtracted(a, b, k):
        return a[0].difference(b[0], smooth=k), lambda p: -blend(-a[1](p), b[1](p), k)

    return st.one_of(
        st.builds(united, children, children, smooth),
        st.builds(intersected, children, children, smooth),
        st.builds(subtracted, children, children, smooth),
        st.builds(lambda a: (~a[0], lambda p: -a[1](p)), children),
        st.builds(lambda a, x, y: (a[0].translate(x, y, 1), lambda p: a[1](p - [x, y, 1])), children, amount, amount),
        st.builds(lambda a, d: (a[0].rotate(90 * d), lambda p: a[1](turned(p, 90 * d))), children, amount),
        st.builds(lambda a, d: (a[0].scale(2**d), lambda p: a[1](p / 2**d) * 2**d), children, amount),
    )


nested = st.recursive(st.sampled_from(list(PRIMITIVES.values())), grown, max_leaves=12)


@pytest.mark.parametrize(("counts", "cells"), [(None, range(-9, 10)), (4, (-1.5, -0.5, 0.5, 1.5)), (3, (-1, 0, 1))])
def test_repeat_is_the_union_of_its_copies_even_if_they_lean_to_one_side(counts: int | None, cells: range):
    leaning = om.box((0.3, 0.5, 0.2)).translate(0.3, 0.2, 0)
    repeated = leaning.repeat((1, 0, 1.5), counts=counts)
    copies = om.union(*(leaning.translate(i, 0, 1.5 * j) for i in cells for j in cells))
    found, expected = (om.reference.distance(shape, POINTS) for shape in (repeated, copies))
    assert_allclose(found, expected, rtol=0, atol=ROUNDING)


def test_a_point_with_nan_has_distance_nan():
    assert np.isnan(om.reference.distance(om.sphere(1) | om.box(1), [np.nan, 0, 0]))


@given(st.data())
@settings(max_examples=40, deadline=None)
def test_gradient_is_the_limit_of_differences(data: st.DataObject):
    shape, _ = data.draw(nested)
    points, h = POINTS[:50], DIFFERENCE_STEP
    ahead, behind = (
        np.stack([om.reference.distance(shape, points + step * axis) for axis in np.eye(3)], -1) for step in (h, -h)
    )
    here = om.reference.distance(shape, points)[:, None]
    smooth = (np.abs(ahead + behind - 2 * here) < 1e-9).all(axis=1)  # no crease, no small curvature, within the step
    found = om.reference.gradient(shape, points)
    assert_allclose(found[smooth], ((ahead - behind) / (2 * h))[smooth], rtol=0, atol=1e-6)


def test_gradient_on_faces_and_edges_is_that_of_a_side():
    faces = [(1, 0.5, 0), (-1, 0.5, 0), (0, 1, 0), (0.2, -1, 0), (0, 0, 1), (0, 0.1, -1)]
    assert_allclose(om.reference.gradient(om.box(2.0), faces), np.round(faces), atol=0)
    ties = [(1, 1, 1), (1, -1, 0), (0, 0, 0), (0.5, 0.5, 0)]
    assert_allclose(norm(om.reference.gradient(om.box(2.0), ties)), 1)
    can = [(0, 1, 0), (0, -1, 0), (1, 0, 0)]
    assert_allclose(om.reference.gradient(om.cylinder(1, 2), can), can)
    point_on_ball = om.sphere(1.0) | om.sphere(0.0).translate(1, 0, 0)
    assert_allclose(om.reference.gradient(point_on_ball, [1, 0, 0]), [1, 0, 0])


def test_gradient_where_blended_shapes_are_equally_far_is_the_mean():
    left, right = om.sphere(1.0).translate(-0.5, 0, 0), om.sphere(1.0).translate(0.5, 0, 0)
    mean = [0, 2 / np.sqrt(5), 0]
    for shape in (left.union(right, smooth=0.2), left.intersection(right, smooth=0.2)):
        assert_allclose(om.reference.gradient(shape, [0, 1, 0]), mean, atol=ROUNDING)
    assert_allclose(om.reference.gradient(left.difference(~right, smooth=0.2), [0, 1, 0]), mean, atol=ROUNDING)


def test_gradient_is_zero_only_at_centres():
    assert_array_equal(om.reference.gradient(om.sphere(1.0), [0, 0, 0]), 0)
    assert_allclose(norm(om.reference.gradient(om.sphere(1.0), [5e-324, 0, 0])), 1)
    assert_allclose(norm(om.reference.gradient(om.sphere(1.0), [0, 1e-30, 0], dtype="float32")), 1)


def test_depth_and_width_of_a_graph_have_no_limit():
    deep = om.sphere(1.0)
    for _ in range(50_000):
        deep = ~(~deep).translate(0, 2**-10, 0)
    assert_allclose(om.reference.distance(deep, [0, 50_000 * 2**-10 + 3, 0]), 2)
    wide = om.union(*(om.sphere(0.5).translate(i, 0, 0) for i in range(100_000)))
    assert_allclose(om.reference.distance(wide, [70_000, 2, 0]), 1.5)


def test_shared_parts_are_evaluated_once_per_point():
    shape = om.sphere(0.5)
    for _ in range(200):  # unfolds to 3**200 spheres
        shape = shape.union(~shape, smooth=0.01) | shape
    assert np.isfinite(om.reference.distance(shape, [1, 2, 3]))


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_raycast_finds_the_roots_of_a_sphere(dtype: str):
    rng = np.random.default_rng(3)
    origins = 4 * (lambda v: v / norm(v)[:, None])(rng.normal(size=(300, 3)))
    directions = rng.normal(scale=0.4, size=(300, 3)) - origins / 4
    hits = om.reference.raycast(om.sphere(1.0), origins, directions, dtype=dtype)
    a, b = (directions**2).sum(1), (origins * directions).sum(1)
    discriminant = b * b - a * 15
    clear = np.abs(discriminant) > 0.1  # the others pass within some tolerance of the silhouette
    root = np.where(discriminant > 0, (-b - np.sqrt(np.maximum(discriminant, 0))) / a, np.inf)
    assert_array_equal(hits.status[clear] == om.Status.HIT, discriminant[clear] > 0)
    assert_allclose(hits.t[clear], root[clear], rtol=2e-5)
    met = clear & (discriminant > 0)
    assert_allclose(hits.normal[met], hits.position[met], atol=1e-4)


def test_raycast_reports_what_became_of_each_ray():
    origins = [(0, 0, 3), (0, 0, 3), (0, 0, 0), (0, 0, 3), (np.nan, 0, 3), (0, 0, 3), (0, 0, np.inf)]
    directions = [(0, 0, -2), (0, 0, 2), (0, 0, 1), (0, 0, 0), (0, 0, 1), (0, 0, np.inf), (0, 0, -1)]
    hits = om.reference.raycast(om.sphere(1.0), origins, directions)
    names = [om.Status(status).name for status in hits.status]
    assert names == ["HIT", "MISS", "INSIDE", "INVALID", "INVALID", "INVALID", "INVALID"]
    assert_array_equal(hits.t, [1, np.inf, 0, np.inf, np.inf, np.inf, np.inf])
    assert_array_equal(hits.material_id, [0, -1, -1, -1, -1, -1, -1])
    assert_array_equal(hits.normal[1:], 0)
    assert hits.steps[3] == 0


def test_t_max_counts_in_lengths_of_the_direction():
    limits = [om.reference.raycast(om.sphere(1.0), [0, 0, 5], [0, 0, -2], t_max=t).status for t in (1.9, 2.1)]
    assert limits == [om.Status.MISS, om.Status.HIT]


def test_step_limit_keeps_a_candidate_before_the_surface():
    march = om.March(max_steps=5, max_distance=1e4)
    hits = om.reference.raycast(om.plane(), [0, 1, 0], [1, -0.01, 0], march=march)
    assert hits.status == om.Status.STEP_LIMIT
    assert 0 < hits.t < 100
    assert hits.steps == 5


def test_secant_finish_lands_on_a_plane_and_nothing_else_does():
    march = {"epsilon": 1e-3, "max_distance": 1e3}
    rays = [0, 2, 0], [1, -0.5, 0.2]
    exact = om.reference.raycast(om.plane(), *rays, march=om.March(**march))
    plain = om.reference.raycast(om.plane(), *rays, march=om.March(**march, finish=None))
    assert_allclose(exact.t, 4, rtol=ROUNDING)
    assert 1e-5 < 4 - plain.t < 1e-2


def test_materials_count_in_order_of_appearance():
    red, blue = om.Material((1, 0, 0)), om.Material((0, 0, 1))
    balls = [om.sphere(0.4).translate(i, 0, 0) for i in range(4)]
    shape = om.union(balls[0].paint(blue), balls[1], balls[2].paint(red).paint(blue), balls[3].paint(blue))
    hits = om.reference.raycast(shape, [(i, 3, 0) for i in range(4)], [0, -1, 0])
    assert hits.material_id.tolist() == [0, 1, 2, 0]


@pytest.mark.parametrize("call", [om.reference.distance, om.reference.gradient])
def test_queries_refuse_what_they_cannot_read(call: Callable[..., Array]):
    with pytest.raises(ValueError, match="points must have shape"):
        call(om.sphere(1.0), [1, 2])
    with pytest.raises(ValueError, match="dtype must be one of"):
        call(om.sphere(1.0), [1, 2, 3], dtype="float16")
    with pytest.raises(TypeError, match="shape must be"):
        call("ball", [1, 2, 3])


def test_raycast_refuses_what_it_cannot_march():
    with pytest.raises(ValueError, match="t_max must be > 0"):
        om.reference.raycast(om.sphere(1.0), [0, 0, 3], [0, 0, -1], t_max=np.nan)
    with pytest.raises(TypeError, match="march must be"):
        om.reference.raycast(om.sphere(1.0), [0, 0, 3], [0, 0, -1], march=64)


def test_ctrl_c_stops_long_work():
    code = "import octomarch as om; print(flush=True); om.reference.render(om.sphere(1.0), size=(9999, 9999))"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.3)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=10)
    assert b"KeyboardInterrupt" in errors
