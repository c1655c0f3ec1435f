"""Shapes are immutable values: built, combined and placed by an algebra, and asked about points."""

import copy

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om

BALL = om.sphere(1.0)
CUBE = om.box(1.5)
NAN, INF = float("nan"), float("inf")


def test_equal_shapes_are_equal_and_hash_alike():
    again = om.sphere(1) | om.box((1.5, 1.5, 1.5))
    assert again == BALL | CUBE
    assert hash(again) == hash(BALL | CUBE)
    assert len({BALL, CUBE, om.sphere(1.0), om.sphere(1.0 + 2**-50)}) == 3
    assert om.sphere(1.0) != om.sphere(2.0)
    assert om.sphere(1.0) != 1.0


def test_shapes_are_immutable():
    for change in (
        lambda: setattr(BALL, "_node", CUBE._node),
        lambda: delattr(BALL, "_node"),
        lambda: setattr(BALL, "a", 1),
    ):
        with pytest.raises(AttributeError, match="shapes are immutable"):
            change()
    assert copy.copy(BALL) is BALL
    assert copy.deepcopy([BALL])[0] is BALL


def test_repr_is_short():
    assert repr(BALL) == "<Shape sphere, 1 node>"
    assert repr(BALL | CUBE) == "<Shape union, 3 nodes>"


def test_shared_parts_are_counted_once():
    assert repr((BALL | CUBE) - BALL) == "<Shape difference, 4 nodes>"


@pytest.mark.parametrize(
    ("operator", "method", "function"),
    [
        (lambda a, b: a | b, om.Shape.union, om.union),
        (lambda a, b: a & b, om.Shape.intersection, om.intersection),
        (lambda a, b: a - b, om.Shape.difference, om.difference),
    ],
    ids=["union", "intersection", "difference"],
)
def test_operator_method_and_function_agree(operator, method, function):
    assert operator(BALL, CUBE) == method(BALL, CUBE) == function(BALL, CUBE)
    assert method(BALL, CUBE, om.plane(), smooth=0.25) == function(BALL, CUBE, om.plane(), smooth=0.25)
    assert function(BALL, CUBE, smooth=0.25) != function(BALL, CUBE)


@pytest.mark.parametrize("other", [1, None, "a", np.ones(3)], ids=str)
def test_operators_take_shapes_only(other):
    for operation in (lambda: BALL | other, lambda: other | BALL, lambda: BALL & other, lambda: BALL - other):
        with pytest.raises(TypeError):
            operation()
    with pytest.raises(TypeError, match=r"shapes must be om\.Shape, got"):
        BALL.union(other)


def test_translate_takes_numbers_or_a_vector():
    moved = BALL.translate(1, 2, 3)
    assert moved == BALL.translate((1, 2, 3)) == BALL.translate(np.array([1, 2, 3])) == BALL.translate(x=1, y=2, z=3)
    assert BALL.translate(np.float32(1)) == BALL.translate(1)
    with pytest.raises(TypeError, match=r"x must be .* or a vector alone, got \(\(1, 2, 3\), 4, 0.0\)"):
        BALL.translate((1, 2, 3), 4)
    assert om.sphere(1.0, center=(1, 2, 3)) == moved


@pytest.mark.parametrize(
    "build",
    [
        om.sphere,
        lambda r, center: om.cylinder(r, 1.0, "y", center),
        lambda r, center: om.torus(r, 0.1, "y", center),
        om.box,
    ],
)
def test_center_is_a_translation(build):
    here, there = build(1.0, center=(0, 0, 0)), build(1.0, center=(0, 2, 0))
    assert there == here.translate(0, 2, 0)


def test_axis_is_a_letter_or_a_vector():
    assert om.cylinder(1.0, axis="z") == om.cylinder(1.0, axis=(0, 0, 5))
    assert BALL.rotate(30, "x") == BALL.rotate(30, (1, 0, 0))


def test_repeat_spellings():
    row = BALL.repeat((4, None, None), counts=(3, None, None))
    assert row == BALL.repeat((4, 0, 0), counts=(3, 0, 0))
    assert CUBE.repeat(4) == CUBE.repeat((4, 4, 4))
    assert CUBE.repeat(4, 3) == CUBE.repeat((4, 4, 4), (3, 3, 3))


def test_bounds_are_arrays():
    lo, hi = om.box((2, 4, 6)).bounds()
    assert lo.tolist() == [-1, -2, -3]
    assert hi.tolist() == [1, 2, 3]
    assert np.isinf(om.plane().bounds()[1][0])


def test_long_chains_neither_overflow_nor_crawl():
    """A hundred thousand operators, each on the result of the one before."""
    chain = BALL
    for i in range(50_000):
        chain = (chain | om.sphere(0.5, center=(i, 0, 0))) if i % 2 else chain.translate(0.001, 0, 0)
    assert "Shape" in repr(chain)
    assert hash(chain) == hash(chain.translate(0, 0, 0))
    assert len({chain, BALL}) == 2


def test_shapes_are_made_by_functions():
    with pytest.raises(TypeError, match="shapes are made by"):
        om.Shape(1.0)


# Queries --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(3,), (0, 3), (1, 3), (5, 3), (2, 3, 3), (2, 0, 3)], ids=str)
@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_queries_keep_the_shape_of_points(shape, precision):
    points = np.arange(np.prod(shape), dtype=float).reshape(shape) + 2
    distance = BALL.distance(points, precision=precision)
    assert distance.shape == shape[:-1]
    assert distance.dtype == precision
    assert_allclose(distance, np.linalg.norm(points, axis=-1) - 1, rtol=1e-6)
    gradient = BALL.gradient(points, precision=precision)
    assert gradient.shape == shape
    assert gradient.dtype == precision


def test_queries_take_any_layout_of_real_numbers():
    points = np.array([[3, 0, 0], [0, 4, 0], [0, 0, 5]])
    expected = BALL.distance(points)
    for same in (
        points.tolist(),
        points.astype(np.float16),
        np.asfortranarray(points),
        points[::-1][::-1],
        points.astype(">f8"),
    ):
        assert_array_equal(BALL.distance(same), expected)


def test_nan_points_give_nan():
    distances = BALL.distance([[2, 0, 0], [NAN, 0, 0], [0, 3, 0]])
    assert_array_equal(distances, [1, NAN, 2])


@pytest.mark.parametrize(
    ("points", "error"),
    [
        ([1, 2], ValueError),
        (np.ones((3, 4)), ValueError),
        (1.0, ValueError),
        ([[1, 2, 3], [1, 2]], ValueError),
        (np.ones((2, 3), complex), TypeError),
        (np.ones((2, 3), object), TypeError),
        (np.ones((2, 3), bool), TypeError),
        ([["a", "b", "c"]], TypeError),
        (None, TypeError),
    ],
)
def test_bad_points_are_refused(points, error):
    with pytest.raises(error, match=r"^points must"):
        BALL.distance(points)
    with pytest.raises(error, match=r"^points must"):
        BALL.gradient(points)
    with pytest.raises(error, match=r"^origins must"):
        BALL.raycast(points, [0, 0, 1])
    with pytest.raises(error, match=r"^directions must"):
        BALL.raycast([0, 0, 3], points)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"precision": "float16"}, ValueError, "precision must be one of 'float32', 'float64', got 'float16'"),
        ({"precision": np.float32}, TypeError, "precision"),
        ({"threads": 0}, ValueError, "threads must lie in"),
        ({"threads": 1.5}, TypeError, "threads must be an integer, got 1.5"),
        ({"isa": "mmx"}, ValueError, "isa.*scalar.*mmx"),
        ({"isa": ""}, ValueError, "isa"),
        ({"isa": 2}, TypeError, "isa must be a name or None, got 2"),
    ],
)
def test_bad_options_are_refused(options, error, message):
    for query in (BALL.distance, BALL.gradient, lambda p, **o: BALL.raycast(p, p, **o)):
        with pytest.raises(error, match=message):
            query([0, 0, 3], **options)
