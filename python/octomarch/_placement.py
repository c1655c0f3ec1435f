"""Where a shape stands and how often: moves, turns, scale, mirror images, repetition. `shapes.Shape` inherits them.

None of them changes what the distance is worth: a field that was exact stays so, up to what is said of cells and of
mirrors. `_deformation` has the operators that change the form.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Self, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import AxisLike, Vec3, VectorLike
from octomarch.queries import Field

Periods: TypeAlias = float | Sequence[float | None]


class Placement(Field):
    """Operators that move, mirror and repeat."""

    __slots__ = ()

    @overload
    def translate(self, x: VectorLike, /) -> Self: ...

    @overload
    def translate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Self: ...

    def translate(self, x: float | VectorLike = 0.0, y: float = 0.0, z: float = 0.0) -> Self:
        """Return the shape moved by (x, y, z) scene units; one vector is taken as well.

        Raises
        ------
        TypeError, ValueError
            If an offset is no number, or not finite.

        Examples
        --------
        >>> import octomarch as om
        >>> om.sphere(1.0).translate(0, 2, 0) == om.sphere(1.0).translate((0, 2, 0))
        True
        """
        if check.is_number(x):
            offset = (check.number("x", x), check.number("y", y), check.number("z", z))
        elif check.is_number(y) and check.is_number(z) and y == z == 0:
            offset = check.vector("x", x)
        else:
            raise TypeError(f"x must be a number beside y and z, or a vector alone, got {check.shown((x, y, z))}")
        if not all(map(math.isfinite, offset)):
            raise ValueError(f"x, y and z must be finite, got {check.shown(offset)}")
        return self._made(_core.translate(self._node, offset))

    def rotate(self, degrees: float, axis: AxisLike = "y") -> Self:
        """Return the shape turned about an axis through the origin, counter-clockwise seen against the axis.

        Parameters
        ----------
        degrees : float
            Angle of the right-handed turn. Quarter turns are exact.
        axis : {"x", "y", "z"} or sequence of three floats
            Direction of the axis, of any length but zero.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or not finite, or the axis is zero.

        Examples
        --------
        >>> import octomarch as om
        >>> beam = om.box((4, 1, 1)).rotate(90, axis="z")
        >>> float(beam.distance([0, 2, 0]))
        0.0
        """
        return self._made(_core.rotate(self._node, check.number("degrees", degrees), check.axis("axis", axis)))

    def scale(self, factor: float) -> Self:
        """Return the shape enlarged by `factor` > 0 about the origin; distances stay exact.

        Raises
        ------
        TypeError, ValueError
            If the factor is no number, not finite, or not above zero.

        See Also
        --------
        stretch : A factor for each axis.

        Examples
        --------
        >>> import octomarch as om
        >>> float(om.sphere(1.0).scale(2).distance([5, 0, 0]))
        3.0
        """
        return self._made(_core.scale(self._node, check.number("factor", factor)))

    def instances(self, matrices: ArrayLike, smooth: float = 0.0) -> Self:
        """Return the union of copies of the shape, each placed by a matrix.

        The copies share the shape. Each is scaled, turned and moved, in this order, as by `scale`, `rotate` and
        `translate`.

        Parameters
        ----------
        matrices : array_like of float, shape (n, 3, 4) or (n, 4, 4)
            At least one, ``world_from_shape``: a point p of the shape comes to ``matrix[:3, :3] @ p + matrix[:3, 3]``.
            The first three columns must be a rotation R times one factor > 0, up to 1e-5 in the entries of
            ``R.T @ R``; the nearest rotation and the mean factor are taken. A quarter turn, a turn about a coordinate
            axis or a factor of 1 that is off by a few roundings of the numbers given is set right. The last row of
            (4, 4) is (0, 0, 0, 1).
        smooth : float
            Blend distance k ≥ 0; see `union`.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or shape, or a matrix not finite or no such motion: the message names the
            first of them.

        See Also
        --------
        spheres, boxes, capsules : Many primitives from arrays.
        repeat : Copies on a regular grid, at the cost of one or two.

        Examples
        --------
        >>> import numpy as np
        >>> import octomarch as om
        >>> turn = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        >>> matrices = np.tile(np.eye(4), (12, 1, 1))
        >>> matrices[:, 0, 0] = matrices[:, 2, 2] = np.cos(turn)
        >>> matrices[:, 0, 2], matrices[:, 2, 0] = np.sin(turn), -np.sin(turn)
        >>> dial = om.box((1, 0.2, 0.2), center=(3, 0, 0)).instances(matrices)
        >>> dial.distance([[0, 0, 4], [-4, 0, 0]]).round(6).tolist()
        [0.5, 0.5]
        """
        rows, rounding = check.matrices("matrices", matrices)
        return self._made(_core.instances(self._node, rows, rounding, check.number("smooth", smooth)))

    def mirror(self, axes: str) -> Self:
        """Return the half of the shape where a coordinate is ≥ 0, together with its mirror image.

        The field is that of the shape at ``|coordinate|``. It is exact where the shape lies within its half, and a
        lower bound where it is cut.

        Parameters
        ----------
        axes : str
            "x", "y" or "z"; several letters, as in "xz", mirror one after the other.

        Raises
        ------
        TypeError, ValueError
            If `axes` is no text, or not of different letters among x, y and z.

        Examples
        --------
        >>> import octomarch as om
        >>> table_legs = om.box((0.2, 1.0, 0.2), center=(1, 0, 0.5)).mirror("xz")
        >>> table_legs.distance([[1, 0, 0.5], [-1, 0, 0.5], [-1, 0, -0.5]]).round(6).tolist()
        [-0.1, -0.1, -0.1]
        """
        node = self._node
        for axis in check.axis_numbers("axes", axes):
            node = _core.mirror(node, axis)
        return self._made(node)

    def repeat(self, period: Periods, counts: int | Sequence[int | None] | None = None) -> Self:
        """Return copies of the shape on a regular grid about the origin.

        Each copy must fit its cell, which reaches half a period from its centre: what lies outside is cut off, and near
        it distances are too large. A shape that is not its own mirror image across a repeated axis costs twice for that
        axis, since the neighbouring cell is looked at too.

        Parameters
        ----------
        period : float or sequence of three floats
            Distance between neighbours along x, y and z, > 0; None or 0 for an axis without copies. One number
            serves all axes.
        counts : int or sequence of three ints, optional
            Copies along each axis, ≥ 1, centred on the origin; None or 0 for endless.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range, or no axis is repeated.

        See Also
        --------
        tile : Cells that begin at the origin.

        Examples
        --------
        >>> import octomarch as om
        >>> row = om.sphere(0.3).repeat((1, None, None), counts=(3, None, None))
        >>> row.distance([[1, 0, 0], [2, 0, 0]]).round(6).tolist()
        [-0.3, 0.7]
        """
        copies = [counts] * 3 if not np.iterable(counts) else check.sequence("counts", counts, "three integers")
        if len(copies) != 3:
            raise ValueError(f"counts must be one integer or three, got {check.shown(counts)}")
        numbers = [0 if n is None else check.integer("counts", n, 0) for n in copies]
        return self._made(_core.repeat(self._node, _periods(period), numbers))

    def tile(self, period: Periods, scale: float = 1.0, offset: float | VectorLike = 0.0) -> Self:
        """Return endless copies of what lies in the corner cell, from 0 to `period` on each tiled axis.

        With A = `scale` and N = `offset`, the field at p is that of the shape at ``mod(A p + N, period)``, over A,
        where ``mod(x, m) = x - m floor(x / m)`` on the tiled axes and x on the others. Shaders write it
        ``fmod(pos * A + N, M)``, and ``frac(pos)`` for A = 1, N = 0, M = 1; unlike theirs, these cells go on below
        zero. `repeat` has its cells about the origin instead: ``shape.tile(m)`` is
        ``shape.translate(-m/2).repeat(m).translate(m/2)``.

        The shape must lie within its cell. As with `repeat`, where it is not its own mirror image about the middle of
        the cell the neighbouring cell is looked at too, and the nearer copy counts: there the formula alone would
        overestimate, and rays would miss.

        Parameters
        ----------
        period : float or sequence of three floats
            Edges M of the cell along x, y and z in the shape's own units, > 0; None or 0 for an axis that is not
            tiled. One number serves all axes.
        scale : float
            A > 0: the larger, the smaller and denser the copies. Distances stay true.
        offset : float or sequence of three floats
            N in the shape's own units; one number moves the tiled axes.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range, or no axis is tiled.

        Examples
        --------
        >>> import octomarch as om
        >>> columns = om.cylinder(0.25, center=(0.5, 0, 0.5)).tile((1, None, 1))
        >>> columns.distance([[0.5, 7, 0.5], [-3.5, 0, 2.5], [1, 0, 1]]).round(3).tolist()
        [-0.25, -0.25, 0.457]
        """
        periods, factor = _periods(period), check.positive("scale", scale)
        if not math.isfinite(1 / factor):
            raise ValueError(f"scale must be large enough for its inverse to be finite, got {check.shown(scale)}")
        tiled = [p > 0 for p in periods]
        shift: Vec3
        if check.is_number(offset):
            amount = check.finite("offset", offset)
            shift = (amount * tiled[0], amount * tiled[1], amount * tiled[2])
        else:
            shift = check.point("offset", offset)
        middle = [p / 2 for p in periods]
        cells = _core.repeat(_core.translate(self._node, [-m for m in middle]), periods, (0, 0, 0))
        node = _core.scale(_core.translate(cells, middle), 1 / factor)
        return self._made(_core.translate(node, [-n / factor for n in shift]))


def _periods(period: Any) -> list[float]:
    """Return three periods, 0 for an axis that is not repeated."""
    given = [period] * 3 if not np.iterable(period) else check.sequence("period", period, "three numbers")
    if len(given) != 3 or all(p is None for p in given):
        raise ValueError(f"period must be one number, or three of which some may be None, got {check.shown(period)}")
    return [0.0 if p is None else check.non_negative("period", p) for p in given]
