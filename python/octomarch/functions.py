"""Functions of expressions: rounding, roots, angles and vectors, as `octomarch.sqrt` and its companions.

Each takes expressions and plain numbers and gives an `expressions.Expression`. A wrong type is a `TypeError`, a number
that is not one a `ValueError`; both name the argument. docs/semantics.md says what exactly each computes. `choices` and
`noises` build on them.
"""

from __future__ import annotations

from collections.abc import Sequence

from octomarch import _core
from octomarch import _validate as check
from octomarch.expressions import Expression, ExpressionLike, apply, operand, raised

# Numbers --------------------------------------------------------------------------------------------------------------


def absolute(x: ExpressionLike) -> Expression:
    """Return x without its sign; ``abs(x)`` does the same.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.absolute(-2).evaluate([0, 0, 0]))
    2.0
    """
    return apply("abs", x)


def sign(x: ExpressionLike) -> Expression:
    """Return -1, 0 or 1.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> om.sign(x).evaluate([[-3, 0, 0], [0, 0, 0], [0.5, 0, 0]]).tolist()
    [-1.0, 0.0, 1.0]
    """
    value = Expression(operand("x", x))
    return (value > 0) - (value < 0)


def floor(x: ExpressionLike) -> Expression:
    """Return the largest whole number ≤ x.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.floor(-0.5).evaluate([0, 0, 0]))
    -1.0
    """
    return apply("floor", x)


def ceil(x: ExpressionLike) -> Expression:
    """Return the smallest whole number ≥ x.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.ceil(0.5).evaluate([0, 0, 0]))
    1.0
    """
    return -apply("floor", -Expression(operand("x", x)))


def fract(x: ExpressionLike) -> Expression:
    """Return ``x - floor(x)``, in [0, 1).

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.fract(-0.25).evaluate([0, 0, 0]))
    0.75
    """
    value = Expression(operand("x", x))
    return value - apply("floor", value)


def mod(x: ExpressionLike, y: ExpressionLike) -> Expression:
    """Return ``x - y * floor(x / y)``, which has the sign of y; ``x % y`` does the same.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.mod(-1, 3).evaluate([0, 0, 0]))
    2.0
    """
    return apply("mod", x, y)


def minimum(*xs: ExpressionLike) -> Expression:
    """Return the smallest of one or more numbers.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.minimum(*om.coordinates()).evaluate([2, -1, 5]))
    -1.0
    """
    return _folded("minimum", xs)


def maximum(*xs: ExpressionLike) -> Expression:
    """Return the largest of one or more numbers.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.maximum(*om.coordinates()).evaluate([2, -1, 5]))
    5.0
    """
    return _folded("maximum", xs)


def clamp(x: ExpressionLike, lo: ExpressionLike, hi: ExpressionLike) -> Expression:
    """Return x, held between lo and hi: ``minimum(maximum(x, lo), hi)``.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.clamp(3, 0, 1).evaluate([0, 0, 0]))
    1.0
    """
    return apply("minimum", apply("maximum", x, lo, names=("x", "lo")), hi, names=("x", "hi"))


# Roots, powers, angles ------------------------------------------------------------------------------------------------


def sqrt(x: ExpressionLike) -> Expression:
    """Return the square root; numbers below 0 have none.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.sqrt(9).evaluate([0, 0, 0]))
    3.0
    """
    return apply("sqrt", x)


def power(base: ExpressionLike, exponent: ExpressionLike) -> Expression:
    """Return ``base ** exponent``.

    A whole number of at most ±64 as exponent makes products; any other takes logarithms, where a base below 0 has
    powers with whole exponents only.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.power(-2, 3).evaluate([0, 0, 0]))
    -8.0
    """
    return raised(base, exponent)


def exp(x: ExpressionLike) -> Expression:
    """Return e raised to x.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.exp(0).evaluate([0, 0, 0]))
    1.0
    """
    return apply("exp", x)


def log(x: ExpressionLike) -> Expression:
    """Return the natural logarithm.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.log(1).evaluate([0, 0, 0]))
    0.0
    """
    return apply("log", x)


def sin(x: ExpressionLike) -> Expression:
    """Return the sine of an angle in radians.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.sin(0).evaluate([0, 0, 0]))
    0.0
    """
    return apply("sin", x)


def cos(x: ExpressionLike) -> Expression:
    """Return the cosine of an angle in radians.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.cos(0).evaluate([0, 0, 0]))
    1.0
    """
    return apply("cos", x)


def tan(x: ExpressionLike) -> Expression:
    """Return the tangent of an angle in radians.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.tan(0).evaluate([0, 0, 0]))
    0.0
    """
    return apply("tan", x)


def asin(x: ExpressionLike) -> Expression:
    """Return the angle in [-π/2, π/2] whose sine is x, in radians.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.asin(0).evaluate([0, 0, 0]))
    0.0
    """
    return apply("asin", x)


def acos(x: ExpressionLike) -> Expression:
    """Return the angle in [0, π] whose cosine is x, in radians.

    Examples
    --------
    >>> import octomarch as om
    >>> round(float(om.acos(-1).evaluate([0, 0, 0])), 6)
    3.141593
    """
    return apply("acos", x)


def atan(x: ExpressionLike) -> Expression:
    """Return the angle in [-π/2, π/2] whose tangent is x, in radians.

    Examples
    --------
    >>> import octomarch as om
    >>> round(float(om.atan(1).evaluate([0, 0, 0])), 6)
    0.785398
    """
    return apply("atan", x)


def atan2(y: ExpressionLike, x: ExpressionLike) -> Expression:
    """Return the angle in [-π, π] of the point (x, y), in radians; 0 at the origin.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> round(float(om.atan2(y, x).evaluate([-1, 1, 0])), 6)
    2.356194
    """
    return apply("atan2", y, x, names=("y", "x"))


# Vectors --------------------------------------------------------------------------------------------------------------


def length(*xs: ExpressionLike) -> Expression:
    """Return the Euclidean length of a vector of one or more components.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.length(*om.coordinates()).evaluate([2, 3, 6]))
    7.0
    """
    if not xs:
        raise ValueError("xs must be one number or more, got none")
    return apply("sqrt", dot(xs, xs))


def dot(a: Sequence[ExpressionLike], b: Sequence[ExpressionLike]) -> Expression:
    """Return the sum of the products of two vectors' components.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.dot(om.coordinates(), (1, 10, 100)).evaluate([1, 2, 3]))
    321.0
    """
    left = [operand(f"a[{i}]", value) for i, value in enumerate(check.sequence("a", a, "a sequence of numbers"))]
    right = [operand(f"b[{i}]", value) for i, value in enumerate(check.sequence("b", b, "a sequence of numbers"))]
    if len(left) != len(right) or not left:
        raise ValueError(f"a and b must have equally many components, at least one, got {len(left)} and {len(right)}")
    products = [_core.expression("multiply", [u, v]) for u, v in zip(left, right, strict=True)]
    return _folded("add", [Expression(product) for product in products])


def _folded(kind: str, xs: Sequence[ExpressionLike]) -> Expression:
    """Return an operation over all numbers, from the left."""
    if not xs:
        raise ValueError("xs must be one number or more, got none")
    nodes = [operand(f"xs[{i}]", x) for i, x in enumerate(xs)]
    result = nodes[0]
    for node in nodes[1:]:
        result = _core.expression(kind, [result, node])
    return Expression(result)
