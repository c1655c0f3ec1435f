"""`Shape`: an immutable signed distance field, and the algebra on it.

A shape holds one node of the native graph. `primitives`, `solids`, `flat` and `surfaces` make the first ones,
operators make new ones that share what is common, `program` compiles them, and `render` and `queries` run the result.
Methods that place a shape are in `_placement`, those that change its form in `_deformation`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Never

from octomarch import _core
from octomarch import _validate as check
from octomarch._deformation import Deformation
from octomarch._placement import Placement
from octomarch._validate import VectorLike
from octomarch.materials import Material

if TYPE_CHECKING:
    import trimesh

    from octomarch.camera import AnyCamera
    from octomarch.march import March
    from octomarch.shading import Shading


class Shape(Placement, Deformation):
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
        super().__init__(node)

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

    # Paint -----------------------------------------------------------------------------------------------------------

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

    # Ways out --------------------------------------------------------------------------------------------------------

    def mesh(
        self,
        resolution: int = 128,
        *,
        bounds: tuple[VectorLike, VectorLike] | None = None,
        colors: Literal["srgb", "linear"] | None = "srgb",
        threads: int | None = None,
    ) -> trimesh.Trimesh:
        """Return the surface as triangles, for other programs: STL, PLY, OBJ, GLB.

        Vertices lie on the surface, have the exact normals of the field and the colours of the materials. The mesh is
        closed, and has the edges and corners of the shape. It is made by marching cubes from values near the surface
        alone, so that work grows with the square of `resolution`. Needs the extra ``mesh``: trimesh, libigl, scipy.

        Parameters
        ----------
        resolution : int
            Number of cells along the longest edge of the bounds, 2 to 4096. What is thinner than a cell may be lost.
        bounds : (lo, hi), optional
            Two corners of a box that the shape is cut to. Needed where `Shape.bounds` is infinite.
        colors : {"srgb", "linear"}, optional
            How vertex colours are encoded: as most programs take PLY and OBJ files, or as GLB files want them. None:
            there are none.
        threads : int, optional
            Threads at the most; None for all cores.

        Returns
        -------
        trimesh.Trimesh
            Its ``export`` writes files. ``metadata`` tells the ``spacing`` of the cells, how many ``evaluations`` of
            the field were made, and how many of them as ``cell_evaluations``: the others took vertices to the surface.

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range; if the shape has no end and no `bounds` are given,
            or no surface is found.
        ImportError
            If the extra is not installed.

        Notes
        -----
        Of an `octomarch.solid` there are no distances, so that every cell is looked at; its normals are those of the
        triangles.

        Examples
        --------
        >>> import octomarch as om, pathlib, tempfile
        >>> part = om.box(2.0) - om.cylinder(0.6, 3.0)
        >>> mesh = part.mesh(resolution=32)
        >>> mesh.is_watertight, round(float(mesh.volume), 1), bool(abs(part.distance(mesh.vertices)).max() < 1e-5)
        (True, 5.7, True)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     _ = mesh.export(pathlib.Path(folder, "part.stl"))
        """
        from octomarch.meshing import mesh  # here, since meshing builds on this module

        return mesh(self, resolution, bounds, colors, threads)

    def glsl(
        self,
        camera: AnyCamera | None = None,
        *,
        march: March | None = None,
        shading: Shading | None = None,
        size: tuple[int, int] = (640, 480),
    ) -> str:
        """Return a picture of the shape as a fragment shader, in the manner of ShaderToy; see `Scene.glsl`.

        The shape is lit as `octomarch.render` lights a shape alone.

        Parameters
        ----------
        camera, march, shading
            As for `octomarch.render`. Any method but ``"certified"``.
        size : (int, int)
            Width and height of the picture for which a camera is found where none is given.

        Returns
        -------
        str

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range.
        SceneError
            If something cannot be part of a shader, which is told: images of more than 4096 texels together, grids, a
            shape of more than 2048 nodes.

        Examples
        --------
        >>> import octomarch as om
        >>> shader = om.sphere(1.0).union(om.box(1.5), smooth=0.25).glsl()
        >>> "float union1 = smooth_union(sphere1, box1, 0.25);" in shader
        True
        """
        from octomarch.glsl import shader  # here, since it builds on this module

        return shader(self, camera, size, march, shading)


def combine(kind: str, shapes: Sequence[Shape], smooth: float) -> Shape:
    """Return the n-ary union, intersection, difference or metaballs of shapes."""
    for shape in shapes:
        if not isinstance(shape, Shape):
            raise TypeError(f"shapes must be om.Shape, got {check.shown(shape)}")
    return Shape(_core.combine(kind, [shape._node for shape in shapes], check.number("smooth", smooth)))


def placed(node: _core.Node, center: VectorLike) -> Shape:
    """Return the shape of a node about the origin, moved to `center`."""
    return Shape(_core.translate(node, check.point("center", center)))
