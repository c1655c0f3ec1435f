"""Distances by the kernels against the scalar reference in double: primitives, operators, and shapes nested at random.

The tolerance is derived in rounding.py. What the reference itself is worth is for test_reference.py to say.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

import octomarch as om
from limits import LIMITS
from rounding import field_error, representable, unit_roundoff
from strategies import POINTS, PRIMITIVES, Sample, combined, nested, primitive, repeated, rotated, scaled, translated


def check(sample: Sample, isa: str, precision: str) -> None:
    points = representable(POINTS, precision)
    found = sample.shape.distance(points, precision=precision, isa=isa)
    assert found.dtype == precision
    error = np.abs(found - om.reference.distance(sample.shape, points))
    worst = int(np.argmax(error / field_error(sample, points, precision)))
    assert error[worst] <= field_error(sample, points, precision)[worst], (points[worst], str(om.compile(sample.shape)))


@pytest.mark.parametrize("kind", PRIMITIVES)
@given(data=st.data())
def test_distance_of_a_primitive(kind: str, isa: str, precision: str, data: st.DataObject):
    check(data.draw(PRIMITIVES[kind]), isa, precision)


@pytest.mark.parametrize("kind", [om.union, om.intersection, om.difference])
@given(operands=st.lists(primitive, min_size=2, max_size=5), k=st.sampled_from([0.0, 0.01, 0.5, 2.0]))
def test_distance_of_a_combination(kind, isa: str, precision: str, operands: list[Sample], k: float):
    check(combined(kind, operands, k), isa, precision)


@given(sample=nested())
def test_distance_of_nested_shapes(isa: str, precision: str, sample: Sample):
    check(sample, isa, precision)


@pytest.mark.parametrize("name", LIMITS)
def test_distance_of_limit_shapes(name: str, isa: str, precision: str):
    check(Sample(LIMITS[name], 3.0, 3, np.full(3, np.inf), gain=2.0), isa, precision)


REPEATS = {
    "endless": ((2, 2, 2), None),
    "along one axis": ((0, 2, 0), None),
    "odd counts": ((2, 2, 2), (3, 1, 5)),
    "even counts": ((2, 2, 2), (2, 4, 2)),
    "mixed": ((2, 3, 4), (None, 2, 3)),
    "not a sum of powers of 2": ((1.7, 1.9, 2.1), (None, 3, 4)),
}
CONTENTS = {
    "symmetric": om.sphere(0.6) & om.box(1.0),
    "leaning along x": om.box((0.3, 0.5, 0.4)).translate(0.3, 0, 0),
    "leaning along all": om.capsule((-0.4, -0.3, 0), (0.1, 0.4, 0.6), 0.2),
    "turned": om.box((0.9, 0.4, 0.2)).rotate(33, (1, 2, 3)),
    "cone": om.cone(0.6, 1.0).translate(0, 0.2, 0),
    "stretched and leaning": om.sphere(0.4).stretch((1, 2, 1)).translate(0.3, 0, 0),
    "star": om.star(5, 0.8, 0.3).extrude(0.5),
    "hollow and leaning": om.box(1.2) - om.sphere(0.5).translate(0.1, 0.1, 0.1),
}


@pytest.mark.parametrize("grid", REPEATS)
@pytest.mark.parametrize("content", CONTENTS)
def test_distance_of_repeats(grid: str, content: str, isa: str, precision: str):
    period, counts = REPEATS[grid]
    shape = CONTENTS[content].repeat(period, counts)
    check(Sample(shape, 3 + 2 * sum(period), 7, np.full(3, np.inf)), isa, precision)


@given(sample=primitive, turn=st.floats(-180, 180, allow_subnormal=False), offset=st.floats(-1, 1))
def test_distance_of_turned_and_scaled_repeats(isa: str, precision: str, sample: Sample, turn: float, offset: float):
    cells = repeated(translated(sample, (offset, 0, 0)), (True, True, True), (None, 2, 3), 0.0)
    check(scaled(rotated(translated(cells, (0, offset, 1)), turn, (1, -1, 2)), 0.7), isa, precision)


def test_repeats_below_zero_stand_where_they_should(isa: str, precision: str):
    """Cells of negative numbers, where a remainder of division would mirror or shift them."""
    row = om.sphere(0.25).repeat((1, None, None))
    x = np.arange(-40, 41) / 8
    found = row.distance(np.stack([x, 0 * x, 0 * x], -1), precision=precision, isa=isa)
    assert_array_equal(found, np.abs(x - np.round(x)) - 0.25)


@pytest.mark.parametrize("count", [1, 7, 8, 9, 63, 64, 65, 4097])
def test_distances_do_not_depend_on_how_many_are_asked_for(count: int, isa: str, precision: str):
    shape = (om.sphere(1.0).union(om.box(1.5).rotate(20), smooth=0.2) - om.torus(1, 0.3)).repeat((4, None, 5))
    points = np.random.default_rng(5).normal(scale=3, size=(5000, 3))
    whole = shape.distance(points, precision=precision, isa=isa, threads=1)
    assert_array_equal(shape.distance(points[:count], precision=precision, isa=isa), whole[:count])


def test_a_point_with_nan_has_distance_nan_and_no_other_has(isa: str, precision: str):
    shape = (om.sphere(1.0) | om.box(1.0)).repeat((3, None, None)) - om.cylinder(0.2)
    points = POINTS.copy()
    clean = shape.distance(points, precision=precision, isa=isa)
    points[[3, 64, 100], [0, 1, 2]] = np.nan
    found = shape.distance(points, precision=precision, isa=isa)
    assert np.flatnonzero(np.isnan(found)).tolist() == [3, 64, 100]
    others = np.delete(np.arange(len(points)), [3, 64, 100])
    assert_array_equal(found[others], clean[others])


def test_smooth_operators_are_exact_where_operands_differ_by_more_than_k(isa: str):
    a, b = om.sphere(1.0), om.box(1.0).translate(1.5, 0.25, 0)
    fields = a.distance(POINTS, isa=isa), b.distance(POINTS, isa=isa)
    apart = np.abs(fields[0] - fields[1]) >= 0.25
    assert apart.any()
    assert_array_equal(a.union(b, smooth=0.25).distance(POINTS, isa=isa)[apart], np.minimum(*fields)[apart])
    apart = np.abs(fields[0] + fields[1]) >= 0.25
    cut = a.difference(b, smooth=0.25).distance(POINTS, isa=isa)
    assert_array_equal(cut[apart], np.maximum(fields[0], -fields[1])[apart])
    assert (cut[~apart] > np.maximum(fields[0], -fields[1])[~apart]).all()


NARROWEST = 1e-37  # blends of less count as none


@pytest.mark.parametrize("k", [0.3, 1e-6, 1e6, 1e20, 1e-30, 1e-40, 5e-324])
def test_blends_of_any_width_are_finite_and_as_deep_as_they_say(k: float, isa: str, precision: str):
    """At equal operands the blend is k/4 below both."""
    ball = om.sphere(1.0)
    blended = ball.translate(1, 0, 0).union(ball.translate(-1, 0, 0), smooth=k)
    value = float(blended.distance([0, 0, 0], precision=precision, isa=isa))
    assert value == pytest.approx(-k / 4, rel=4 * unit_roundoff(precision), abs=NARROWEST)
    assert np.isfinite(blended.distance(POINTS, precision=precision, isa=isa)).all()
    assert np.isfinite(om.reference.distance(blended, POINTS, dtype=precision)).all()


@pytest.mark.parametrize("k", [0.3, 1e-3, 1e-6, 1e6, 1e20, 1e-30])
def test_metaballs_of_any_width_are_finite_and_as_deep_as_they_say(k: float, isa: str, precision: str):
    """At equal operands the blend is k log 2 below both; far from each other they are not felt."""
    left, right = om.sphere(1.0, center=(-1, 0, 0)), om.sphere(1.0, center=(1, 0, 0))
    blended = om.metaballs(left, right, k=k)
    value = float(blended.distance([0, 0, 0], precision=precision, isa=isa))
    assert value == pytest.approx(-k * np.log(2), rel=8 * unit_roundoff(precision))
    found = blended.distance(POINTS, precision=precision, isa=isa)
    assert np.isfinite(found).all()
    fields = [shape.distance(POINTS, precision=precision, isa=isa).astype(np.float64) for shape in (left, right)]
    rounding = 8 * unit_roundoff(precision) * (np.abs(fields[0]) + k)
    assert (found <= np.minimum(*fields) + rounding).all()
    apart = np.abs(fields[0] - fields[1]) > 200 * k
    assert_array_equal(found[apart], np.minimum(*fields)[apart])


def test_folding_order_is_from_the_left(isa: str):
    """Blends of three differ with their order: the documented one is kept by the compiler."""
    a, b, c = om.sphere(0.5), om.sphere(0.5).translate(0.4, 0, 0), om.sphere(0.5).translate(0, 0.4, 0)
    whole = om.union(a, b, c, smooth=0.5).distance(POINTS, isa=isa)
    assert_array_equal(whole, a.union(b, smooth=0.5).union(c, smooth=0.5).distance(POINTS, isa=isa))
    assert (whole != a.union(b.union(c, smooth=0.5), smooth=0.5).distance(POINTS, isa=isa)).any()
