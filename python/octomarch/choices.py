"""Functions that choose between expressions or blend them, numbers and colours alike, as `octomarch.mix`.

`functions` comes before it. Errors are as there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, overload

from octomarch import _core
from octomarch import _validate as check
from octomarch.expressions import Expression, ExpressionLike, operand
from octomarch.functions import clamp

if TYPE_CHECKING:
    from octomarch.textures import ColorExpression, Colorful, Texture


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


def _componentwise(
    function: Callable[[ExpressionLike, ExpressionLike], Expression], a: ColorExpression, b: ColorExpression
) -> Expression | Texture:
    """Apply a function of two numbers to a and b, or to each of their three components if one is a colour."""
    from octomarch.textures import Texture, is_colorful, texture  # here, since textures builds on this module

    if not is_colorful(a) and not is_colorful(b):
        return function(a, b)  # type: ignore[arg-type]
    pairs = zip(texture("a", a).components, texture("b", b).components, strict=True)
    return Texture(*(function(u, v) for u, v in pairs))
