"""The n-ary operators: union, intersection and difference of any number of shapes, hard or blended, and metaballs.

They stand beside the operators ``|``, ``&`` and ``-`` of `shapes.Shape` and make the same nodes.
"""

from __future__ import annotations

from octomarch import _validate as check
from octomarch.shapes import Shape, combine


def union(*shapes: Shape, smooth: float = 0.0) -> Shape:
    """Return all that lies in any of the shapes.

    Parameters
    ----------
    *shapes : Shape
        At least one.
    smooth : float
        Blend distance k ≥ 0 in scene units: where two fields differ by less than k the seam is rounded by the
        quadratic polynomial blend ``min(a, b) - max(k - |a - b|, 0)**2 / (4 k)`` [1]_. 0 is the hard operator.

    Returns
    -------
    Shape
        A field that never exceeds the true distance.

    Raises
    ------
    TypeError
        If an operand is no shape, or `smooth` no number.
    ValueError
        If there is no operand, or `smooth` is negative or not finite.

    Notes
    -----
    Blends are folded from the left, ``((a, b), c)``; with three or more operands their order matters a little.

    References
    ----------
    .. [1] I. Quilez, "Smooth minimum", 2013. https://iquilezles.org/articles/smin/

    Examples
    --------
    >>> import octomarch as om
    >>> blob = om.union(om.sphere(1.0), om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25)
    >>> om.union(*(om.sphere(0.5).translate(x, 0, 0) for x in range(10)))
    <Shape union, 11 nodes>
    """
    return combine("union", shapes, smooth)


def intersection(*shapes: Shape, smooth: float = 0.0) -> Shape:
    """Return all that lies in every one of the shapes.

    Parameters and errors are those of `union`; the blend is ``max(a, b) + max(k - |a - b|, 0)**2 / (4 k)``.

    Examples
    --------
    >>> import octomarch as om
    >>> dice = om.intersection(om.box(1.5), om.sphere(1.0))
    >>> float(dice.distance([1.75, 0, 0]))
    1.0
    """
    return combine("intersection", shapes, smooth)


def difference(*shapes: Shape, smooth: float = 0.0) -> Shape:
    """Return the first shape without all the others.

    Parameters and errors are those of `union`; the blend is that of the intersection with the complement.

    Examples
    --------
    >>> import octomarch as om
    >>> bowl = om.difference(om.sphere(1.0), om.sphere(0.9), om.box(2.0).translate(0, 1, 0))
    >>> float(bowl.distance([0, -0.95, 0])) < 0
    True
    """
    return combine("difference", shapes, smooth)


def metaballs(*shapes: Shape, k: float) -> Shape:
    """Return all that lies in any of the shapes, drawn together where they are near.

    The field is ``-k log(exp(-a/k) + exp(-b/k) + ...)``, computed without overflow as ``m - k log1p(exp(-|a - b|/k))``
    with m = min(a, b), one operand after the other [1]_. Unlike `union` with ``smooth``, whose blend ends where fields
    differ by k, each shape is felt everywhere, and their order does not matter but for rounding.

    Parameters
    ----------
    *shapes : Shape
        At least one.
    k : float
        Width of the blend ≥ 0 in scene units; n shapes grow by up to ``k log(n)``. 0 is the union.

    Returns
    -------
    Shape
        A field that never exceeds the true distance.

    Raises
    ------
    TypeError
        If an operand is no shape, or `k` no number.
    ValueError
        If there is no operand, or `k` is negative or not finite.

    References
    ----------
    .. [1] I. Quilez, "Smooth minimum", 2013. https://iquilezles.org/articles/smin/

    Examples
    --------
    >>> import octomarch as om
    >>> drops = om.metaballs(om.sphere(0.5), om.sphere(0.5, center=(1.1, 0, 0)), k=0.1)
    >>> bool(drops.distance([0.55, 0, 0]) < 0)
    True
    """
    return combine("metaballs", shapes, check.number("k", k))
