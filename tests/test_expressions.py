"""Expressions: Python's operators and functions on them, and what comes out against numpy and the scalar reference."""

import copy
import math
import operator

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_array_equal

import octomarch as om
from expression_strategies import Sample, expression
from rounding import representable, unit_roundoff
from strategies import POINTS

X, Y, Z = om.coordinates()
NAN, INF = math.nan, math.inf

LATTICE = np.array([(x, y, z) for x in (-2, -0.5, 0, 1, 3) for y in (-1, 0, 0.25, 2) for z in (0, 1)], dtype=float)

# Values ---------------------------------------------------------------------------------------------------------------


@given(sample=expression())
def test_random_expressions_are_what_numpy_says(isa: str, precision: str, sample: Sample):
    points = representable(POINTS, precision)
    expected = sample.at(points, unit_roundoff(precision))
    found = sample.expression.evaluate(points, precision=precision, isa=isa)
    check(found, expected, points, sample)


@given(sample=expression())
def test_reference_is_what_numpy_says(precision: str, sample: Sample):
    points = representable(POINTS, precision)
    expected = sample.at(points, unit_roundoff(precision))
    shape = om.field(sample.expression, lipschitz=1)
    check(om.reference.distance(shape, points, dtype=precision), expected, points, sample)


def check(found, expected, points, sample: Sample) -> None:
    known = np.isfinite(expected.error)
    off = np.abs(found[known] - expected.value[known])
    allowed = 2 * expected.u * expected.error[known]
    wrong = ~(off <= allowed) & ~(np.isnan(found[known]) & np.isnan(expected.value[known]))
    assert not wrong.any(), (
        sample.text,
        points[known][wrong][0],
        found[known][wrong][0],
        expected.value[known][wrong][0],
    )


@given(sample=expression())
def test_every_isa_gives_the_same_bits(precision: str, sample: Sample):
    points = np.concatenate([POINTS, LATTICE])
    first, *others = (sample.expression.evaluate(points, precision=precision, isa=isa) for isa in om.isas())
    for other in others:
        assert_array_equal(other, first)
        assert_array_equal(np.signbit(other[~np.isnan(other)]), np.signbit(first[~np.isnan(first)]))


@given(sample=expression())
def test_gradients_have_the_same_bits_on_every_isa(precision: str, sample: Sample):
    shape = om.field(sample.expression, lipschitz=1)
    first, *others = (shape.gradient(POINTS, precision=precision, isa=isa) for isa in om.isas())
    for other in others:
        assert_array_equal(other, first)


SMOOTH = ("add", "subtract", "multiply", "sin", "cos", "atan", "negate", "minimum", "maximum", "abs")


@given(sample=expression(8, SMOOTH))
def test_gradients_are_those_of_the_reference(isa: str, sample: Sample):
    """Smooth operations and kinks. Generic points: on a kink either side may be taken."""
    shape, points = om.field(sample.expression, lipschitz=1), POINTS[:120]
    truth = om.reference.gradient(shape, points)
    found = shape.gradient(points, isa=isa)
    scale = 1 + np.abs(truth).max(axis=1, keepdims=True) + np.abs(om.reference.distance(shape, points))[:, None]
    settled = np.isfinite(scale[:, 0]) & (scale[:, 0] < 1e6)
    # eight operations, each of which may multiply an error by what it multiplies the gradient with
    assert (np.abs(found - truth) <= 1e-6 * scale**2)[settled].mean() > 0.99


CASES = {
    "add": (X + Y, lambda x, y, z: x + y),
    "radd": (2 + X, lambda x, y, z: 2 + x),
    "subtract": (X - 3, lambda x, y, z: x - 3),
    "rsubtract": (3 - X, lambda x, y, z: 3 - x),
    "multiply": (X * Y, lambda x, y, z: x * y),
    "divide": (X / 2, lambda x, y, z: x / 2),
    "rdivide": (1 / (Y + 0.5), lambda x, y, z: 1 / (y + 0.5)),
    "floor divide": (X // 2, lambda x, y, z: x // 2),
    "rfloor divide": (3 // (Y + 0.5), lambda x, y, z: 3 // (y + 0.5)),
    "mod": (X % 2, lambda x, y, z: x % 2),
    "mod of a negative divisor": (X % -2, lambda x, y, z: x % -2),
    "rmod": (3 % (Y + 4), lambda x, y, z: 3 % (y + 4)),
    "square": (X**2, lambda x, y, z: x**2),
    "cube": (X**3, lambda x, y, z: x**3),
    "inverse square": ((Y + 4) ** -2, lambda x, y, z: 1 / (y + 4) ** 2),
    "to the power of 0": (X**0, lambda x, y, z: np.ones_like(x)),
    "negate": (-X, lambda x, y, z: -x),
    "plus": (+X, lambda x, y, z: x),
    "abs": (abs(X), lambda x, y, z: abs(x)),
    "less": (X < Y, lambda x, y, z: x < y),
    "less or equal": (X <= Y, lambda x, y, z: x <= y),
    "greater": (X > Y, lambda x, y, z: x > y),
    "greater or equal": (X >= Y, lambda x, y, z: x >= y),
    "number first": (1 > X, lambda x, y, z: x < 1),  # noqa: SIM300
    "and": ((X < 1) & (Y > 0), lambda x, y, z: (x < 1) & (y > 0)),
    "or": ((X < 1) | (Y > 0), lambda x, y, z: (x < 1) | (y > 0)),
    "not": (~(X < 1), lambda x, y, z: ~(x < 1)),
    "any number is true": (X & True, lambda x, y, z: x != 0),
    "and of numbers": (-X & Y, lambda x, y, z: (x != 0) & (y != 0)),
    "not of a number": (~X, lambda x, y, z: x == 0),
    "or with False": (False | X, lambda x, y, z: x != 0),
    "equal": (om.equal(X, 1), lambda x, y, z: x == 1),
    "sign": (om.sign(X), lambda x, y, z: np.sign(x)),
    "floor": (om.floor(X), lambda x, y, z: np.floor(x)),
    "ceil": (om.ceil(X), lambda x, y, z: np.ceil(x)),
    "fract": (om.fract(X), lambda x, y, z: x - np.floor(x)),
    "minimum": (om.minimum(X, Y, 0.5), lambda x, y, z: np.minimum(np.minimum(x, y), 0.5)),
    "maximum": (om.maximum(X, Y), lambda x, y, z: np.maximum(x, y)),
    "clamp": (om.clamp(X, 0, 1), lambda x, y, z: np.clip(x, 0, 1)),
    "mix": (om.mix(X, Y, 0.25), lambda x, y, z: 0.75 * x + 0.25 * y),
    "where": (om.where(X < 0, Y, Z), lambda x, y, z: np.where(x < 0, y, z)),
    "where of a number": (om.where(X, 1, 2), lambda x, y, z: np.where(x != 0, 1, 2)),
    "dot": (om.dot((X, Y, Z), (1, 2, 4)), lambda x, y, z: x + 2 * y + 4 * z),
    "absolute": (om.absolute(X), lambda x, y, z: abs(x)),
    "smoothstep": (om.smoothstep(0, 4, X), lambda x, y, z: np.clip(x / 4, 0, 1) ** 2 * (3 - 2 * np.clip(x / 4, 0, 1))),
    "square of numpy": (np.square(X), lambda x, y, z: x * x),
}


@pytest.mark.parametrize("name", CASES)
def test_operations_are_exact_where_numbers_are(name: str, isa: str, precision: str):
    """On a lattice of small powers of two no operation rounds, but for the divisions, which round alike."""
    found, expected = CASES[name]
    values = expected(*LATTICE.astype(precision).T)
    assert_array_equal(found.evaluate(LATTICE, precision=precision, isa=isa), values.astype(precision))


FUNCTIONS = {
    "exp": (om.exp(X), lambda x, y, z: np.exp(x)),
    "log": (om.log(Y + 2), lambda x, y, z: np.log(y + 2)),
    "sin": (om.sin(X), lambda x, y, z: np.sin(x)),
    "cos": (om.cos(X), lambda x, y, z: np.cos(x)),
    "tan": (om.tan(X), lambda x, y, z: np.tan(x)),
    "asin": (om.asin(X / 4), lambda x, y, z: np.arcsin(x / 4)),
    "acos": (om.acos(X / 4), lambda x, y, z: np.arccos(x / 4)),
    "atan": (om.atan(X), lambda x, y, z: np.arctan(x)),
    "atan2": (om.atan2(X, Y), lambda x, y, z: np.arctan2(x, y)),
    "sqrt": (om.sqrt(Y + 2), lambda x, y, z: np.sqrt(y + 2)),
    "power": (om.power(Y + 2, X), lambda x, y, z: (y + 2) ** x),
    "power of a number": (2**X, lambda x, y, z: 2.0**x),
    "broken power": ((Y + 2) ** 1.5, lambda x, y, z: (y + 2) ** 1.5),
    "length": (om.length(X, Y, Z), lambda x, y, z: np.sqrt(x * x + y * y + z * z)),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_those_of_numpy(name: str, isa: str, precision: str):
    found, expected = FUNCTIONS[name]
    values = found.evaluate(LATTICE, precision=precision, isa=isa)
    # arguments are exact; 4 units in the last place are more than ops/math.hpp allows itself
    np.testing.assert_array_max_ulp(values, expected(*LATTICE.T).astype(precision), 4)


def test_points_of_any_shape():
    assert X.evaluate(np.zeros((2, 4, 3))).shape == (2, 4)
    assert X.evaluate([1, 2, 3]).shape == ()
    assert X.evaluate([1, 2, 3], precision="float32").dtype == np.float32
    assert np.isnan((0 * X).evaluate([NAN, 0, 0]))


# Size -----------------------------------------------------------------------------------------------------------------


def long_expression() -> tuple[om.Expression, np.ndarray]:
    """Return a thousand operations that none of them can be spared, and their values at `POINTS`."""
    e, (x, y, z) = X, POINTS.T
    values = x
    for i in range(250):
        e = om.sin(e * (1.5 - i / 512) + (Y, Z)[i % 2]) * 0.75
        values = np.sin(values * (1.5 - i / 512) + (y, z)[i % 2]) * 0.75
    return e, values


def test_a_thousand_operations_are_as_many_instructions(isa: str):
    e, values = long_expression()
    program = om.compile(om.field(e, lipschitz=1))
    assert program.instructions == 1000
    assert program.registers <= 5
    # an error grows by at most 1.5 · 0.75 at each of 250 turns near the end, and shrinks before
    assert np.abs(e.evaluate(POINTS, isa=isa) - values).max() < 1e-8


def test_shared_parts_are_computed_once():
    e = X
    for _ in range(100):
        e = e * e + Y
    assert om.compile(om.field(e, lipschitz=1)).instructions == 200


def test_chains_of_any_length():
    e = X
    for i in range(50_000):
        e = om.sin(e) if i % 2 else e + Y
    assert np.isfinite(om.field(e, bounds=((-1,) * 3, (1,) * 3)).distance([0.5, 0.5, 0.5]))
    assert "50003 nodes" in repr(om.sin(e))


# The algebra ----------------------------------------------------------------------------------------------------------


def test_equal_expressions_are_equal_and_hash_alike():
    assert om.coordinates()[0] + 1.0 == X + 1
    assert hash(X + 1) == hash(om.coordinates()[0] + 1.0)
    assert X + 1 != 1 + X
    assert len({X, Y, X * 1, om.coordinates()[0]}) == 3
    assert X != 1.0
    assert 1.0 != X  # noqa: SIM300
    assert np.float64(1) != X
    assert X is not None


def test_expressions_are_immutable():
    for change in (lambda: setattr(X, "_node", Y._node), lambda: delattr(X, "_node"), lambda: setattr(X, "a", 1)):
        with pytest.raises(AttributeError, match="expressions are immutable"):
            change()
    assert copy.copy(X) is X
    assert copy.deepcopy([X])[0] is X


def test_repr_is_short():
    assert repr(X) == "<Expression coordinate, 1 node>"
    assert repr(X * X + 1) == "<Expression add, 4 nodes>"


@pytest.mark.parametrize(
    ("ufunc", "function"),
    [
        (np.sqrt, om.sqrt),
        (np.exp, om.exp),
        (np.log, om.log),
        (np.sin, om.sin),
        (np.cos, om.cos),
        (np.tan, om.tan),
        (np.arcsin, om.asin),
        (np.arccos, om.acos),
        (np.arctan, om.atan),
        (np.floor, om.floor),
        (np.ceil, om.ceil),
        (np.abs, abs),
        (np.fabs, abs),
        (np.negative, operator.neg),
        (np.positive, operator.pos),
        (np.square, lambda x: x**2),
        (np.reciprocal, lambda x: 1 / x),
        (np.logical_not, operator.invert),
        (np.invert, operator.invert),
    ],
    ids=lambda f: f.__name__,
)
def test_functions_of_numpy(ufunc, function):
    assert ufunc(X) == function(X)


@pytest.mark.parametrize(
    ("ufunc", "function"),
    [
        (np.add, operator.add),
        (np.subtract, operator.sub),
        (np.multiply, operator.mul),
        (np.divide, operator.truediv),
        (np.floor_divide, operator.floordiv),
        (np.mod, operator.mod),
        (np.power, operator.pow),
        (np.minimum, om.minimum),
        (np.maximum, om.maximum),
        (np.arctan2, om.atan2),
        (np.hypot, om.length),
        (np.less, operator.lt),
        (np.less_equal, operator.le),
        (np.greater, operator.gt),
        (np.greater_equal, operator.ge),
    ],
    ids=lambda f: f.__name__,
)
def test_functions_of_two_numbers_of_numpy(ufunc, function):
    assert ufunc(X, Y) == function(X, Y)
    assert ufunc(X, 2) == function(X, 2.0)
    assert ufunc(np.float32(0.5), X) == function(0.5, X)


def test_numpy_scalars_are_numbers():
    assert np.float64(2) * X == X.__rmul__(2) == 2 * X
    assert X - np.int64(3) == X - 3
    assert X + np.array(1.0) == X + 1
    assert (np.float64(1) > X) == (X < 1)


def test_choices_of_numpy():
    assert np.where(X < 0, Y, 2) == om.where(X < 0, Y, 2)
    assert np.clip(X, 0, 1) == om.clamp(X, 0, 1)
    assert np.clip(X, None, Y) == om.minimum(X, Y)
    assert np.clip(X, a_min=0, a_max=None) == om.maximum(X, 0)
    assert (np.equal(X, X), np.equal(X, 1), np.not_equal(X, Y)) == (True, False, True)


def test_functions_take_plain_numbers():
    assert float(om.clamp(3, 0, 1).evaluate([0, 0, 0])) == 1
    assert float(om.mix(1, 3, 0.5).evaluate([0, 0, 0])) == 2
    assert om.sqrt(2) == om.sqrt(2.0)


def test_whole_powers_are_products():
    assert X**2 == X * X
    assert X**5 == X * ((X * X) * (X * X))
    assert X**-1 == 1 / X
    assert X**1 == X
    assert om.power(X, om.minimum(2)) == X * X


# Mistakes -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "use",
    [
        lambda: bool(X < 1),
        lambda: 0 < X < 1,
        lambda: X and Y,
        lambda: not X,
        lambda: min(X, Y),
        lambda: max(X, Y),
        lambda: 1 if X else 2,
        lambda: sorted([X, Y]),
    ],
)
def test_truth_before_there_is_a_point_is_refused(use):
    with pytest.raises(TypeError, match=r"no truth value before it is given a point.*om\.where"):
        use()


@pytest.mark.parametrize("value", ["a", None, 1j, True, [1.0], om.sphere(1), np.ones(3)], ids=str)
@pytest.mark.parametrize(
    ("function", "argument"),
    [
        (om.sqrt, "x"),
        (lambda v: om.atan2(v, X), "y"),
        (lambda v: om.atan2(X, v), "x"),
        (lambda v: om.where(v, X, Y), "condition"),
        (lambda v: om.clamp(X, v, 1), "lo"),
        (lambda v: om.clamp(X, 0, v), "hi"),
        (lambda v: om.mix(X, Y, v), "t"),
        (lambda v: om.smoothstep(v, 1, X), "lo"),
        (lambda v: om.power(v, 2), "base"),
        (lambda v: om.power(X, v), "exponent"),
        (lambda v: om.equal(v, X), "a"),
        (lambda v: om.minimum(X, v), "xs"),
        (lambda v: om.noise(X, v, Z), "y"),
        (lambda v: om.dot((X, v), (1, 2)), "a"),
        (lambda v: om.field(v), "expression"),
        (lambda v: om.solid(v), "condition|expression"),
    ],
)
def test_wrong_types_are_named(function, argument, value):
    with pytest.raises(TypeError, match=f"^({argument})"):
        function(value)


@pytest.mark.parametrize(
    "use",
    [
        lambda v: X + v,
        lambda v: v * X,
        lambda v: X / v,
        lambda v: v > X,
        lambda v: v % X,
        lambda v: X // v,
        lambda v: X**v,
    ],
)
@pytest.mark.parametrize("value", ["a", None, True, [1.0], om.sphere(1), np.ones(3), np.ones((2, 2))], ids=str)
def test_operators_refuse_other_types(use, value):
    with pytest.raises(TypeError):
        use(value)


@pytest.mark.parametrize("use", [lambda v: v & X, lambda v: X | v, lambda v: X & v], ids=["rand", "or", "and"])
@pytest.mark.parametrize("value", [1, 1.0, "a", None, np.ones(3, bool)], ids=str)
def test_and_and_or_take_truth_values_only(use, value):
    """Not numbers: x < 1 & y < 2 reads as x < (1 & y) < 2."""
    with pytest.raises(TypeError):
        use(value)


@pytest.mark.parametrize(
    "use",
    [
        lambda: np.cbrt(X),
        lambda: np.add.reduce(X),
        lambda: np.mean(X),
        lambda: np.sqrt(X, where=True),
        lambda: np.add(X, np.ones(3)),
        lambda: np.where(X),
        lambda: np.linalg.norm(X),
    ],
)
def test_what_numpy_cannot_do_is_a_type_error(use):
    with pytest.raises(TypeError, match=r"np\.|array|unexpected"):
        use()


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda: X + NAN, "must be a number, got nan"),
        (lambda: om.sqrt(NAN), "x must be a number, got nan"),
        (lambda: om.clamp(X, NAN, 1), "lo must be a number, got nan"),
        (lambda: X + 10**400, "must fit a float"),
        (lambda: om.smoothstep(1, 1, X), "hi must differ from lo, got 1"),
        (om.minimum, "xs must be one number or more, got none"),
        (om.length, "xs must be one number or more, got none"),
        (lambda: om.dot((X,), (1, 2)), "equally many components"),
        (lambda: om.noise(X, Y, Z, seed=-1), "seed must lie in"),
        (lambda: om.fractal_noise(X, Y, Z, octaves=0), "octaves must lie in"),
        (lambda: om.field(om.normals()[0], lipschitz=1), "without the normal"),
        (lambda: om.solid(om.normals()[0] > 0), "without the normal"),
        (lambda: om.normals()[0].evaluate([0, 0, 0]), "without the normal"),
        (lambda: om.field(X, lipschitz=-1), "lipschitz must be finite and >= 0, got -1"),
        (lambda: om.field(X, lipschitz=NAN), "lipschitz must be"),
        (lambda: om.field(X, lipschitz=INF), "lipschitz must be"),
        (lambda: om.field(X * X), "lipschitz"),
        (lambda: om.field(X, bounds=((1, 1, 1), (0, 2, 2))), "bounds must be"),
        (lambda: om.field(X, bounds=((NAN, 1, 1), (2, 2, 2))), "bounds must be"),
        (lambda: om.field(X, bounds=((0, 0, 0),)), "bounds must be two corners"),
    ],
)
def test_impossible_values_are_refused(use, message):
    with pytest.raises(ValueError, match=message):
        use()


def test_expressions_are_made_by_functions():
    with pytest.raises(TypeError, match=r"expressions are made by om\.coordinates"):
        om.Expression(1.0)
