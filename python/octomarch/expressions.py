"""`Expression`: a number at each point of space, built with Python's operators and compiled like any other node.

`coordinates` gives the first ones, `functions` has the rest of the arithmetic. Expressions become shapes in `fields`,
colours in `textures`, and the properties of surfaces in `materials`.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from typing import Any, Never, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Precision

ExpressionLike: TypeAlias = "Expression | float"

_LARGEST_PRODUCT = 64
_UNKNOWN = cast("Expression", NotImplemented)  # of helpers of Python's operators


class Expression:
    """A number at each point, made of coordinates, numbers and operations.

    Expressions are made by `octomarch.coordinates` and never change; numbers and numpy scalars mix in.

    ================================  ==========================================================================
    ``a + b  a - b  a * b  a / b``    as for floats; a division by zero is infinite, and 0 / 0 no number
    ``a // b  a % b``                 ``floor(a / b)`` and ``a - b * floor(a / b)``
    ``a ** b``                        products for whole numbers b up to ±64, see `octomarch.power` for others
    ``-a  abs(a)``
    ``a < b  a <= b  a > b  a >= b``  truth values: 1 where it holds, 0 where not
    ``c & d  c | d  ~c``              and, or, not; any number but 0 counts as true
    ``a == b  a != b``                whether both are the same expression, a Python bool; see `octomarch.equal`
    ================================  ==========================================================================

    numpy's functions of one number at a time work as well: ``np.sqrt(x)``, ``np.minimum(x, y)``, ``np.arctan2(y, x)``,
    ``np.clip(x, 0, 1)``, ``np.where(x < 0, y, z)``. Arrays do not mix with expressions.

    An expression has no truth value of its own: ``if``, ``and``, ``or``, ``not``, ``min``, ``max`` and chains such as
    ``a < b < c`` raise `TypeError`.

    Examples
    --------
    >>> import numpy as np, octomarch as om
    >>> x, y, z = om.coordinates()
    >>> distance = np.sqrt(x * x + y * y) - 1
    >>> distance == om.sqrt(x * x + y * y) - 1
    True
    >>> distance.evaluate([[1, 0, 5], [3, 4, 0]]).tolist()
    [0.0, 4.0]
    >>> float(((x > 0) & (y > 0)).evaluate([1, -1, 0]))
    0.0
    """

    __slots__ = ("_is_truth", "_node")

    _node: _core.Node
    _is_truth: bool

    def __init__(self, node: _core.Node, _is_truth: bool = False) -> None:
        if not isinstance(node, _core.Node):
            raise TypeError(f"expressions are made by om.coordinates(); got {check.shown(node)}")
        check.set_fields(self, _node=node, _is_truth=_is_truth)

    def __setattr__(self, name: str, value: object) -> Never:
        raise AttributeError(f"expressions are immutable: cannot set {name!r}")

    def __delattr__(self, name: str) -> Never:
        raise AttributeError(f"expressions are immutable: cannot delete {name!r}")

    def __copy__(self) -> Expression:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Expression:
        return self

    def __eq__(self, other: object) -> bool:
        return self._node == other._node if isinstance(other, Expression) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._node)

    def __bool__(self) -> Never:
        raise TypeError(
            "an expression has no truth value before it is given a point: use & | ~ for and, or, not, om.where() for "
            "if, om.minimum() and om.maximum() for min and max, and (a < b) & (b < c) for a < b < c"
        )

    def __repr__(self) -> str:
        count = self._node.node_count
        return f"<Expression {self._node.kind}, {count} node{'s' * (count != 1)}>"

    def evaluate(
        self,
        points: ArrayLike,
        *,
        precision: Precision = "float64",
        threads: int | None = None,
        isa: str | None = None,
    ) -> NDArray[np.floating[Any]]:
        """Return the numbers at points.

        Parameters
        ----------
        points : array_like of float, shape (..., 3)
            A point with a NaN gives NaN.
        precision : {"float64", "float32"}
            Arithmetic, and type of the result.
        threads : int, optional
            Threads at the most; None for all cores.
        isa : str, optional
            One of `octomarch.isas`; None for the best, or what the environment's OCTOMARCH_ISA says.

        Returns
        -------
        ndarray, shape (...,)

        Raises
        ------
        TypeError, ValueError
            If `points` are no real numbers or their last axis is not 3; if an option is not among those there are; if
            the expression looks at the surface's normal.

        Examples
        --------
        >>> import octomarch as om
        >>> x, y, z = om.coordinates()
        >>> (2 * x + y).evaluate([[1, 2, 3], [0, 1, 0]]).tolist()
        [4.0, 1.0]
        """
        from octomarch.fields import field  # here, since fields builds on this module

        return field(self, lipschitz=1.0).distance(points, precision=precision, threads=threads, isa=isa)

    # Arithmetic ------------------------------------------------------------------------------------------------------

    def __add__(self, other: ExpressionLike) -> Expression:
        return _binary("add", self, other)

    def __radd__(self, other: ExpressionLike) -> Expression:
        return _binary("add", other, self)

    def __sub__(self, other: ExpressionLike) -> Expression:
        return _binary("subtract", self, other)

    def __rsub__(self, other: ExpressionLike) -> Expression:
        return _binary("subtract", other, self)

    def __mul__(self, other: ExpressionLike) -> Expression:
        return _binary("multiply", self, other)

    def __rmul__(self, other: ExpressionLike) -> Expression:
        return _binary("multiply", other, self)

    def __truediv__(self, other: ExpressionLike) -> Expression:
        return _binary("divide", self, other)

    def __rtruediv__(self, other: ExpressionLike) -> Expression:
        return _binary("divide", other, self)

    def __mod__(self, other: ExpressionLike) -> Expression:
        return _binary("mod", self, other)

    def __rmod__(self, other: ExpressionLike) -> Expression:
        return _binary("mod", other, self)

    def __floordiv__(self, other: ExpressionLike) -> Expression:
        quotient = _binary("divide", self, other)
        return quotient if quotient is NotImplemented else apply("floor", quotient)

    def __rfloordiv__(self, other: ExpressionLike) -> Expression:
        quotient = _binary("divide", other, self)
        return quotient if quotient is NotImplemented else apply("floor", quotient)

    def __pow__(self, other: ExpressionLike) -> Expression:
        return raised(self, other) if _is_operand(other) else NotImplemented

    def __rpow__(self, other: ExpressionLike) -> Expression:
        return _binary("pow", other, self)

    def __neg__(self) -> Expression:
        return apply("negate", self)

    def __pos__(self) -> Expression:
        return self

    def __abs__(self) -> Expression:
        return apply("abs", self)

    # Comparisons and truth values ------------------------------------------------------------------------------------

    def __lt__(self, other: ExpressionLike) -> Expression:
        return _comparison("less", self, other)

    def __gt__(self, other: ExpressionLike) -> Expression:
        return _comparison("less", other, self)

    def __le__(self, other: ExpressionLike) -> Expression:
        return _comparison("less_equal", self, other)

    def __ge__(self, other: ExpressionLike) -> Expression:
        return _comparison("less_equal", other, self)

    def __and__(self, other: Expression | bool) -> Expression:
        return _combined_truth("minimum", self, other)

    def __rand__(self, other: bool) -> Expression:
        return _combined_truth("minimum", other, self)

    def __or__(self, other: Expression | bool) -> Expression:
        return _combined_truth("maximum", self, other)

    def __ror__(self, other: bool) -> Expression:
        return _combined_truth("maximum", other, self)

    def __invert__(self) -> Expression:
        truth = _truth(self)
        return Expression(_core.expression("subtract", [_core.constant(1.0), truth]), _is_truth=True)

    # numpy -----------------------------------------------------------------------------------------------------------

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: object, **options: object) -> Any:
        function = _UFUNCS.get(ufunc)
        if function is None or method != "__call__" or options:
            raise TypeError(f"np.{ufunc.__name__} does not work on om.Expression{' with options' * bool(options)}")
        return function(*(_plain(f"the operand of np.{ufunc.__name__}", value) for value in inputs))

    def __array_function__(
        self, function: Callable[..., Any], types: object, inputs: tuple[Any, ...], options: Mapping[str, Any]
    ) -> Any:
        if function is np.clip:
            return _clip(*inputs, **options)
        if function is np.where and len(inputs) == 3:
            return Expression(_core.expression("where", [operand("the operand of np.where", v) for v in inputs]))
        raise TypeError(f"np.{function.__name__} does not work on om.Expression")


def coordinates() -> tuple[Expression, Expression, Expression]:
    """Return x, y and z of the point: what all other expressions are made of.

    Returns
    -------
    (Expression, Expression, Expression)
        In the coordinates of the shape that the expression is given to, before it is moved or turned; in a material, of
        the shape that is painted.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> float((x + 10 * y + 100 * z).evaluate([1, 2, 3]))
    321.0
    """
    x, y, z = (Expression(_core.coordinate(i)) for i in range(3))
    return x, y, z


def normals() -> tuple[Expression, Expression, Expression]:
    """Return the components of the surface's unit normal, for use in materials only.

    Returns
    -------
    (Expression, Expression, Expression)
        In the coordinates of the painted shape; the normal points outward.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.normals()
    >>> snow = om.Material(color=om.mix((0.3, 0.2, 0.1), (0.9, 0.9, 0.9), om.smoothstep(0.6, 0.8, y)))
    """
    x, y, z = (Expression(_core.coordinate(i)) for i in range(3, 6))
    return x, y, z


def operand(name: str, value: object) -> _core.Node:
    """Return the node of an expression or a number; a `TypeError` names the argument."""
    if isinstance(value, Expression):
        return value._node
    if isinstance(value, np.ndarray) and value.ndim > 0:
        raise TypeError(f"{name} must be a number or an om.Expression, got an array of shape {value.shape}")
    if not _is_operand(value):
        raise TypeError(f"{name} must be a number or an om.Expression, got {check.shown(value)}")
    result = check.number(name, value)
    if math.isnan(result):
        raise ValueError(f"{name} must be a number, got nan")
    return _core.constant(result)


def apply(kind: str, *operands: ExpressionLike, names: tuple[str, ...] = ("x", "y", "z")) -> Expression:
    """Return an operation of the native graph; `names` are those of its arguments."""
    return Expression(_core.expression(kind, [operand(name, v) for name, v in zip(names, operands, strict=False)]))


def raised(base: ExpressionLike, exponent: ExpressionLike) -> Expression:
    """Return ``base ** exponent``: a product where the exponent is a whole number of at most 64, else by logarithms."""
    power = _core.constant_value(operand("exponent", exponent))
    if power is None or not power.is_integer() or abs(power) > _LARGEST_PRODUCT:
        return apply("pow", base, exponent, names=("base", "exponent"))
    square, rest = operand("base", base), abs(int(power))
    product: _core.Node | None = None
    while rest:
        if rest % 2:
            product = square if product is None else _core.expression("multiply", [product, square])
        rest //= 2
        if rest:
            square = _core.expression("multiply", [square, square])
    if product is None:
        return Expression(_core.constant(1.0))
    if power < 0:
        product = _core.expression("divide", [_core.constant(1.0), product])
    return Expression(product)


def _is_operand(value: object) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "fiu"
    return isinstance(value, Expression) or check.is_number(value)


def _plain(name: str, value: object) -> Expression | float | bool:
    """Return an operand of numpy as one that numpy does not take for its own."""
    if isinstance(value, Expression):
        return value
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    operand(name, value)
    return check.number(name, value)


def _binary(kind: str, a: ExpressionLike, b: ExpressionLike) -> Expression:
    """Return an operation for Python's operators, which ask the other operand where this one does not know it."""
    for value in (a, b):
        if not _is_operand(value):
            if isinstance(value, np.ndarray):
                operand("the operand", value)  # names the array
            return _UNKNOWN
    return Expression(_core.expression(kind, [operand("the operand", a), operand("the operand", b)]))


def _comparison(kind: str, a: ExpressionLike, b: ExpressionLike) -> Expression:
    result = _binary(kind, a, b)
    return result if result is NotImplemented else Expression(result._node, _is_truth=True)


def _truth(value: Expression | bool) -> _core.Node:
    """Return 1 or 0 for what may be any number."""
    if isinstance(value, Expression):
        if value._is_truth:
            return value._node
        return _core.expression("where", [value._node, _core.constant(1.0), _core.constant(0.0)])
    return _core.constant(float(value))


def _combined_truth(kind: str, a: Expression | bool, b: Expression | bool) -> Expression:
    """Return a & b or a | b. Numbers are refused: ``x < 1 & y < 2`` means ``x < (1 & y) < 2``."""
    if not all(isinstance(value, (Expression, bool, np.bool_)) for value in (a, b)):
        return _UNKNOWN
    return Expression(_core.expression(kind, [_truth(a), _truth(b)]), _is_truth=True)


def _clip(a: ExpressionLike, a_min: ExpressionLike | None = None, a_max: ExpressionLike | None = None) -> Expression:
    result = Expression(operand("a", a))
    if a_min is not None:
        result = apply("maximum", result, a_min, names=("a", "a_min"))
    if a_max is not None:
        result = apply("minimum", result, a_max, names=("a", "a_max"))
    return result


def _named(kind: str) -> Callable[..., Expression]:
    return lambda *operands: apply(kind, *operands)


_UFUNCS: dict[np.ufunc, Callable[..., Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.divide: operator.truediv,
    np.floor_divide: operator.floordiv,
    np.remainder: operator.mod,
    np.power: operator.pow,
    np.float_power: operator.pow,
    np.negative: operator.neg,
    np.positive: operator.pos,
    np.absolute: operator.abs,
    np.fabs: operator.abs,
    np.square: lambda x: x * x,
    np.reciprocal: lambda x: 1 / x,
    np.sqrt: _named("sqrt"),
    np.floor: _named("floor"),
    np.ceil: lambda x: -apply("floor", -x),
    np.exp: _named("exp"),
    np.log: _named("log"),
    np.sin: _named("sin"),
    np.cos: _named("cos"),
    np.tan: _named("tan"),
    np.arcsin: _named("asin"),
    np.arccos: _named("acos"),
    np.arctan: _named("atan"),
    np.arctan2: _named("atan2"),
    np.minimum: _named("minimum"),
    np.maximum: _named("maximum"),
    np.hypot: lambda x, y: apply("sqrt", apply("add", apply("multiply", x, x), apply("multiply", y, y))),
    np.less: operator.lt,
    np.less_equal: operator.le,
    np.greater: operator.gt,
    np.greater_equal: operator.ge,
    np.equal: lambda a, b: isinstance(a, Expression) and isinstance(b, Expression) and a == b,
    np.not_equal: lambda a, b: not (isinstance(a, Expression) and isinstance(b, Expression) and a == b),
    np.logical_and: operator.and_,
    np.logical_or: operator.or_,
    np.logical_not: operator.invert,
    np.bitwise_and: operator.and_,
    np.bitwise_or: operator.or_,
    np.invert: operator.invert,
}
