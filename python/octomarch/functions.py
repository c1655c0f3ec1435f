"""Functions of expressions: roots, angles, steps and blends, as `octomarch.sqrt` and its companions.

Each takes expressions and plain numbers and gives an `expressions.Expression`. A wrong type is a `TypeError`, a number
that is not one a `ValueError`; both name the argument. docs/semantics.md says what exactly each computes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, overload

from octomarch import _core
from octomarch import _validate as check
from octomarch.expressions import Expression, ExpressionLike, apply, operand, raised

if TYPE_CHECKING:
    from octomarch.textures import ColorExpression, Colorful, Texture

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
    return where(value > 0, 1.0, where(value < 0, -1.0, 0.0))


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


# Choices and blends ---------------------------------------------------------------------------------------------------


def equal(a: ExpressionLike, b: ExpressionLike) -> Expression:
    """Return the truth value of a = b at each point. ``a == b`` asks whether two expressions are the same instead.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> om.equal(x, y).evaluate([[1, 1, 0], [1, 2, 0]]).tolist()
    [1.0, 0.0]
    """
    left, right = Expression(operand("a", a)), Expression(operand("b", b))
    return (left <= right) & (right <= left)


@overload
def where(condition: ExpressionLike, a: ExpressionLike, b: ExpressionLike) -> Expression: ...


@overload
def where(condition: ExpressionLike, a: Colorful, b: ColorExpression) -> Texture: ...


@overload
def where(condition: ExpressionLike, a: ExpressionLike, b: Colorful) -> Texture: ...


def where(condition: ExpressionLike, a: ColorExpression, b: ColorExpression) -> Expression | Texture:
    """Return a where the condition is any number but 0, else b.

    Parameters
    ----------
    condition : Expression
        Such as ``x < 0``.
    a, b : Expression or float, Texture or sequence of three
        Both are computed everywhere. If one is a colour, the result is a texture.

    Returns
    -------
    Expression or Texture

    Raises
    ------
    TypeError, ValueError
        If the condition is no expression or number, or `a` or `b` neither that nor a colour.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> om.where(x < 0, -x, 2 * x).evaluate([[-3, 0, 0], [3, 0, 0]]).tolist()
    [3.0, 6.0]
    """
    test = operand("condition", condition)

    def chosen(u: ExpressionLike, v: ExpressionLike) -> Expression:
        return Expression(_core.expression("where", [test, operand("a", u), operand("b", v)]))

    return _componentwise(chosen, a, b)


@overload
def mix(a: ExpressionLike, b: ExpressionLike, t: ExpressionLike) -> Expression: ...


@overload
def mix(a: Colorful, b: ColorExpression, t: ExpressionLike) -> Texture: ...


@overload
def mix(a: ExpressionLike, b: Colorful, t: ExpressionLike) -> Texture: ...


def mix(a: ColorExpression, b: ColorExpression, t: ExpressionLike) -> Expression | Texture:
    """Return ``a * (1 - t) + b * t``: a where t is 0, b where it is 1.

    Parameters
    ----------
    a, b : Expression or float, Texture or sequence of three
        If one is a colour, the result is a texture.
    t : Expression or float
        Beyond 0 … 1 the line through a and b goes on.

    Returns
    -------
    Expression or Texture

    Raises
    ------
    TypeError, ValueError
        If `t` is no expression or number, or `a` or `b` neither that nor a colour.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> float(om.mix(2, 4, x).evaluate([0.5, 0, 0]))
    3.0
    >>> om.mix((1, 0, 0), (0, 0, 1), x).evaluate([0.25, 0, 0]).tolist()
    [0.75, 0.0, 0.25]
    """
    weight = Expression(operand("t", t))
    rest = 1 - weight

    def mixed(u: ExpressionLike, v: ExpressionLike) -> Expression:
        return Expression(operand("a", u)) * rest + Expression(operand("b", v)) * weight

    return _componentwise(mixed, a, b)


def smoothstep(lo: ExpressionLike, hi: ExpressionLike, x: ExpressionLike) -> Expression:
    """Return 0 below lo, 1 above hi, and between them the smooth step ``t * t * (3 - 2 t)``.

    ``t = clamp((x - lo) / (hi - lo), 0, 1)``. With lo > hi the step goes down.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> om.smoothstep(0, 2, x).evaluate([[-1, 0, 0], [1, 0, 0], [5, 0, 0]]).tolist()
    [0.0, 0.5, 1.0]
    """
    low, high = Expression(operand("lo", lo)), Expression(operand("hi", hi))
    if low == high:
        raise ValueError(f"hi must differ from lo, got {check.shown(hi)}")
    t = clamp((Expression(operand("x", x)) - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


# Noise ----------------------------------------------------------------------------------------------------------------


def noise(x: ExpressionLike, y: ExpressionLike, z: ExpressionLike, *, seed: int = 0) -> Expression:
    """Return gradient noise: a smooth random number, 0 at whole coordinates and within about ±1 between them.

    The same seed gives the same noise on every machine [1]_ [2]_. It repeats after 289 units along each axis.

    Parameters
    ----------
    x, y, z : Expression or float
        The point; scaled coordinates make coarser or finer noise.
    seed : int
        At least 0; 289 of them differ.

    Returns
    -------
    Expression

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, or the seed negative.

    References
    ----------
    .. [1] K. Perlin, "Improving noise", SIGGRAPH 2002. doi:10.1145/566654.566636
    .. [2] I. McEwan, D. Sheets, S. Gustavson, M. Richardson, "Efficient computational noise in GLSL", 2012.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> float(om.noise(x, y, z).evaluate([3, 1, -2]))
    0.0
    >>> bool(abs(om.noise(4 * x, 4 * y, 4 * z, seed=7).evaluate([0.1, 0.2, 0.3])) <= 1)
    True
    """
    point = (operand("x", x), operand("y", y), operand("z", z))
    # a seed moves the lattice along z: far, so that seeds next to each other have nothing in common
    return Expression(_core.noise(*point, check.integer("seed", seed, 0) * 179 % 289))


def fractal_noise(
    x: ExpressionLike, y: ExpressionLike, z: ExpressionLike, *, octaves: int = 4, seed: int = 0
) -> Expression:
    """Return a sum of noises, each of half the size and half the height of the one before.

    Parameters
    ----------
    x, y, z : Expression or float
        The point, as for `noise`.
    octaves : int
        Number of noises, 1 to 16; their seeds count up from `seed`.
    seed : int
        At least 0.

    Returns
    -------
    Expression
        ``Σ noise(2**i * point, seed + i) / 2**i`` over i from 0 to octaves - 1.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> om.fractal_noise(x, y, z, octaves=1) == om.noise(x, y, z)
    True
    """
    count, first = check.integer("octaves", octaves, 1, 16), check.integer("seed", seed, 0, 2**31 - 16)
    u, v, w = (Expression(operand(name, value)) for name, value in (("x", x), ("y", y), ("z", z)))
    total = noise(u, v, w, seed=first)
    for i in range(1, count):
        total = total + 2.0**-i * noise(2.0**i * u, 2.0**i * v, 2.0**i * w, seed=first + i)
    return total


def _folded(kind: str, xs: Sequence[ExpressionLike]) -> Expression:
    """Return an operation over all numbers, from the left."""
    if not xs:
        raise ValueError("xs must be one number or more, got none")
    nodes = [operand(f"xs[{i}]", x) for i, x in enumerate(xs)]
    result = nodes[0]
    for node in nodes[1:]:
        result = _core.expression(kind, [result, node])
    return Expression(result)


def _componentwise(
    function: Callable[[ExpressionLike, ExpressionLike], Expression], a: ColorExpression, b: ColorExpression
) -> Expression | Texture:
    """Apply a function of two numbers to a and b, or to each of their three components if one is a colour."""
    from octomarch.textures import Texture, is_colorful, texture  # here, since textures builds on this module

    if not is_colorful(a) and not is_colorful(b):
        return function(a, b)  # type: ignore[arg-type]
    pairs = zip(texture("a", a).components, texture("b", b).components, strict=True)
    return Texture(*(function(u, v) for u, v in pairs))
