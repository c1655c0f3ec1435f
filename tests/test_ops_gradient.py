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

    On a crease two such points may lie on opposite sides of the reference's: hence twice the spread.
    """
    points = representable(POINTS, precision)
    found = sample.shape.gradient(points, precision=precision, isa=isa)
    assert found.dtype == precision
    expected, spread = reference_gradients(sample, points, precision)
    own = 2 * ROUNDINGS * sample.levels * unit_roundoff(precision)
    error = np.linalg.norm(found - expected, axis=1)
    worst = int(np.argmax(error / (own + 2 * spread)))
    assert error[worst] <= own + 2 * spread[worst], (points[worst], str(om.compile(sample.shape)))
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
    "scaled repeat": om.box((0.5, 0.3, 0.2)).repeat((1, 2, 3)).scale(1.7),
}


@pytest.mark.parametrize("name", EXACT)
def test_gradient_of_exact_fields_has_unit_length(name: str, isa: str, precision: str):
    points = np.random.default_rng(3).normal(scale=2, size=(1000, 3))
    norms = np.linalg.norm(EXACT[name].gradient(points, precision=precision, isa=isa).astype(np.float64), axis=1)
    assert_allclose(norms, 1, rtol=0, atol=2 * ROUNDINGS * unit_roundoff(precision))


# Points on surfaces at coordinates that floats hold: there the secant finish ends, and there several formulas tie.

X, Y, Z = np.eye(3)
FACES = {
    "box": (om.box(2.0), [(p * s, p * s) for p in np.eye(3) for s in (1, -1)]),
    "box off the middle": (
        om.box(2.0),
        [((s, 0.5, -0.25), (s, 0, 0)) for s in (1, -1)] + [((0.5, -0.25, s), (0, 0, s)) for s in (1, -1)],
    ),
    "moved box": (om.box((1, 2, 4), center=(2, 0, 1)), [((2.5, 0, 1), X), ((2, -1, 1), -Y), ((2, 0, 3), Z)]),
    "room": (~om.box(4.0), [((2, 0, 0), -X), ((0, -2, 1), Y)]),
    "turned box": (om.box((2, 4, 6)).rotate(90, "z"), [((2, 0, 0), X), ((0, -1, 0), -Y), ((0, 0, 3), Z)]),
    "plane": (om.plane((0, -1, 0), (0, 1, 0)), [((5, 1, -7), -Y)]),
    "sphere": (om.sphere(1.0), [(p * s, p * s) for p in np.eye(3) for s in (1, -1)]),
    "cylinder": (om.cylinder(1.0), [((0, 5, 1), Z), ((-1, 0, 0), -X)]),
    "can": (om.cylinder(1.0, 2), [((1, 0, 0), X), ((0, 0, -1), -Z), ((0, 1, 0), Y), ((0.5, -1, 0), -Y)]),
    "can along x": (om.cylinder(1.0, 2, axis="x"), [((1, 0, 0), X), ((0, 1, 0), Y), ((-1, 0.5, 0), -X)]),
    "torus": (om.torus(1, 0.25), [((1.25, 0, 0), X), ((0.75, 0, 0), -X), ((0, 0.25, 1), Y), ((0, -0.25, -1), -Y)]),
    "capsule": (
        om.capsule((0, -1, 0), (0, 1, 0), 0.5),
        [((0.5, 1, 0), X), ((0.5, -1, 0), X), ((0, 1.5, 0), Y), ((0, -1.5, 0), -Y), ((0, 0, -0.5), -Z)],
    ),
    "repeat": (om.box(1.0).repeat(2), [((1.5, 0, 0), -X), ((0, -2.5, 0), -Y), ((4, 4, 4.5), Z)]),
    "repeat that leans": (om.box(0.5, center=(0.25, 0, 0)).repeat((2, 0, 0)), [((2, 0, 0), -X), ((-1.5, 0, 0), X)]),
    "wall and floor": (om.plane(Y) | om.box(2.0, center=(0, 1, 0)), [((1, 1, 0), X), ((3, 0, 0), Y), ((0, 2, 0), Y)]),
    "dug floor": (om.plane(Y) - om.box(2.0), [((0, -1, 0), Y), ((1, -0.5, 0), -X), ((-1, -0.5, 0.5), X)]),
    "cut ball": (om.sphere(2.0) & om.plane(X), [((0, 0.5, 0), X), ((0, -1, 1), X), ((-2, 0, 0), -X)]),
    "plane through the centre": (om.sphere(1.0) - om.plane(-Y, (0, 0.5, 0)), [((0, 0.5, 0), Y), ((0.25, 0.5, 0), Y)]),
    "point on a ball": (om.sphere(1.0) | om.sphere(0.0, center=X), [(X, X)]),
    "ball at a point": (om.sphere(0.0, center=X) | om.sphere(1.0), [(X, X)]),
    "ball about a point": (om.sphere(1.0) & ~om.sphere(0.0, center=-Y), [(-Y, -Y)]),
    "point cut out of a ball": (om.sphere(1.0) - om.sphere(0.0, center=Z), [(Z, Z)]),
}


@pytest.mark.parametrize("name", FACES)
def test_gradient_on_a_face_is_its_normal(name: str, isa: str, precision: str):
    shape, cases = FACES[name]
    points, normals = (np.array(column, float) for column in zip(*cases, strict=True))
    assert_array_equal(shape.distance(points, precision=precision, isa=isa), 0)
    assert_array_equal(shape.gradient(points, precision=precision, isa=isa), normals)


EDGES = {
    "box edge": (om.box(2.0), (1, -1, 0), (X, -Y)),
    "box corner": (om.box(2.0), (1, 1, -1), (X, Y, -Z)),
    "box middle": (om.box(2.0), (0, 0, 0), (X, Y, Z, -X, -Y, -Z)),
    "box diagonal": (om.box(2.0), (0.5, 0.5, 0), (X, Y)),
    "can rim": (om.cylinder(1.0, 2), (0, 1, 1), (Y, Z)),
    "can middle": (om.cylinder(1.0, 2), (0, 0, 0), (Y, -Y)),
    "two planes": (om.plane(X) | om.plane(Y), (0, 0, 0), (X, Y)),
    "wedge": (om.plane(X) & om.plane(Y), (0, 0, 1), (X, Y)),
    "notch": (om.plane(X) - om.plane(Y), (0, 0, 1), (X, -Y)),
    "border of cells": (om.sphere(0.5).repeat((2, 0, 0)), (1, 0, 0), (X, -X)),
    "border of leaning cells": (om.box(0.5, center=(0.5, 0, 0)).repeat((2, 0, 0)), (1.5, 0, 0), (X, -X)),
}


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


CENTRES = {
    "sphere": (om.sphere(1.0, center=(1, 2, 3)), (1, 2, 3)),
    "cylinder": (om.cylinder(1.0, axis="z"), (0, 0, 5)),
    "torus circle": (om.torus(1, 0.25), (0, 0, 1)),
    "torus middle": (om.torus(1, 0.25), (0, 0, 0)),
    "capsule segment": (om.capsule(-Y, Y, 0.5), (0, 0.5, 0)),
    "ball as capsule": (om.capsule(Y, Y, 0.5), Y),
    "line": (om.cylinder(0.0), Y),
    "stick": (om.cylinder(0.0, 2.0), (0, 0.5, 0)),
}


@pytest.mark.parametrize("name", CENTRES)
def test_gradient_where_no_direction_leads_away_is_zero(name: str, isa: str, precision: str):
    shape, point = CENTRES[name]
    assert_array_equal(shape.gradient(np.array(point, float), precision=precision, isa=isa), 0)


@given(sample=nested())
def test_gradient_is_never_nan(isa: str, precision: str, sample: Sample):
    found = sample.shape.gradient(LATTICE, precision=precision, isa=isa)
    assert (np.linalg.norm(found.astype(np.float64), axis=1) <= 1 + 2 * ROUNDINGS * sample.levels * 1e-7).all()


def test_gradient_of_a_point_with_nan_is_nan_and_no_other_is(isa: str, precision: str):
    shape = om.sphere(1.0).union(om.box(1.0).rotate(30), smooth=0.25)
    clean = shape.gradient(POINTS, precision=precision, isa=isa)
    spoilt = POINTS.copy()
    spoilt[70, 1] = np.nan
    found = shape.gradient(spoilt, precision=precision, isa=isa)
    assert np.isnan(found[70]).all()
    assert_array_equal(np.delete(found, 70, axis=0), np.delete(clean, 70, axis=0))
