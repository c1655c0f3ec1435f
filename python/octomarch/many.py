"""Many primitives at once, from arrays: balls, boxes and capsules in one call each.

They make the nodes that `primitives` and `operators.union` make one by one, a hundred thousand of them in a tenth of a
second. Copies of any one shape are `shapes.Shape.instances`.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from octomarch import _core
from octomarch import _validate as check
from octomarch.shapes import Shape


def spheres(centers: ArrayLike, radii: ArrayLike, smooth: float = 0.0) -> Shape:
    """Return the union of many balls.

    The same shape as ``om.union(*(om.sphere(r, c) for c, r in zip(centers, radii)), smooth=smooth)``, made faster.

    Parameters
    ----------
    centers : array_like of float, shape (n, 3)
        World frame. At least one.
    radii : array_like of float
        One for each center, shape (n,), or one for all; each at least 0.
    smooth : float
        Blend distance k ≥ 0; see `union`.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or shape, or a number in it not finite or negative: the message names the
        first such row.

    See Also
    --------
    Shape.instances : Copies of any shape.

    Examples
    --------
    >>> import numpy as np
    >>> import octomarch as om
    >>> om.spheres([[0, 0, 0], [3, 0, 0]], [1.0, 0.5]).distance([[1.5, 0, 0], [5, 0, 0]]).tolist()
    [0.5, 1.5]
    >>> om.spheres(np.random.default_rng(0).uniform(-9, 9, (1000, 3)), 0.2, smooth=0.1)
    <Shape union, 1002 nodes>
    """
    where = check.rows("centers", centers)
    sizes = check.spread("radii", radii, (len(where),))
    return Shape(_core.spheres(where, sizes, check.number("smooth", smooth)))


def boxes(centers: ArrayLike, sizes: ArrayLike, smooth: float = 0.0) -> Shape:
    """Return the union of many boxes with edges along the axes.

    The same shape as ``om.union(*(om.box(s, c) for c, s in zip(centers, sizes)), smooth=smooth)``, made faster.

    Parameters
    ----------
    centers : array_like of float, shape (n, 3)
        World frame. At least one.
    sizes : array_like of float
        Full edge lengths, each at least 0, as an array that broadcasts to (n, 3): three numbers for each box or for
        all, shapes (n, 3) and (3,), or one edge of cubes, shapes (n, 1) and ().
    smooth : float
        Blend distance k ≥ 0; see `union`.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or shape, or a number in it not finite or negative: the message names the
        first such row.

    See Also
    --------
    Shape.instances : Copies of any shape, turned as well.

    Examples
    --------
    >>> import octomarch as om
    >>> towers = om.boxes([[0, 1, 0], [2, 2, 0]], [[1, 2, 1], [1, 4, 1]])
    >>> towers == om.box((1, 2, 1), center=(0, 1, 0)) | om.box((1, 4, 1), center=(2, 2, 0))
    True
    """
    where = check.rows("centers", centers)
    edges = check.spread("sizes", sizes, where.shape)
    return Shape(_core.boxes(where, edges, check.number("smooth", smooth)))


def capsules(a: ArrayLike, b: ArrayLike, radii: ArrayLike, smooth: float = 0.0) -> Shape:
    """Return the union of many capsules: all points within a radius of segments.

    The same shape as ``om.union(*(om.capsule(p, q, r) for p, q, r in zip(a, b, radii)), smooth=smooth)``, made faster.

    Parameters
    ----------
    a : array_like of float, shape (n, 3)
        One end of each segment, in the world frame. At least one.
    b : array_like of float, shape (n, 3)
        The other ends.
    radii : array_like of float
        One for each capsule, shape (n,), or one for all; each at least 0.
    smooth : float
        Blend distance k ≥ 0; see `union`.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or shape, or a number in it not finite or negative: the message names the
        first such row.

    Examples
    --------
    A path as a tube:

    >>> import numpy as np
    >>> import octomarch as om
    >>> turn = np.linspace(0, 6 * np.pi, 100)
    >>> path = np.stack([np.cos(turn), turn / 10, np.sin(turn)], axis=1)
    >>> om.capsules(path[:-1], path[1:], 0.1)
    <Shape union, 100 nodes>
    """
    begins, ends = check.rows("a", a), check.rows("b", b)
    if len(ends) != len(begins):
        raise ValueError(f"b must have as many rows as a, {len(begins)}, got {len(ends)}")
    sizes = check.spread("radii", radii, (len(begins),))
    return Shape(_core.capsules(begins, ends, sizes, check.number("smooth", smooth)))
