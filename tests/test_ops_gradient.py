"""Exact gradients by the kernels: against the reference, of unit length, and on the ties where a textbook formula has
none. Renders and ray queries normalise them.
"""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from faces import CENTRES, CORNERS, EDGES, FACES, SLANTED, X, Y
from limits import LIMITS
from rounding import ROUNDINGS, field_error, representable, unit_roundoff
from strategies import GENERIC, POINTS, PRIMITIVES, Sample, nested

DIRECTIONS = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]

LATTICE = np.array(list(itertools.product((-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0), repeat=3)))


def reference_gradients(sample: Sample, points: np.ndarray, precision: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the reference's gradients, and how much they differ within the rounding error of the points' distances."""
    here = om.reference.gradient(sample.shape, points)
    around = points[:, None] + field_error(sample, points, precision)[:, None, None] * DIRECTIONS
    there = om.reference.gradient(sample.shape, around.reshape(-1, 3)).reshape(len(points), -1, 3)
    return here, np.linalg.norm(there - here[:, None], axis=-1).max(axis=1)


def check(sample: Sample, isa: str, precision: str) -> None:
    """Check that each gradient is one of a point within the error of distances, up to rounding of its own.

    On a crease two such points may lie on opposite sides of the reference's: hence twice the spread. Where a face goes
    over into a round of a corner, or one shape touches another, distances differ by the square of the angle between
    gradients: at distance d an error e decides for one that is off by up to √(2e/d).
    """
    points = representable(POINTS, precision)
    found = sample.shape.gradient(points, precision=precision, isa=isa)
    assert found.dtype == precision
    expected, spread = reference_gradients(sample, points, precision)
    own = 2 * ROUNDINGS * sample.levels * sample.gain * unit_roundoff(precision)
    doubt = field_error(sample, points, precision)
    distance = np.abs(om.reference.distance(sample.shape, points))
    touching = np.sqrt(2 * doubt / np.maximum(distance, doubt))
    tolerance = own + 2 * spread + sample.gain * np.where(sample.folded & (distance <= doubt), 2, touching)
    error = np.linalg.norm(found - expected, axis=1)
    worst = int(np.argmax(error / tolerance))
    assert error[worst] <= tolerance[worst], (points[worst], str(om.compile(sample.shape)))
    assert np.linalg.norm(found, axis=1).max() <= om.compile(sample.shape).lipschitz + own
    assert np.mean(spread[GENERIC] < 0.01) > 0.8, "nearly all points should have one gradient: the test tests nothing"


@pytest.mark.parametrize("kind", PRIMITIVES)
@given(data=st.data())
def test_gradient_of_a_primitive(kind: str, isa: str, precision: str, data: st.DataObject):
    check(data.draw(PRIMITIVES[kind]), isa, precision)


@given(sample=nested())
def test_gradient_of_nested_shapes(isa: str, precision: str, sample: Sample):
    check(sample, isa, precision)


EXACT = {
    "sphere": om.sphere(0.7, center=(0.1, 0.2, 0.3)),
    "box": om.box((1, 2, 3)).rotate(20, (1, 1, 0)),
    "plane": om.plane((1, 2, 2), (0, 1, 0)),
    "cylinder": om.cylinder(0.7, axis="z"),
    "capped": om.cylinder(0.7, 2, axis=(1, 2, 3)),
    "torus": om.torus(1, 0.3, axis="x"),
    "capsule": om.capsule((1, 0, 0), (-1, 1, 0.5), 0.2),
    "cone": om.cone(1, 2, axis=(1, 2, 3)),
    "capped cone": om.capped_cone(0.25, 1, 0.5),
    "octahedron": om.octahedron(1.2).rotate(33),
    "pyramid": om.pyramid(1, 2),
    "prism": om.triangular_prism(1, 0.5, axis=(1, 1, 0)),
    "link": om.link(1, 0.5, 0.2),
    "rounded box": om.rounded_box((1, 2, 3), 0.25),
    "star": om.star(5, 1, 0.4).extrude(0.5),
    "revolved polygon": om.polygon([(0.5, 0), (1, 0.5), (0.75, 1)]).revolve(0.25),
    "scaled repeat": om.box((0.5, 0.3, 0.2)).repeat((1, 2, 3)).scale(1.7),
}


@pytest.mark.parametrize("name", EXACT)
def test_gradient_of_exact_fields_has_unit_length(name: str, isa: str, precision: str):
    points = np.random.default_rng(3).normal(scale=2, size=(1000, 3))
    norms = np.linalg.norm(EXACT[name].gradient(points, precision=precision, isa=isa).astype(np.float64), axis=1)
    assert_allclose(norms, 1, rtol=0, atol=2 * ROUNDINGS * unit_roundoff(precision))


@pytest.mark.parametrize("name", FACES)
def test_gradient_on_a_face_is_its_normal(name: str, isa: str, precision: str):
    shape, cases = FACES[name]
    points, normals = (np.array(column, float) for column in zip(*cases, strict=True))
    assert_array_equal(shape.distance(points, precision=precision, isa=isa), 0)
    assert_array_equal(shape.gradient(points, precision=precision, isa=isa), normals)


@pytest.mark.parametrize("name", SLANTED)
def test_gradient_on_a_slanted_face_is_its_normal(name: str, isa: str, precision: str):
    shape, cases = SLANTED[name]
    points, normals = (np.array(column, float) for column in zip(*cases, strict=True))
    rounding = 2 * ROUNDINGS * unit_roundoff(precision)
    assert_allclose(shape.distance(points, precision=precision, isa=isa), 0, atol=rounding)
    found = shape.gradient(points, precision=precision, isa=isa)
    assert_allclose(found, normals / np.linalg.norm(normals, axis=1)[:, None], atol=rounding)


@pytest.mark.parametrize("name", CORNERS)
def test_gradient_on_a_corner_leads_out(name: str, isa: str, precision: str):
    shape, corners = CORNERS[name]
    points = np.array(corners, float)
    found = shape.gradient(points, precision=precision, isa=isa).astype(np.float64)
    assert_allclose(np.linalg.norm(found, axis=1), 1, atol=2 * ROUNDINGS * unit_roundoff(precision))
    assert (shape.distance(points + 0.01 * found) > 0.001).all()


@pytest.mark.parametrize("name", EDGES)
def test_gradient_on_an_edge_is_that_of_one_side(name: str, isa: str, precision: str):
    shape, point, sides = EDGES[name]
    found = shape.gradient(np.array(point, float), precision=precision, isa=isa)
    assert any((found == side).all() for side in sides), found


SMOOTH = {
    "union": om.sphere(1.0, center=-X / 2).union(om.sphere(1.0, center=X / 2), smooth=0.25),
    "intersection": om.sphere(1.0, center=-X / 2).intersection(om.sphere(1.0, center=X / 2), smooth=0.25),
    "difference": om.sphere(1.0, center=-X / 2).difference(~om.sphere(1.0, center=X / 2), smooth=0.25),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_gradient_in_the_middle_of_a_blend_is_the_mean(name: str, isa: str, precision: str):
    found = SMOOTH[name].gradient(Y, precision=precision, isa=isa)
    assert_allclose(found, [0, 2 / np.sqrt(5), 0], atol=ROUNDINGS * unit_roundoff(precision))


@pytest.mark.parametrize("name", CENTRES)
def test_gradient_where_no_direction_leads_away_is_zero(name: str, isa: str, precision: str):
    shape, point = CENTRES[name]
    assert_array_equal(shape.gradient(np.array(point, float), precision=precision, isa=isa), 0)


@given(sample=nested())
def test_gradient_is_never_nan(isa: str, precision: str, sample: Sample):
    found = sample.shape.gradient(LATTICE, precision=precision, isa=isa)
    steepest = om.compile(sample.shape).lipschitz
    rounding = 2 * ROUNDINGS * sample.levels * sample.gain * 1e-7
    assert (np.linalg.norm(found.astype(np.float64), axis=1) <= steepest + rounding).all()


@pytest.mark.parametrize("name", LIMITS)
def test_gradient_of_limit_shapes_is_never_nan(name: str, isa: str, precision: str):
    found = LIMITS[name].gradient(LATTICE, precision=precision, isa=isa)
    steepest = om.compile(LIMITS[name]).lipschitz
    assert (np.linalg.norm(found.astype(np.float64), axis=1) <= steepest + 1e-5).all()


def test_gradient_of_a_point_with_nan_is_nan_and_no_other_is(isa: str, precision: str):
    shape = om.sphere(1.0).union(om.box(1.0).rotate(30), smooth=0.25)
    clean = shape.gradient(POINTS, precision=precision, isa=isa)
    spoilt = POINTS.copy()
    spoilt[70, 1] = np.nan
    found = shape.gradient(spoilt, precision=precision, isa=isa)
    assert np.isnan(found[70]).all()
    assert_array_equal(np.delete(found, 70, axis=0), np.delete(clean, 70, axis=0))


@pytest.mark.parametrize(("precision", "least"), [("float32", 2.0**-63), ("float64", 2.0**-511)])
def test_lengths_too_short_to_have_a_direction_have_no_slope(isa: str, precision: str, least: float):
    """Below the root of the least normal number squares lose their digits."""
    directions = np.array([(1, 0, 0), (3, 4, 0), (0, -5, 12), (2, -6, 3)])
    for shape in (om.sphere(1.0), om.capsule((0, 0, 0), (0, 0, 0), 0.5), om.torus(0.0, 1.0)):
        far = shape.gradient(directions * least, isa=isa, precision=precision)
        np.testing.assert_allclose(np.linalg.norm(far, axis=1)[:2], 1, rtol=1e-5)
        near = shape.gradient(directions * least / 64, isa=isa, precision=precision)
        assert np.array_equal(near, np.zeros_like(near)), shape
