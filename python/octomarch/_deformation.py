"""What changes a shape's form: rounding, hollowing, stretching, twisting, bending, flat shapes given depth.

`shapes.Shape` inherits them, as it does the placements of `_placement`. Each operator says what its field is worth; the
compiler carries the bound of its slope along (`Program.lipschitz`), by which every march divides.
"""

from __future__ import annotations

from typing import Self

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import AxisLetter, VectorLike
from octomarch.expressions import ExpressionLike, operand
from octomarch.queries import Field


class Deformation(Field):
    """Operators that change the form of a shape."""

    __slots__ = ()

    # Of the distance -------------------------------------------------------------------------------------------------

    def round(self, radius: float) -> Self:
        """Return the shape grown by `radius` on all sides, so that edges are round: the field less `radius`.

        Exact outside where the shape is exact. `octomarch.rounded_box` has the size that it is given.

        Raises
        ------
        TypeError, ValueError
            If the radius is no number, negative or not finite.

        Examples
        --------
        >>> import octomarch as om
        >>> float(om.box(1.0).round(0.25).distance([2, 0, 0]))
        1.25
        """
        return self._made(_core.round(self._node, check.number("radius", radius)))

    def shell(self, thickness: float) -> Self:
        """Return the surface as a wall, half its thickness on either side: ``|field| - thickness / 2``.

        Exact where the shape is exact on the point's side of its surface.

        Parameters
        ----------
        thickness : float
            Of the wall, at least 0.

        Raises
        ------
        TypeError, ValueError
            If the thickness is no number, negative or not finite.

        Examples
        --------
        >>> import octomarch as om
        >>> bowl = om.sphere(1.0).shell(0.5) & om.plane()
        >>> bowl.distance([[0, -1, 0], [0, 0, 0], [0, -2, 0]]).tolist()
        [-0.25, 0.75, 0.75]
        """
        return self._made(_core.shell(self._node, check.number("thickness", thickness)))

    def displace(self, expression: ExpressionLike, lipschitz: float | None = None) -> Self:
        """Return the shape with an expression added to its field: a surface with bumps, dents or waves.

        The bound of the slope is that of the shape plus that of the expression. A lower bound of the distance.

        Parameters
        ----------
        expression : Expression
            Of `octomarch.coordinates`, in the coordinates of this shape; above zero it digs into the solid.
        lipschitz : float, optional
            Bound of the expression's slope ≥ 0. None: found by interval arithmetic over all space, which succeeds for
            waves such as ``om.sin(x)``.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range, the expression looks at the surface's normal, or no
            bound is given and none is found.

        Examples
        --------
        >>> import octomarch as om
        >>> x, y, z = om.coordinates()
        >>> corrugated = om.sphere(1.0).displace(0.05 * om.sin(20 * y))
        >>> om.compile(corrugated).lipschitz
        2.0
        """
        slope = None if lipschitz is None else check.number("lipschitz", lipschitz)
        return self._made(_core.displace(self._node, operand("expression", expression), slope))

    # Of space --------------------------------------------------------------------------------------------------------

    def stretch(self, factors: VectorLike) -> Self:
        """Return the shape enlarged by a factor of its own along x, y and z.

        The field is ``min(factors) * field(p / factors)``, a lower bound: with equal factors it is exact, else it falls
        short of the distance by as much as ``min(factors) / max(factors)``. Rays then take more steps.

        Parameters
        ----------
        factors : sequence of three floats
            Each > 0.

        Raises
        ------
        TypeError, ValueError
            If the factors are no three numbers, not finite, or not above zero.

        Examples
        --------
        >>> import octomarch as om
        >>> lens = om.sphere(1.0).stretch((2, 1, 2))
        >>> lens.distance([[2, 0, 0], [0, 3, 0], [6, 0, 0]]).tolist()
        [0.0, 2.0, 2.0]
        """
        return self._made(_core.stretch(self._node, check.vector("factors", factors)))

    def elongate(self, lengths: VectorLike) -> Self:
        """Return the shape cut through the origin, drawn apart along x, y and z, and filled between.

        The field is that of the shape at ``p - clamp(p, -lengths / 2, lengths / 2)``: a lower bound of the distance,
        exact outside for what is widest where it is cut, such as balls, boxes and rings about the origin.

        Parameters
        ----------
        lengths : sequence of three floats
            By which the shape becomes longer along each axis, at least 0.

        Raises
        ------
        TypeError, ValueError
            If the lengths are no three numbers, negative or not finite.

        Examples
        --------
        >>> import octomarch as om
        >>> pill = om.sphere(0.5).elongate((0, 2, 0))
        >>> pill.distance([[0, 2, 0], [1, 0.5, 0]]).tolist()
        [0.5, 0.5]
        """
        return self._made(_core.elongate(self._node, check.vector("lengths", lengths)))

    def twist(self, degrees: float, axis: AxisLetter = "y") -> Self:
        """Return the shape turned about an axis by an angle that grows along it.

        A lower bound of the distance whose slope the compiler bounds from how far the shape reaches from the axis.

        Parameters
        ----------
        degrees : float
            Angle per unit of length along the axis, right-handed.
        axis : {"x", "y", "z"}
            Through the origin. The shape must be bounded across it; along it, it may be endless.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type, `degrees` is not finite, `axis` another, or the shape is not bounded.

        Examples
        --------
        >>> import octomarch as om
        >>> column = om.box((1, 4, 1)).twist(45)
        >>> bool(column.distance([0.49, 1, 0.49]) > 0), bool(column.distance([0.69, 1, 0]) < 0)
        (True, True)
        >>> om.compile(column).lipschitz > 1
        True
        """
        return self._made(_core.twist(self._node, check.number("degrees", degrees), check.axis_number("axis", axis)))

    def bend(self, degrees: float) -> Self:
        """Return the shape bent in the x-y plane: each cut across x is turned about z by an angle that grows with x.

        With degrees > 0 a beam along x hangs down at both ends. A lower bound of the distance whose slope the compiler
        bounds from how far the shape reaches from the z axis.

        Parameters
        ----------
        degrees : float
            Angle per unit of length along x.

        Raises
        ------
        TypeError, ValueError
            If `degrees` is no number or not finite, or the shape is not bounded in x and y.

        Examples
        --------
        >>> import octomarch as om
        >>> arch = om.box((3, 0.2, 1)).bend(20)
        >>> bool(arch.distance([1.3, 0, 0]) > 0), bool(arch.distance([1.3, -0.65, 0]) < 0)
        (True, True)
        """
        return self._made(_core.bend(self._node, check.number("degrees", degrees)))

    # Of flat shapes --------------------------------------------------------------------------------------------------

    def extrude(self, height: float) -> Self:
        """Return the part of a flat shape between z = -height/2 and z = height/2, exact where the shape is.

        Flat shapes are the same at every z: those of `octomarch.circle`, `octomarch.rectangle` and their kin, and
        what is made of them without leaving the plane.

        Raises
        ------
        TypeError, ValueError
            If the height is no number, negative or not finite, or the shape is not flat.

        Examples
        --------
        >>> import octomarch as om
        >>> coin = om.circle(1.0).extrude(0.5)
        >>> coin.distance([[3, 0, 0], [0, 0, 1.25]]).tolist()
        [2.0, 1.0]
        """
        return self._made(_core.extrude(self._node, check.number("height", height)))

    def revolve(self, offset: float = 0.0) -> Self:
        """Return the solid that a flat shape sweeps about the y axis, after a move by `offset` along x.

        The field is that of the shape at ``(|(x, z)| - offset, y)``. What lies beyond the axis, at x < -offset, is cut
        off; exact where the shape is and nothing is cut, else a lower bound.

        Parameters
        ----------
        offset : float
            From the axis, at least 0.

        Raises
        ------
        TypeError, ValueError
            If the offset is no number, negative or not finite, or the shape is not flat.

        Examples
        --------
        >>> import octomarch as om
        >>> ring = om.circle(0.5).revolve(2.0)
        >>> ring.distance([[0, 0, 0], [0, 0, 4]]).tolist()
        [1.5, 1.5]
        """
        return self._made(_core.revolve(self._node, check.number("offset", offset)))
