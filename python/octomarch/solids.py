"""Solids beyond the primitives: cones, prisms, an octahedron, a pyramid, a link of a chain, ellipsoids.

Those that are no nodes of their own are built from `primitives` and `flat` shapes by operators. Arguments are checked
as in `primitives`.
"""

from __future__ import annotations

import math

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import AxisLike, VectorLike
from octomarch.flat import regular_polygon
from octomarch.shapes import Shape, placed

ORIGIN = (0.0, 0.0, 0.0)


def cone(radius: float, height: float, axis: AxisLike = "y", center: VectorLike = ORIGIN) -> Shape:
    """Return a cone with a flat base, exact inside and outside.

    Parameters
    ----------
    radius : float
        Of the base, at least 0.
    height : float
        From base to tip, at least 0; a disc at 0.
    axis : {"x", "y", "z"} or sequence of three floats
        Direction from the base to the tip, of any length but zero.
    center : sequence of three floats
        Half-way between base and tip, world frame.

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
    >>> om.cone(1.0, 2.0).distance([[0, 3, 0], [0, -2, 0]]).tolist()
    [2.0, 1.0]
    """
    return capped_cone(check.non_negative("radius", radius), 0.0, height, axis, center)


def capped_cone(
    radius_bottom: float,
    radius_top: float,
    height: float,
    axis: AxisLike = "y",
    center: VectorLike = ORIGIN,
) -> Shape:
    """Return a cone without its tip, with flat ends, exact inside and outside [1]_.

    Parameters
    ----------
    radius_bottom, radius_top : float
        Of the ends, at least 0; either may be the larger.
    height : float
        From end to end, at least 0; a disc at 0.
    axis : {"x", "y", "z"} or sequence of three floats
        Direction from bottom to top, of any length but zero.
    center : sequence of three floats
        Half-way between the ends, world frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, negative or not finite, or the axis is zero.

    References
    ----------
    .. [1] I. Quilez, "Distance functions". https://iquilezles.org/articles/distfunctions/

    Examples
    --------
    >>> import octomarch as om
    >>> bucket = om.capped_cone(0.75, 1.0, 2.0)
    >>> bucket.distance([[0, 2, 0], [0, -3, 0]]).tolist()
    [1.0, 2.0]
    """
    radii = check.number("radius_bottom", radius_bottom), check.number("radius_top", radius_top)
    return placed(_core.capped_cone(*radii, check.number("height", height), check.axis("axis", axis)), center)


def ellipsoid(radii: VectorLike, center: VectorLike = ORIGIN) -> Shape:
    """Return a ball with a radius of its own along x, y and z.

    There is no closed form of the distance. The field is that of a stretched ball, ``min(radii) (|p / radii| - 1)``, a
    lower bound that is never below ``min(radii) / max(radii)`` of the distance: along each ray from the centre it grows
    by at least that much per unit.

    Parameters
    ----------
    radii : sequence of three floats
        Each > 0.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or not finite, or a radius is not above zero.

    Examples
    --------
    >>> import octomarch as om
    >>> om.ellipsoid((3, 1, 2)).distance([[3, 0, 0], [0, 2, 0]]).tolist()
    [0.0, 1.0]
    """
    factors = check.point("radii", radii)
    if not min(factors) > 0:
        raise ValueError(f"radii must be > 0, got {check.shown(radii)}")
    return placed(_core.stretch(_core.sphere(1.0), factors), center)


def octahedron(radius: float, center: VectorLike = ORIGIN) -> Shape:
    """Return a regular octahedron with corners on the axes, exact inside and outside.

    Parameters
    ----------
    radius : float
        From the centre to a corner, at least 0.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, negative or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> om.octahedron(1.0).distance([[3, 0, 0], [0, 0, 0]]).round(6).tolist()
    [2.0, -0.57735]
    """
    return placed(_core.octahedron(check.number("radius", radius)), center)


def pyramid(edge: float, height: float, center: VectorLike = ORIGIN) -> Shape:
    """Return a pyramid on a square base, its tip up along y, exact inside and outside.

    Parameters
    ----------
    edge : float
        Of the base, which lies along x and z, at least 0.
    height : float
        From base to tip, at least 0; a flat square at 0.
    center : sequence of three floats
        Half-way between base and tip, world frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, negative or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> om.pyramid(2.0, 3.0).distance([[0, 2, 0], [0, -3, 0]]).tolist()
    [0.5, 1.5]
    """
    return placed(_core.pyramid(check.number("edge", edge), check.number("height", height)), center)


def hexagonal_prism(radius: float, height: float, axis: AxisLike = "y", center: VectorLike = ORIGIN) -> Shape:
    """Return a prism over a regular hexagon, exact inside and outside.

    Parameters
    ----------
    radius : float
        From the middle of the hexagon to a corner, at least 0.
    height : float
        Along the axis, at least 0.
    axis : {"x", "y", "z"} or sequence of three floats
        Direction of the axis, of any length but zero. About y two corners lie on the z axis, about x and z on the
        y axis.
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
    >>> nut = om.hexagonal_prism(1.0, 0.5) - om.cylinder(0.5)
    >>> nut.distance([[0, 0, 2], [0, 1.25, 0.75]]).tolist()
    [1.0, 1.0]
    """
    return _prism(6, radius, height, axis, center)


def triangular_prism(radius: float, height: float, axis: AxisLike = "y", center: VectorLike = ORIGIN) -> Shape:
    """Return a prism over a regular triangle, exact inside and outside.

    Parameters
    ----------
    radius : float
        From the middle of the triangle to a corner, at least 0.
    height : float
        Along the axis, at least 0.
    axis : {"x", "y", "z"} or sequence of three floats
        Direction of the axis, of any length but zero. About y a corner points along +z, about x and z along +y.
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
    >>> roof = om.triangular_prism(1.0, 4.0, axis="z")
    >>> roof.distance([[0, 2, 0], [0, -1.5, 0]]).round(6).tolist()
    [1.0, 1.0]
    """
    return _prism(3, radius, height, axis, center)


def link(length: float, radius: float, tube_radius: float, center: VectorLike = ORIGIN) -> Shape:
    """Return a link of a chain: a ring about z, cut at y = 0 and drawn apart along y. Exact inside and outside.

    Parameters
    ----------
    length : float
        Of the straight parts, at least 0; a ring at 0.
    radius : float
        Of the tube's centre line at the round ends, at least 0.
    tube_radius : float
        Of the tube, at least 0.
    center : sequence of three floats
        World frame.

    Returns
    -------
    Shape

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, negative or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> om.link(2.0, 0.5, 0.25).distance([[1.75, 0.5, 0], [0, 2.75, 0], [0, 0, 0]]).tolist()
    [1.0, 1.0, 0.25]
    """
    straight = check.non_negative("length", length)
    radii = check.number("radius", radius), check.number("tube_radius", tube_radius)
    ring = _core.torus(*radii, (0.0, 0.0, 1.0))
    return placed(_core.elongate(ring, (0.0, straight, 0.0)), center)


def _prism(sides: int, radius: float, height: float, axis: AxisLike, center: VectorLike) -> Shape:
    x, y, z = check.direction("axis", check.axis("axis", axis))
    standing = regular_polygon(sides, radius).extrude(height)
    if abs(z) < 1:  # from along z to along the axis, whose two ends are alike
        standing = standing.rotate(math.degrees(math.atan2(math.hypot(x, y), -z)), (y, -x, 0.0))
    return placed(standing._node, center)
