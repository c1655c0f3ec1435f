"""Shapes made of expressions: distances within and beyond their bounds, and how they go together with all others."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import representable, unit_roundoff
from strategies import POINTS

X, Y, Z = om.coordinates()
BALL = om.field(om.length(X, Y, Z) - 1)
UNIT = ((-1, -1, -1), (1, 1, 1))


def box_distance(points: np.ndarray, lo, hi) -> np.ndarray:
    q = np.maximum(np.array(lo) - points, points - np.array(hi))
    return np.where((q <= 0).all(axis=1), q.max(axis=1), np.linalg.norm(np.maximum(q, 0), axis=1))


def test_a_field_is_its_expression(isa: str, precision: str):
    points = representable(POINTS, precision)
    assert_array_equal(
        BALL.distance(points, precision=precision, isa=isa),
        (om.length(X, Y, Z) - 1).evaluate(points, precision=precision, isa=isa),
    )


def test_a_field_that_is_a_shape_there_is_already(isa: str, precision: str):
    ball = om.sphere(1.0)
    assert_array_equal(
        BALL.distance(POINTS, precision=precision, isa=isa), ball.distance(POINTS, precision=precision, isa=isa)
    )
    assert om.compile(BALL).lipschitz == 1


BOUNDS = {
    "cube": UNIT,
    "box off the origin": ((0, -2, 0.5), (2, 1, 3)),
    "slab": ((-math.inf, -0.5, -math.inf), (math.inf, 0.5, math.inf)),
    "beam": ((-1, -math.inf, 0), (1, math.inf, 0.5)),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_bounds_cut_the_shape(name: str, isa: str, precision: str):
    """Beyond the box the field goes on from its nearest point, and nine times the distance to the box holds it up."""
    lo, hi = BOUNDS[name]
    points = representable(POINTS, precision)
    shape = om.field(X * X + Y - 0.25 * Z, lipschitz=9, bounds=(lo, hi))
    x, y, z = np.clip(points, lo, hi).T
    expected = np.maximum(x * x + y - 0.25 * z, 9 * box_distance(points, lo, hi))
    found = shape.distance(points, precision=precision, isa=isa)
    # a few roundings of squares of coordinates
    tolerance = 8 * unit_roundoff(precision) * (1 + np.linalg.norm(points, axis=1)) ** 2
    assert (np.abs(found - expected) <= tolerance).all()
    assert_allclose(found, om.reference.distance(shape, points), 0, tolerance.max())
    program = om.compile(shape)
    assert np.array_equal(program.bounds, np.array([lo, hi], float))
    assert program.lipschitz == 9


def test_steep_fields_cost_no_steps_outside_of_their_bounds(isa: str):
    """A ray that passes the box at some distance takes no more steps than the box alone would ask for."""
    steep = om.field(100 * (om.length(X, Y, Z) - 0.5), lipschitz=100, bounds=UNIT)
    passing = np.array([[1.5, 0, 9], [0, 2, 9], [-3, 1.2, 9]])
    hits = [shape.raycast(passing, [0, 0, -1], t_max=20, isa=isa) for shape in (steep, om.box(2.0))]
    assert_array_equal(hits[0].status, om.Status.MISS)
    assert (hits[0].steps <= hits[1].steps).all()


def test_fields_are_shapes_like_others(isa: str):
    row = (BALL - om.box(1.0)).scale(0.5).rotate(30, "z").repeat((2, None, None), 3)
    same = (om.sphere(1.0) - om.box(1.0)).scale(0.5).rotate(30, "z").repeat((2, None, None), 3)
    # the field computes in its own coordinates, the sphere's scale is folded
    assert_allclose(row.distance(POINTS, isa=isa), same.distance(POINTS, isa=isa), 0, 1e-13)
    hits = [shape.raycast(POINTS * 3, -POINTS, isa=isa) for shape in (row, same)]
    assert_array_equal(hits[0].status, hits[1].status)
    assert_allclose(hits[0].t[hits[0].status == 0], hits[1].t[hits[1].status == 0], 0, 1e-4)


def test_equal_fields_are_equal():
    assert om.field(om.length(X, Y, Z) - 1) == BALL == om.field(om.length(X, Y, Z) - 1, lipschitz=1)
    assert om.field(X, 1) != om.field(X, 2)
    assert om.field(X, 1, UNIT) != om.field(X, 1)
    assert om.field(X, 1, np.array(UNIT)) == om.field(X, 1, UNIT)


def test_a_field_of_a_number():
    assert om.field(2).distance([0, 0, 0]) == 2
    assert om.compile(om.field(2)).lipschitz == 0
    hits = om.field(2, bounds=UNIT).raycast([0, 0, 3], [0, 0, -1], t_max=10)
    assert hits.status == om.Status.MISS


SOLIDS = {
    "ball": (X * X + Y * Y + Z * Z <= 1, lambda p: (p**2).sum(axis=1) <= 1),
    "shell": (
        (X * X + Y * Y + Z * Z <= 1) & ~(X * X + Y * Y + Z * Z < 0.25),
        lambda p: ((p**2).sum(axis=1) <= 1) & ((p**2).sum(axis=1) >= 0.25),
    ),
    "octants": (X * Y * Z > 0, lambda p: p.prod(axis=1) > 0),
    "any number": (om.floor(X), lambda p: np.floor(p[:, 0]) != 0),
    "everything": (1, lambda p: np.ones(len(p), bool)),
    "nothing": (0, lambda p: np.zeros(len(p), bool)),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_know_inside_and_outside(name: str, isa: str, precision: str):
    condition, inside = SOLIDS[name]
    found = om.solid(condition).distance(POINTS[:120], precision=precision, isa=isa)
    smallest = float(np.finfo(np.float32).tiny)
    assert_array_equal(found, np.where(inside(representable(POINTS[:120], precision)), -smallest, smallest))


def test_solids_are_found_by_fixed_steps(isa: str):
    directions = -POINTS[:120] / np.linalg.norm(POINTS[:120], axis=1, keepdims=True)
    ball = om.solid(X * X + Y * Y + Z * Z <= 1)
    hits = ball.raycast(-3 * directions, directions, march=om.March(method="fixed", step=0.01), t_max=6, isa=isa)
    assert (hits.status == om.Status.HIT).all()
    assert (np.abs(hits.t - 2) <= 0.01 + 1e-4).all()


@pytest.mark.parametrize(
    "bounds", [3, "ab", (1, 2), ((0, 0), (1, 1)), ((0, 0, 0), (1, "a", 1)), ((-math.inf,) * 3, (1, 1, 1))], ids=str
)
def test_wrong_bounds_are_named(bounds):
    with pytest.raises((TypeError, ValueError), match=r"^bounds"):
        om.field(X, 1, bounds)
