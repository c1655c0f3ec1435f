"""Flat shapes: circles, rectangles, polygons, stars. They lie in the x-y plane and go on without end along z.

`Shape.extrude` gives them depth and `Shape.revolve` sweeps them about the y axis; combined, rounded, hollowed, moved in
their plane, turned about z, scaled or mirrored they stay flat. Arguments are checked as in `primitives`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octomarch import _core, _rings
from octomarch import _validate as check
from octomarch._rings import Ring
from octomarch._validate import Vec2, VectorLike
from octomarch.shapes import Shape

MIDDLE = (0.0, 0.0)
MANY = 4096  # more sides than any picture shows


def circle(radius: float, center: VectorLike = MIDDLE) -> Shape:
    """Return a flat disc: ``|(x, y) - center| - radius``, exact.

    Parameters
    ----------
    radius : float
        At least 0; a point at 0.
    center : sequence of two floats
        In the x-y plane.

    Returns
    -------
    Shape
        Flat: a cylinder along z.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, negative or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.circle(1.0, center=(3, 0)).distance([0, 0, 7]))
    2.0
    """
    return _centred(_core.cylinder(check.number("radius", radius), None, (0.0, 0.0, 1.0)), center)


def ellipse(radii: VectorLike, center: VectorLike = MIDDLE) -> Shape:
    """Return a flat disc with a radius of its own along x and y.

    The field is that of a stretched circle, ``min(radii) (|(x, y) / radii| - 1)``, a lower bound that is never below
    ``min(radii) / max(radii)`` of the distance; see `ellipsoid`.

    Parameters
    ----------
    radii : sequence of two floats
        Each > 0.
    center : sequence of two floats
        In the x-y plane.

    Returns
    -------
    Shape
        Flat.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or not finite, or a radius is not above zero.

    Examples
    --------
    >>> import octomarch as om
    >>> om.ellipse((3, 1)).distance([[3, 0, 0], [0, 2, 0]]).tolist()
    [0.0, 1.0]
    """
    rx, ry = check.pair("radii", radii)
    if not min(rx, ry) > 0:
        raise ValueError(f"radii must be > 0, got {check.shown(radii)}")
    return _centred(_core.stretch(circle(1.0)._node, (rx, ry, min(rx, ry))), center)


def rectangle(size: float | VectorLike, center: VectorLike = MIDDLE) -> Shape:
    """Return a flat rectangle with sides along x and y, exact inside and outside.

    Parameters
    ----------
    size : float or sequence of two floats
        Full side lengths, each at least 0; a number means a square.
    center : sequence of two floats
        In the x-y plane.

    Returns
    -------
    Shape
        Flat.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, negative or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> frame = om.rectangle((4, 2)) - om.rectangle((3, 1))
    >>> frame.distance([[0, 0, 0], [3, 0, 0]]).tolist()
    [0.5, 1.0]
    """
    sides = (check.finite("size", size),) * 2 if check.is_number(size) else check.pair("size", size)
    return _centred(_core.rectangle(sides), center)


def polygon(
    corners: Sequence[VectorLike] | NDArray[Any],
    holes: Sequence[Sequence[VectorLike] | NDArray[Any]] | NDArray[Any] = (),
) -> Shape:
    """Return a flat polygon, exact inside and outside [1]_.

    Parameters
    ----------
    corners : sequence of (x, y)
        At least three, either way round. Where edges cross, what they enclose twice counts as outside.
    holes : sequence of sequences of (x, y)
        Polygons within it that are cut out, apart from each other; then no edges may cross.

    Returns
    -------
    Shape
        Flat. Its cost grows with the number of corners.

    Raises
    ------
    TypeError, ValueError
        If `corners` are no pairs of finite numbers, or fewer than three; the same of each of `holes`. With holes: where
        edges cross, or a hole lies outside or in another hole.

    References
    ----------
    .. [1] I. Quilez, "2D distance functions". https://iquilezles.org/articles/distfunctions2d/

    Examples
    --------
    >>> import octomarch as om
    >>> house = om.polygon([(-1, 0), (1, 0), (1, 1), (0, 2), (-1, 1)])
    >>> house.extrude(3).distance([[0, 3, 0], [0, 1, 0], [0, 0.5, 2]]).round(6).tolist()
    [1.0, -0.707107, 0.5]
    >>> frame = om.polygon([(0, 0), (3, 0), (0, 3)], holes=[[(0.5, 0.5), (1, 0.5), (0.5, 1)]])
    >>> frame.distance([[0.6, 0.6, 0], [0.25, 0.6, 0]]).round(6).tolist()
    [0.1, -0.25]
    """
    outline = _ring("corners", corners)
    hollow = holes if isinstance(holes, np.ndarray) and holes.ndim == 3 else check.sequence("holes", holes, "polygons")
    inner = [_ring(f"holes[{i}]", hole) for i, hole in enumerate(hollow)]
    _require_apart(outline, inner)
    body, *cuts = (Shape(_core.polygon(ring.ravel().tolist())) for ring in (outline, *inner))
    return body.difference(*cuts) if cuts else body


def regular_polygon(sides: int, radius: float, center: VectorLike = MIDDLE) -> Shape:
    """Return a flat polygon with equal sides and angles, a corner up along y. Exact inside and outside.

    Parameters
    ----------
    sides : int
        From 3 to 4096.
    radius : float
        From the middle to a corner, at least 0.
    center : sequence of two floats
        In the x-y plane.

    Returns
    -------
    Shape
        Flat, and its own mirror image across the y axis to the last bit.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, outside its range or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> tile = om.regular_polygon(6, 1.0)
    >>> tile.distance([[0, 2, 0], [0, 0, 0]]).round(6).tolist()
    [1.0, -0.866025]
    """
    return _round_the_middle(check.integer("sides", sides, 3, MANY), [check.non_negative("radius", radius)], center)


def star(points: int, outer: float, inner: float, center: VectorLike = MIDDLE) -> Shape:
    """Return a flat star, one point up along y. Exact inside and outside.

    Parameters
    ----------
    points : int
        From 2 to 4096.
    outer, inner : float
        Radii of the points and of the corners between them, at least 0. A star's points are straight continuations of
        each other's edges with ``inner = outer cos(2 π / points) / cos(π / points)``.
    center : sequence of two floats
        In the x-y plane.

    Returns
    -------
    Shape
        Flat, and its own mirror image across the y axis to the last bit.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, outside its range or not finite.

    Examples
    --------
    >>> import octomarch as om
    >>> sheriff = om.star(5, 1.0, 0.4).extrude(0.1)
    >>> float(sheriff.distance([0, 2, 0]))
    1.0
    """
    radii = [check.non_negative("outer", outer), check.non_negative("inner", inner)]
    return _round_the_middle(2 * check.integer("points", points, 2, MANY), radii, center)


def segment(a: VectorLike, b: VectorLike, radius: float) -> Shape:
    """Return all points of the plane within `radius` of the segment from `a` to `b`, exact.

    Parameters
    ----------
    a, b : sequence of two floats
        Ends of the segment; where they agree it is a disc.
    radius : float
        At least 0.

    Returns
    -------
    Shape
        Flat: a circle, drawn apart and laid along the segment.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or not finite, or the radius is negative.

    Examples
    --------
    >>> import octomarch as om
    >>> float(om.segment((0, 0), (0, 3), 0.5).distance([2, 1, 0]))
    1.5
    """
    (ax, ay), (bx, by) = check.pair("a", a), check.pair("b", b)
    length = math.hypot(bx - ax, by - ay)
    if not math.isfinite(length):
        raise ValueError(f"b must be near enough to a for their distance to be finite, got {check.shown(b)}")
    along_x = circle(radius).elongate((length, 0.0, 0.0))
    laid = along_x.rotate(math.degrees(math.atan2(by - ay, bx - ax)), "z")
    return laid.translate(ax / 2 + bx / 2, ay / 2 + by / 2, 0.0)


def _ring(name: str, corners: object) -> Ring:
    rows = isinstance(corners, np.ndarray) and corners.ndim == 2
    items = list(corners) if rows else check.sequence(name, corners, "pairs (x, y)")  # type: ignore[call-overload]
    pairs = [check.pair(f"{name}[{i}]", corner) for i, corner in enumerate(items)]
    if len(pairs) < 3:
        raise ValueError(f"{name} must be three points or more, got {len(pairs)}")
    return np.array(pairs)


def _require_apart(outline: Ring, holes: list[Ring]) -> None:
    """Hold the rings of a polygon with holes against what makes the difference of both exact."""
    if not holes:
        return
    rings = {"corners": outline, **{f"holes[{i}]": hole for i, hole in enumerate(holes)}}
    for (a, ring), (b, other) in itertools.combinations_with_replacement(rings.items(), 2):
        if (point := _rings.crossing(ring, other)) is not None:
            wanted = f"cross {b}" if a != b else "cross itself"
            raise ValueError(
                f"{a} must not {wanted} in a polygon with holes, got edges that do at {_rings.shown(point)}"
            )
    for i, hole in enumerate(holes):
        if not _rings.lies_in(hole, outline):
            raise ValueError(f"holes[{i}] must lie within corners, got one outside at {_rings.shown(hole[0])}")
        for j, other in enumerate(holes):
            if i != j and _rings.lies_in(hole, other):
                raise ValueError(f"holes[{i}] must not lie within another hole, got one within holes[{j}]")


def _centred(node: _core.Node, center: VectorLike) -> Shape:
    x, y = check.pair("center", center)
    return Shape(_core.translate(node, (x, y, 0.0)))


def _round_the_middle(count: int, radii: list[float], center: VectorLike) -> Shape:
    """Return the polygon with `count` corners at equal angles, whose radii take turns."""
    corners: list[float] = []
    for i in range(count):
        radius, (sine, cosine) = radii[i % len(radii)], _sine_cosine(Fraction(i, count))
        corners += [radius * sine, radius * cosine]
    return _centred(_core.polygon(corners), center)


def _sine_cosine(turn: Fraction) -> Vec2:
    """Return sine and cosine of a part of a turn from 0 to 1, with all the symmetries of the circle to the last bit."""
    if turn > Fraction(1, 2):
        sine, cosine = _sine_cosine(1 - turn)
        return -sine, cosine
    if turn > Fraction(1, 4):
        sine, cosine = _sine_cosine(Fraction(1, 2) - turn)
        return sine, -cosine
    if turn > Fraction(1, 8):
        sine, cosine = _sine_cosine(Fraction(1, 4) - turn)
        return cosine, sine
    angle = 2 * math.pi * float(turn)
    return math.sin(angle), math.cos(angle)
