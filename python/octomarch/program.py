"""The compiled program of a shape: what `queries` and `render` run, and what `print` lists.

Nodes come before it (`shapes`); the compiler itself is native (cpp/octomarch/program).
"""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Vec3
from octomarch.materials import Material

if TYPE_CHECKING:
    from octomarch.scene import Scene
    from octomarch.shapes import Shape


class Program:
    """A shape compiled to a flat list of instructions; made by `octomarch.compile`.

    ``str(program)`` is its listing. Distances come from one program, ids and materials from a second one that runs
    once per hit.

    Examples
    --------
    >>> import octomarch as om
    >>> program = om.compile(om.sphere(1.0) | om.box(1.5))
    >>> program.bounds
    ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    >>> program.lipschitz
    1.0
    """

    __slots__ = ("_native",)

    def __init__(self, native: _core.Program) -> None:
        self._native = native

    def __str__(self) -> str:
        return self._native.listing()

    def __repr__(self) -> str:
        return f"<Program of {self.instructions} instructions over {self.registers} registers>"

    @property
    def lipschitz(self) -> float:
        """Bound of the field's slope: no step may be longer than the field divided by it."""
        return self._native.lipschitz

    @property
    def bounds(self) -> tuple[Vec3, Vec3]:
        """Corners (lo, hi) of a box that holds the solid; components are infinite where it has no end."""
        return self._native.bounds

    @property
    def focus(self) -> tuple[Vec3, Vec3] | None:
        """Corners (lo, hi) of a box about the bounded parts: what a camera should see. None: nothing is bounded."""
        return self._native.focus

    @property
    def anchor(self) -> Vec3:
        """Where the program's coordinates count from: the origin, or the middle of a focus that is far from it."""
        return self._native.anchor

    @property
    def size(self) -> float:
        """Diagonal of the focus in scene units; 1 when there is none or it is a single point."""
        if self.focus is None:
            return 1.0
        return min(math.dist(*self.focus) or 1.0, sys.float_info.max)

    @property
    def is_solid(self) -> bool:
        """Is a part of the shape known by no more than its inside (`octomarch.solid`)? Then it is marched by steps."""
        return self._native.is_solid

    @property
    def instructions(self) -> int:
        """Number of instructions of the distance program."""
        return self._native.instructions

    @property
    def registers(self) -> int:
        """Number of registers, each of one number per lane, that the distance program needs."""
        return self._native.registers

    @property
    def attribute_instructions(self) -> int:
        """Number of instructions of the program for ids and materials."""
        return self._native.attribute_instructions

    @property
    def materials(self) -> list[Material]:
        """Distinct materials; the planes ``material_id`` count in this list."""
        return [Material._from_native(material) for material in self._native.materials]

    @property
    def objects(self) -> list[tuple[str, int]]:
        """Kind and material of each placed primitive; the planes ``object_id`` count in this list."""
        return self._native.objects


def program_of(name: str, value: object) -> Program:
    """Return `value` if it is a program.

    Examples
    --------
    >>> import octomarch as om
    >>> program_of("program", om.sphere(1.0))
    Traceback (most recent call last):
    TypeError: program must be what om.compile returns, got <Shape sphere, 1 node>
    """
    if not isinstance(value, Program):
        raise TypeError(f"{name} must be what om.compile returns, got {check.shown(value)}")
    return value


def compile(shape: Shape | Scene) -> Program:
    """Compile a shape, or the shape of a scene.

    Parameters
    ----------
    shape : Shape or Scene
        What to compile. A shape is compiled once and remembers its program.

    Returns
    -------
    Program

    Raises
    ------
    TypeError
        If `shape` is neither.
    SceneError
        If the program would need more than the marcher has.

    Examples
    --------
    >>> import octomarch as om
    >>> om.compile(om.sphere(1.0)).instructions
    1
    """
    from octomarch.scene import Scene  # here, since both modules build on this one
    from octomarch.shapes import Shape

    if isinstance(shape, Scene):
        shape = shape.shape
    if not isinstance(shape, Shape):
        raise TypeError(f"shape must be an om.Shape or om.Scene, got {check.shown(shape)}")
    return shape._compiled()
