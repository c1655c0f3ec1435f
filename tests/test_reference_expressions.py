"""The reference's expressions, and the shapes made of them, against numpy."""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]
Function = Callable[..., Any]

ROUNDING = 1e-13  # of float64 for numbers of a few units and some dozen operations
ROUNDING32 = 4e-6  # the same for float32
ULPS = 8 * 2.0**-52  # between two libraries' transcendental functions, relative
X, Y, Z = om.coordinates()
POINTS = np.random.default_rng(5).normal(scale=2, size=(300, 3))
EXACT = np.array(list(itertools.product((-2.5, -1.0, 0.0, 0.5, 3.0), repeat=3)))


def value(expression: om.Expression, points: Array, dtype: str = "float64") -> Array:
    return om.reference.distance(om.field(expression, lipschitz=1), points, dtype)


def exact(function: Function, points: Array) -> Array:
    with np.errstate(all="ignore"):
        return np.asarray(function(points.T), np.float64)


# Operations that every machine rounds alike, and their definitions: no tolerance.
OPERATIONS: dict[str, tuple[int, Function, Function]] = {
    "add": (2, lambda a, b: a + b, np.add),
    "subtract": (2, lambda a, b: a - b, np.subtract),
    "multiply": (2, lambda a, b: a * b, np.multiply),
    "divide": (2, lambda a, b: a / b, np.divide),
    "mod": (2, om.mod, lambda a, b: a - b * np.floor(a / b)),
    "minimum": (2, om.minimum, lambda a, b: np.where(a < b, a, b)),
    "maximum": (2, om.maximum, lambda a, b: np.where(a > b, a, b)),
    "less": (2, lambda a, b: om.where(a < b, 1.0, 0.0), lambda a, b: np.where(a < b, 1.0, 0.0)),
    "less_equal": (2, lambda a, b: om.where(a <= b, 1.0, 0.0), lambda a, b: np.where(a <= b, 1.0, 0.0)),
    "where": (3, om.where, lambda c, a, b: np.where(c != 0, a, b)),
    "negate": (1, lambda a: -a, np.negative),
    "abs": (1, abs, np.abs),
    "sqrt": (1, om.sqrt, np.sqrt),
    "floor": (1, om.floor, np.floor),
}


def operations(operands: st.SearchStrategy[tuple[Any, Function]]) -> st.SearchStrategy[tuple[Any, Function]]:
    def applied(name: str, chosen: list[tuple[Any, Function]]) -> tuple[Any, Function]:
        count, build, define = OPERATIONS[name]
        parts = chosen[:count]
        return build(*(part[0] for part in parts)), lambda p: define(*(part[1](p) for part in parts))

    return st.builds(applied, st.sampled_from(sorted(OPERATIONS)), st.lists(operands, min_size=3, max_size=3))


LEAVES: list[tuple[Any, Function]] = [
    (X, lambda p: p[0]),
    (Y, lambda p: p[1]),
    (Z, lambda p: p[2]),
    (X + 0.75, lambda p: p[0] + 0.75),
    (2.5 * Y, lambda p: 2.5 * p[1]),
]


@given(st.recursive(st.sampled_from(LEAVES), operations, max_leaves=30))
def test_arithmetic_is_exactly_that_of_numpy(case: tuple[om.Expression, Function]):
    expression, function = case
    for points in (POINTS, EXACT):
        assert_array_equal(value(expression, points), exact(function, points))


FUNCTIONS: dict[str, tuple[om.Expression, Function]] = {
    "exp": (om.exp(X), lambda p: np.exp(p[0])),
    "log": (om.log(X), lambda p: np.log(p[0])),
    "sin": (om.sin(X), lambda p: np.sin(p[0])),
    "cos": (om.cos(X), lambda p: np.cos(p[0])),
    "tan": (om.tan(X), lambda p: np.tan(p[0])),
    "asin": (om.asin(X), lambda p: np.arcsin(p[0])),
    "acos": (om.acos(X), lambda p: np.arccos(p[0])),
    "atan": (om.atan(X), lambda p: np.arctan(p[0])),
    "atan2": (om.atan2(X, Y), lambda p: np.arctan2(p[0], p[1])),
    "pow": (om.power(X, Y), lambda p: np.power(p[0], p[1])),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_those_of_numpy_but_for_their_last_bits(name: str):
    expression, function = FUNCTIONS[name]
    points = np.concatenate([POINTS, EXACT])
    assert_allclose(value(expression, points), exact(function, points), rtol=ULPS, atol=0)


SLOPES: dict[str, om.Expression] = {
    **{name: expression for name, (expression, _) in FUNCTIONS.items()},
    "product": X * Y * Z,
    "quotient": X / (2 + Y * Y),
    "root": om.sqrt(X * X + Y * Y),
    "kinks": om.minimum(abs(X), om.maximum(Y, Z)) + om.where(X < Y, Z, 2 * X) + om.floor(3 * Z),
    "mod": om.mod(X, 1 + Y * Y),
    "noise": om.noise(2 * X, Y + X, Z * X, seed=3),
}
STEP = 1e-6  # of central differences: its square times a third derivative is below 1e-9
SMOOTH = 1e-9  # second differences above this are those of kinks, or of functions too steep for the step


@pytest.mark.parametrize("name", SLOPES)
def test_gradients_are_limits_of_differences(name: str):
    shape = om.field(SLOPES[name], lipschitz=1)
    ahead, behind = (
        np.stack([om.reference.distance(shape, POINTS + step * axis) for axis in np.eye(3)], -1)
        for step in (STEP, -STEP)
    )
    here = om.reference.distance(shape, POINTS)[:, None]
    with np.errstate(invalid="ignore"):
        smooth = (np.abs(ahead + behind - 2 * here) < SMOOTH).all(axis=1)
    assert smooth.sum() > 50
    found = om.reference.gradient(shape, POINTS)
    assert_allclose(found[smooth], ((ahead - behind) / (2 * STEP))[smooth], rtol=1e-6, atol=1e-8)


def test_depth_has_no_limit_and_shared_parts_are_evaluated_once():
    deep, shared = X, X
    for _ in range(50_000):
        deep = deep + 0.25
    for _ in range(60):  # unfolds to 2**60 coordinates
        shared = 0.5 * shared + 0.5 * shared
    assert value(deep, np.array([[1.0, 0, 0]])) == 12_501
    assert value(shared, np.array([[0.75, 0, 0]])) == 0.75


def test_gradients_where_there_is_none_are_those_of_a_side_or_zero():
    def slope(expression: om.Expression, point: tuple[float, ...]) -> list[float]:
        return om.reference.gradient(om.field(expression, lipschitz=1), point).tolist()

    assert slope(abs(X), (0, 0, 0)) == [1, 0, 0]
    assert slope(om.minimum(X, 0.0 * Y), (0, 1, 0)) == [1, 0, 0]
    assert slope(om.maximum(0.0 * Y, X), (0, 1, 0)) == [1, 0, 0]
    assert slope(om.sqrt(X * X + Y * Y), (0, 0, 1)) == [0, 0, 0]
    assert slope(om.floor(X), (0.5, 0, 0)) == [0, 0, 0]


# Noise and images -----------------------------------------------------------------------------------------------------

# The directions to the middles of a cube's edges, in the order of the hash.
EDGES = np.array([np.insert([s, t], gap, 0) for gap in (2, 1, 0) for s, t in itertools.product((1, -1), repeat=2)])


def noise(p: Array, seed: int) -> Array:
    """Perlin's gradient noise of 2002 over a lattice hashed by permutation polynomials mod 289, in whole numbers."""

    def permuted(a: NDArray[np.int64]) -> NDArray[np.int64]:
        return (34 * (a % 289) + 1) * (a % 289) % 289

    cell = np.floor(p).astype(np.int64)
    inside = p - cell
    fade = 6 * inside**5 - 15 * inside**4 + 10 * inside**3
    total = np.zeros(len(p))
    for corner in itertools.product((0, 1), repeat=3):
        i, j, k = (cell + corner).T
        slope = EDGES[permuted(permuted(permuted(k + seed) + j) + i) % 12]
        weight = np.where(corner, fade, 1 - fade).prod(axis=1)
        total += weight * (slope * (inside - corner)).sum(axis=1)
    return total


@pytest.mark.parametrize("seed", [0, 1, 288, 1000])
def test_noise_is_that_of_the_definition(seed: int):
    points = np.random.default_rng(seed).normal(scale=200, size=(2000, 3)).astype(np.float32).astype(np.float64)
    expression, expected = om.noise(X, Y, Z, seed=seed), noise(points, seed * 179 % 289)  # seeds are spread out
    assert_allclose(value(expression, points), expected, rtol=0, atol=ROUNDING)
    assert_allclose(value(expression, points, "float32"), expected, rtol=0, atol=ROUNDING32)
    assert_array_equal(value(expression, np.floor(points)), 0)
    assert np.abs(expected).max() > 0.7


def test_noise_far_away_is_a_number():
    far = [[1e9, 0.5, 0], [-1e30, 3e38, 0.5]]
    for dtype in ("float32", "float64"):
        assert np.isfinite(value(om.noise(X, Y, Z), np.array(far), dtype)).all()


def bilinear(image: Array, u: Array, v: Array, repeats: tuple[bool, bool]) -> Array:
    height, width = image.shape
    at = [u * width - 0.5, (1 - v) * height - 0.5]
    first = [np.floor(a).astype(int) for a in at]
    s, t = (a - i for a, i in zip(at, first, strict=True))

    def texel(across: int, down: int) -> Array:
        i, j = first[0] + across, first[1] + down
        i = i % width if repeats[0] else np.clip(i, 0, width - 1)
        j = j % height if repeats[1] else np.clip(j, 0, height - 1)
        return image[j, i]

    upper = texel(0, 0) * (1 - s) + texel(1, 0) * s
    lower = texel(0, 1) * (1 - s) + texel(1, 1) * s
    return upper * (1 - t) + lower * t


@pytest.mark.parametrize("wrap", ["repeat", "clamp"])
def test_images_are_looked_up_bilinearly(wrap: str):
    pixels = np.random.default_rng(2).random((3, 4, 3)).astype(np.float32)
    texture = om.image_texture(pixels, "planar", size=(2, 1.5), wrap=wrap)
    u, v = POINTS[:, 0] / 2 + 0.5, POINTS[:, 1] / 1.5 + 0.5
    for channel, component in enumerate(texture.components):
        expected = bilinear(pixels[..., channel].astype(float), u, v, (wrap == "repeat",) * 2)
        assert_allclose(value(component, POINTS), expected, rtol=0, atol=ROUNDING)


def test_images_around_a_ball_repeat_along_the_equator_only():
    pixels = np.random.default_rng(2).random((3, 4, 3)).astype(np.float32)
    red = om.image_texture(pixels, "spherical").components[0]
    r = np.linalg.norm(POINTS, axis=1)
    u = np.arctan2(POINTS[:, 0], POINTS[:, 2]) / (2 * np.pi) + 0.5
    v = np.arcsin(POINTS[:, 1] / r) / np.pi + 0.5
    expected = bilinear(pixels[..., 0].astype(float), u, v, (True, False))
    assert_allclose(value(red, POINTS), expected, rtol=0, atol=1e-12)  # asin near the poles


# Shapes of expressions ------------------------------------------------------------------------------------------------


def test_a_field_with_bounds_is_cut_there_and_looked_at_inside_only():
    shape = om.field(X * X + om.sin(Y) - 0.5, lipschitz=4, bounds=((-1, -0.5, -2), (1.5, 1, 3)))
    lo, hi = np.array([-1, -0.5, -2]), np.array([1.5, 1, 3])
    inside = np.clip(POINTS, lo, hi)
    excess = np.maximum(lo - POINTS, POINTS - hi)
    box = np.linalg.norm(np.maximum(excess, 0), axis=1) + np.minimum(excess.max(axis=1), 0)
    expected = np.maximum(inside[:, 0] ** 2 + np.sin(inside[:, 1]) - 0.5, 4 * box)
    assert_allclose(om.reference.distance(shape, POINTS), expected, rtol=0, atol=ROUNDING)


def test_a_field_is_asked_in_its_own_coordinates():
    turned = om.field(X + 2 * Y, lipschitz=3).scale(2).rotate(90, "z").translate(0, 0, 1)
    assert_allclose(om.reference.distance(turned, POINTS), POINTS[:, 1] - 2 * POINTS[:, 0], rtol=0, atol=ROUNDING)


def test_a_field_that_is_no_number_ends_the_ray():
    for shape in (om.field(om.sqrt(X), 1), om.field(om.sqrt(X), 1, bounds=((-2, -2, -2), (2, 2, 2)))):
        assert om.reference.raycast(shape, [-1, 0, 0], [0, 1, 0]).status == om.Status.INVALID


def test_displacement_adds_an_expression_of_the_shapes_own_coordinates():
    shape = om.sphere(1.0).displace(0.25 * X * Y, lipschitz=1).translate(1, 0, 0)
    p = POINTS - [1, 0, 0]
    expected = np.linalg.norm(p, axis=1) - 1 + 0.25 * p[:, 0] * p[:, 1]
    assert_allclose(om.reference.distance(shape, POINTS), expected, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_solid_knows_its_inside_and_nothing_else_at_any_scale(dtype: str):
    ball = om.solid(X * X + Y * Y + Z * Z <= 1)
    least = np.finfo(np.float32).tiny
    for shape in (ball, ball.scale(2).scale(0.5), ball.scale(0.5).scale(2)):
        inside = np.linalg.norm(POINTS, axis=1) <= 1
        assert_array_equal(om.reference.distance(shape, POINTS, dtype), np.where(inside, -least, least))
        assert_array_equal(om.reference.gradient(shape, POINTS, dtype), 0)
