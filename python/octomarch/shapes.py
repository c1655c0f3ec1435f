"""`Shape`: an immutable signed distance field, and the algebra on it.

A shape holds one node of the native graph. `primitives` makes the first ones, operators make new ones that share what
is common, `program` compiles them, and `render` and `queries` run the result.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Never, overload

import numpy as np

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import AxisLike, VectorLike
from octomarch.materials import Material
from octomarch.queries import Field


class Shape(Field):
    """A solid given by its signed distance field: negative inside, positive outside.

    Shapes are made by functions such as `octomarch.sphere` and combined by operators. They never change: each
    operation returns a new shape. Equal shapes, built the same way from equal parameters, compare equal.

    ========================  ===================================================
    ``a | b``                 union, `union` with ``smooth=k`` blends
    ``a & b``                 intersection
    ``a - b``                 difference
    ``~a``                    complement: inside and outside change places
    ========================  ===================================================

    Examples
    --------
    >>> import octomarch as om
    >>> ball = om.sphere(1.0)
    >>> dice = ball & om.box(1.5)
    >>> dice == om.sphere(1.0) & om.box(1.5)
    True
    >>> float((ball - om.box(1.0)).distance([0, 0, 0]))
    0.5
    """

    __slots__ = ()
    __array_ufunc__: ClassVar[None] = None  # so that `array | shape` is a TypeError, not an array of shapes

    def __init__(self, node: _core.Node) -> None:
        if not isinstance(node, _core.Node):
            raise TypeError(f"shapes are made by om.sphere(), om.box(), …; got {check.shown(node)}")
        check.set_fields(self, _node=node, _program=None)

    def __setattr__(self, name: str, value: object) -> Never:
        raise AttributeError(f"shapes are immutable: cannot set {name!r}")

    def __delattr__(self, name: str) -> Never:
        raise AttributeError(f"shapes are immutable: cannot delete {name!r}")

    def __copy__(self) -> Shape:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Shape:
        return self

    def __eq__(self, other: object) -> bool:
        return self._node == other._node if isinstance(other, Shape) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._node)

    def __repr__(self) -> str:
        count = self._node.node_count
        return f"<Shape {self._node.kind}, {count} node{'s' * (count != 1)}>"

    def _repr_png_(self) -> bytes | None:
        """Show a small picture in notebooks, framed and lit by default."""
        from octomarch.render import render  # here, since rendering builds on this module

        return render(self, size=(480, 360))._repr_png_()

    # Combinations ----------------------------------------------------------------------------------------------------

    def __or__(self, other: Shape) -> Shape:
        return self.union(other) if isinstance(other, Shape) else NotImplemented

    def __and__(self, other: Shape) -> Shape:
        return self.intersection(other) if isinstance(other, Shape) else NotImplemented

    def __sub__(self, other: Shape) -> Shape:
        return self.difference(other) if isinstance(other, Shape) else NotImplemented

    def __invert__(self) -> Shape:
        return Shape(_core.complement(self._node))

    def union(self, *others: Shape, smooth: float = 0.0) -> Shape:
        """Return all that lies in any of the shapes; see `octomarch.union`."""
        return combine("union", (self, *others), smooth)

    def intersection(self, *others: Shape, smooth: float = 0.0) -> Shape:
        """Return all that lies in every one of the shapes; see `octomarch.intersection`."""
        return combine("intersection", (self, *others), smooth)

    def difference(self, *others: Shape, smooth: float = 0.0) -> Shape:
        """Return this shape without the others; see `octomarch.difference`."""
        return combine("difference", (self, *others), smooth)

    # Placement and paint ---------------------------------------------------------------------------------------------

    @overload
    def translate(self, x: VectorLike, /) -> Shape: ...

    @overload
    def translate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Shape: ...

    def translate(self, x: float | VectorLike = 0.0, y: float = 0.0, z: float = 0.0) -> Shape:
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
            offset = check.vector("offset", x)
        else:
            raise TypeError(f"offset must be one vector or three numbers, got {check.shown((x, y, z))}")
        return Shape(_core.translate(self._node, offset))

    def rotate(self, degrees: float, axis: AxisLike = "y") -> Shape:
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
        return Shape(_core.rotate(self._node, check.number("degrees", degrees), check.axis("axis", axis)))

    def scale(self, factor: float) -> Shape:
        """Return the shape enlarged by `factor` > 0 about the origin; distances stay exact.

        Raises
        ------
        TypeError, ValueError
            If the factor is no number, not finite, or not above zero.

        Examples
        --------
        >>> import octomarch as om
        >>> float(om.sphere(1.0).scale(2).distance([5, 0, 0]))
        3.0
        """
        return Shape(_core.scale(self._node, check.number("factor", factor)))

    def repeat(self, period: float | Sequence[float | None], counts: int | Sequence[int | None] | None = None) -> Shape:
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

        Examples
        --------
        >>> import octomarch as om
        >>> row = om.sphere(0.3).repeat((1, None, None), counts=(3, None, None))
        >>> row.distance([[1, 0, 0], [2, 0, 0]]).round(6).tolist()
        [-0.3, 0.7]
        """
        periods = [period] * 3 if not np.iterable(period) else check.sequence("period", period, "three numbers")
        copies = [counts] * 3 if not np.iterable(counts) else check.sequence("counts", counts, "three integers")
        if len(periods) != 3:
            raise ValueError(f"period must be one number or three, got {check.shown(period)}")
        if len(copies) != 3:
            raise ValueError(f"counts must be one integer or three, got {check.shown(counts)}")
        steps = [0.0 if p is None else check.number("period", p) for p in periods]
        numbers = [0 if n is None else check.integer("counts", n, 0) for n in copies]
        return Shape(_core.repeat(self._node, steps, numbers))

    def paint(self, material: Material) -> Shape:
        """Return the shape made of `material`; where paints nest, the innermost wins.

        Raises
        ------
        TypeError
            If `material` is no `Material`.

        Examples
        --------
        >>> import octomarch as om
        >>> red = om.Material(color=(0.8, 0.1, 0.1))
        >>> om.compile(om.sphere(1.0).paint(red)).materials == [red]
        True
        """
        if not isinstance(material, Material):
            raise TypeError(f"material must be an om.Material, got {check.shown(material)}")
        return Shape(_core.paint(self._node, material._native()))


def combine(kind: str, shapes: Sequence[Shape], smooth: float) -> Shape:
    """Return the n-ary union, intersection or difference of shapes."""
    for shape in shapes:
        if not isinstance(shape, Shape):
            raise TypeError(f"shapes must be om.Shape, got {check.shown(shape)}")
    return Shape(_core.combine(kind, [shape._node for shape in shapes], check.number("smooth", smooth)))
