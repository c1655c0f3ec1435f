"""Fields that are known by samples on a grid: simulations, scans, distances to meshes.

Arguments are checked as in `primitives`.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from numpy.typing import ArrayLike

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import VectorLike
from octomarch.shapes import Shape

Interpolation: TypeAlias = Literal["linear", "cubic"]
INTERPOLATIONS = ("linear", "cubic")


def grid(values: ArrayLike, bounds: tuple[VectorLike, VectorLike], interpolation: Interpolation = "linear") -> Shape:
    """Return the solid where a field that is known by samples is below zero.

    The field between samples is trilinear, or tricubic by splines through the samples with continuous slopes [1]_:
    smoother normals at about six times the cost. How steep it is at the most is measured as the shape is built, and
    each step of a march is divided by that; so samples need not be distances. Of a scan, give ``values - level`` (or
    ``level - values`` where what is dense shall be solid).

    The solid ends at the bounds. Outside, with q the nearest point of the bounds, the field is
    ``hypot(|p - q|, max(field(q), 0))``: never more than the distance to what is inside, since the way there is no
    shorter than both legs of that right triangle. Where samples differ by more than they lie apart, or by less than
    half of it everywhere, ``|p - q|`` counts as many times as the field is steep.

    Parameters
    ----------
    values : array_like of float, shape (nx, ny, nz)
        Samples, at least two along each axis; ``values[i, j, k]`` at the i-th of nx evenly spaced places along x from
        bound to bound, and so on. They are kept as 32-bit floats, shared by all shapes that are made of this one.
    bounds : (lower, upper)
        Corners of the box that the outermost samples lie on, three finite floats each.
    interpolation : {"linear", "cubic"}
        See above.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If `values` are no real numbers, not finite or no such array, or `bounds` no such box.

    References
    ----------
    .. [1] E. Catmull, R. Rom, "A class of local interpolating splines", Computer Aided Geometric Design, 1974.

    Examples
    --------
    >>> import numpy as np
    >>> import octomarch as om
    >>> x, y, z = np.meshgrid(*[np.linspace(-2, 2, 41)] * 3, indexing="ij")
    >>> ball = om.grid(np.sqrt(x**2 + y**2 + z**2) - 1, ((-2, -2, -2), (2, 2, 2)))
    >>> ball.distance([[1.5, 0, 0], [5, 0, 0]]).round(3).tolist()
    [0.5, 3.162]
    """
    samples = check.volume("values", values)
    lower, upper = check.corners("bounds", bounds)
    kind = check.choice("interpolation", interpolation, INTERPOLATIONS)
    return Shape(_core.grid(samples, lower, upper, kind))
