"""Shapes made of expressions: the user's own distance fields, and solids of which only the inside is known.

Expressions come before it (`expressions`, `functions`); the shapes combine with all others.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import VectorLike
from octomarch.expressions import ExpressionLike, operand
from octomarch.shapes import Shape


def field(
    expression: ExpressionLike,
    lipschitz: float | None = None,
    bounds: tuple[VectorLike, VectorLike] | NDArray[Any] | None = None,
) -> Shape:
    """Return the shape whose field is an expression: the solid is where it is at most 0.

    A march steps by the field over its slope's bound, so no surface is missed as long as the bound holds; the closer it
    is, the fewer steps are taken. Without `lipschitz` it is found by interval arithmetic on the gradient [1]_, over
    `bounds` where they are given.

    Parameters
    ----------
    expression : Expression
        Of `octomarch.coordinates`; need not be a distance.
    lipschitz : float, optional
        Bound of the slope ≥ 0: how much the field can change per scene unit. None: found.
    bounds : (lo, hi), optional
        Two corners; the shape is cut to the box between them, so that the bound need hold only there. An axis that is
        infinite in both has no ends.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or the expression looks at the surface's normal. If no
        bound is given and none is found: where the expression jumps, or grows faster than linearly and has no bounds.

    References
    ----------
    .. [1] R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis", SIAM, 2009.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> ball = om.field(om.sqrt(x * x + y * y + z * z) - 1, lipschitz=1)
    >>> float(ball.distance([0, 3, 4]))
    4.0
    >>> heart = om.field(
    ...     (x * x + 9 / 4 * z * z + y * y - 1) ** 3 - x * x * y**3 - 9 / 80 * z * z * y**3,
    ...     bounds=((-1.3, -1.3, -1.3), (1.3, 1.3, 1.3)),
    ... )
    >>> om.compile(heart).lipschitz < 1000
    True
    """
    slope = None if lipschitz is None else check.number("lipschitz", lipschitz)
    corners = None if bounds is None else check.corners("bounds", bounds)
    return Shape(_core.field(operand("expression", expression), slope, corners))


def solid(condition: ExpressionLike) -> Shape:
    """Return a shape of which only inside and outside are known: the points where the condition holds.

    Such a shape has no distances: its field is ±2⁻¹²⁶, positive outside and negative inside. Only a march of fixed
    steps finds it, ``om.March(method="fixed")``, and parts thinner than a step may be missed.

    Parameters
    ----------
    condition : Expression
        Such as ``x * x + y * y <= 1``; any number but 0 means inside.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If the condition is no expression or number, or looks at the surface's normal.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> ball = om.solid(x * x + y * y + z * z <= 1)
    >>> (ball.distance([[0, 0, 0], [2, 0, 0]]) <= 0).tolist()
    [True, False]
    >>> hit = ball.raycast([0, 0, 3], [0, 0, -1], march=om.March(method="fixed", step=0.01), t_max=6)
    >>> bool(abs(hit.t - 2) <= 0.01)
    True
    """
    return Shape(_core.solid(operand("condition", condition)))
