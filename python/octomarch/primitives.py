"""The primitives: the first shapes, from which `operators` and the methods of `shapes.Shape` build the others.

Lengths are in scene units. Numbers are checked at once: a wrong type is a `TypeError`, a value outside its domain a
`ValueError`, both naming the argument.
"""

from __future__ import annotations

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import AxisLike, VectorLike
from octomarch.shapes import Shape


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
    return _placed(_core.sphere(check.number("radius", radius)), center)


def box(size: float | VectorLike, center: VectorLike = (0.0, 0.0, 0.0)) -> Shape:
    """Return a box with edges along the axes, exact inside and outside.

    Parameters
    ----------
    size : float or sequence of three floats
        Full edge lengths, each at least 0; a number means a cube.
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
    >>> om.box((2, 4, 6)).distance([[0, 0, 0], [4, 0, 0]]).tolist()
    [-1.0, 3.0]
    """
    edges = (check.number("size", size),) * 3 if check.is_number(size) else check.vector("size", size)
    return _placed(_core.box(edges), center)


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
    return _placed(_core.cylinder(check.number("radius", radius), length, check.axis("axis", axis)), center)


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
    return _placed(_core.torus(*radii, check.axis("axis", axis)), center)


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


def _placed(node: _core.Node, center: VectorLike) -> Shape:
    where = check.point("center", center)
    return Shape(_core.translate(node, where) if any(where) else node)
