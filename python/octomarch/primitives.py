"""The primitives: the first shapes, from which `operators` and the methods of `shapes.Shape` build the others.

Balls, boxes and what is round about an axis; `solids` has the other bodies, `flat` shapes in the plane, `surfaces`
walls that fill space. Lengths are in scene units. Numbers are checked at once: a wrong type is a `TypeError`, a value
outside its domain a `ValueError`, both naming the argument.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import AxisLike, Vec3, VectorLike
from octomarch.shapes import Shape, placed

BoxForm: TypeAlias = Literal["exact", "exterior", "maximum"]


def sphere(radius: float, center: VectorLike = (0.0, 0.0, 0.0)) -> Shape:
    """Return a ball: ``|p - center| - radius``, exact.

    Parameters
    ----------
    radius : float
        At least 0; a point at 0.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, negative or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.sphere(1.0, center=(0, 2, 0)).distance([0, 0, 0]))
    1.0
    """
    return placed(_core.sphere(check.number("radius", radius)), center)


def box(size: float | VectorLike, center: VectorLike = (0.0, 0.0, 0.0), form: BoxForm = "exact") -> Shape:
    """Return a box with edges along the axes.

    With q = ``|p - center| - size / 2`` there are three forms of its field [1]_. The others are as users may know them
    from elsewhere; neither is cheaper here by more than an operation or two.

    ==============  =================================  ======================================================
    ``"exact"``     ``|max(q, 0)| + min(max(q), 0)``   the distance, outside and inside
    ``"exterior"``  ``|max(q, 0)|``                    the distance outside, 0 within: no interior to march in
    ``"maximum"``   ``max(q)``                         inside the distance; outside a lower bound, down to 1/√3
                                                       of it off the corners
    ==============  =================================  ======================================================

    Parameters
    ----------
    size : float or sequence of three floats
        Full edge lengths, each at least 0; a number means a cube.
    center : sequence of three floats
        World frame.
    form : {"exact", "exterior", "maximum"}
        See above.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If a number is none, negative or not finite, or `form` is another.

    References
    ----------
    .. [1] I. Quilez, "Distance functions". https://iquilezles.org/articles/distfunctions/

    Examples
    --------
    >>> import octomarch as om
    >>> om.box((2, 4, 6)).distance([[0, 0, 0], [4, 0, 0]]).tolist()
    [-1.0, 3.0]
    >>> [float(om.box(2.0, form=form).distance([4, 5, 1])) for form in ("exact", "maximum")]
    [5.0, 4.0]
    """
    name: str = check.choice("form", form, ("exact", "exterior", "maximum"))
    return placed(_core.box(_edges(size), name), center)


def rounded_box(size: float | VectorLike, radius: float, center: VectorLike = (0.0, 0.0, 0.0)) -> Shape:
    """Return a box with round edges, exact inside and outside.

    Parameters
    ----------
    size : float or sequence of three floats
        Full edge lengths, rounding included; a number means a cube.
    radius : float
        Of the edges, from 0 to half the shortest edge length.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape
        A smaller box, grown by `Shape.round`.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, negative or not finite, or the radius too large.

    Examples
    --------
    >>> import octomarch as om
    >>> om.rounded_box((2, 4, 6), 0.5).distance([[2, 0, 0], [0, 0, 0]]).tolist()
    [1.0, -1.0]
    """
    x, y, z = (check.non_negative("size", edge) for edge in _edges(size))
    rounding, most = check.non_negative("radius", radius), min(x, y, z) / 2
    if rounding > most:
        raise ValueError(f"radius must be at most half of the shortest edge of size, {most}, got {check.shown(radius)}")
    inner = _core.box((x - 2 * rounding, y - 2 * rounding, z - 2 * rounding), "exact")
    return placed(_core.round(inner, rounding), center)


def plane(normal: VectorLike = (0.0, 1.0, 0.0), point: VectorLike = (0.0, 0.0, 0.0)) -> Shape:
    """Return the half-space below a plane: all points on the side the normal points away from.

    Parameters
    ----------
    normal : sequence of three floats
        Outward, of any length but zero.
    point : sequence of three floats
        Any point of the plane.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is no vector or not finite, or the normal is zero.

    Examples
    --------
    >>> import octomarch as om
    >>> floor = om.plane(normal=(0, 1, 0), point=(0, -1, 0))
    >>> float(floor.distance([5, 2, 5]))
    3.0
    """
    return Shape(_core.plane(check.vector("normal", normal), check.vector("point", point)))


def cylinder(
    radius: float,
    height: float | None = None,
    axis: AxisLike = "y",
    center: VectorLike = (0.0, 0.0, 0.0),
) -> Shape:
    """Return a cylinder, capped or endless, exact inside and outside.

    Parameters
    ----------
    radius : float
        At least 0.
    height : float, optional
        Full height, at least 0; None for an endless one.
    axis : {"x", "y", "z"} or sequence of three floats
        Direction of the axis, of any length but zero.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, negative or not finite, or the axis is zero.

    Examples
    --------
    >>> import octomarch as om
    >>> can = om.cylinder(1.0, height=2.0)
    >>> can.distance([[3, 0, 0], [0, 3, 0]]).tolist()
    [2.0, 2.0]
    >>> float(om.cylinder(1.0, axis="x").distance([100, 3, 0]))
    2.0
    """
    length = None if height is None else check.number("height", height)
    return placed(_core.cylinder(check.number("radius", radius), length, check.axis("axis", axis)), center)


def torus(radius: float, tube_radius: float, axis: AxisLike = "y", center: VectorLike = (0.0, 0.0, 0.0)) -> Shape:
    """Return a ring, exact inside and outside.

    Parameters
    ----------
    radius : float
        Of the tube's centre line, at least 0.
    tube_radius : float
        Of the tube, at least 0.
    axis : {"x", "y", "z"} or sequence of three floats
        About which the ring runs, of any length but zero.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, negative or not finite, or the axis is zero.

    Examples
    --------
    >>> import octomarch as om
    >>> om.torus(2.0, 0.5).distance([[0, 0, 0], [4, 0, 0]]).tolist()
    [1.5, 1.5]
    """
    radii = check.number("radius", radius), check.number("tube_radius", tube_radius)
    return placed(_core.torus(*radii, check.axis("axis", axis)), center)


def capsule(a: VectorLike, b: VectorLike, radius: float) -> Shape:
    """Return all points within `radius` of the segment from `a` to `b`, exact.

    Parameters
    ----------
    a, b : sequence of three floats
        Ends of the segment; where they agree the capsule is a ball.
    radius : float
        At least 0.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or not finite, or the radius is negative.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.capsule((0, 0, 0), (0, 3, 0), 0.5).distance([2, 1, 0]))
    1.5
    """
    return Shape(_core.capsule(check.vector("a", a), check.vector("b", b), check.number("radius", radius)))


def _edges(size: float | VectorLike) -> Vec3:
    """Return three edge lengths, which native builders check, of one number or three."""
    if check.is_number(size):
        edge = check.number("size", size)
        return edge, edge, edge
    return check.vector("size", size)
