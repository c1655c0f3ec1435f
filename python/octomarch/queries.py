"""Queries of a field on numpy arrays: distances, gradients, rays. `shapes.Shape` inherits them from `Field` here.

They run a compiled `program.Program`; pictures of whole scenes are the business of `render`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.march import March
from octomarch.program import Program
from octomarch.shading import Shading

Floats: TypeAlias = NDArray[np.floating[Any]]
HitPlane: TypeAlias = Literal["t", "position", "normal", "object_id", "material_id", "steps", "status"]

HIT_PLANES: tuple[HitPlane, ...] = ("t", "position", "normal", "object_id", "material_id", "steps", "status")


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Hits:
    """What rays met, as arrays with the leading shape of the rays; made by `Shape.raycast`.

    A plane left out of the query raises `AttributeError`.

    Examples
    --------
    >>> import octomarch as om
    >>> hits = om.sphere(1.0).raycast([[0, 0, 3], [0, 3, 0]], [0, 0, -2])
    >>> hits.t.tolist()
    [1.0, inf]
    >>> hits.status == om.Status.HIT
    array([ True, False])
    """

    t: Floats
    """Ray parameter (...,), in lengths of the direction; +inf where nothing is met."""
    position: Floats
    """Points met (..., 3) in scene units; 0 where nothing is met."""
    normal: Floats
    """Unit normals (..., 3), pointing outward; 0 where nothing is met."""
    object_id: NDArray[np.int32]
    """Index in `Program.objects` (...,); -1 where nothing is met."""
    material_id: NDArray[np.int32]
    """Index in `Program.materials` (...,); -1 where nothing is met."""
    steps: NDArray[np.int32]
    """Evaluations of the field spent on each ray (...,)."""
    status: NDArray[np.uint8]
    """What became of each ray (...,): see `Status`."""

    def __init__(self, planes: dict[str, NDArray[Any]]) -> None:
        check.set_fields(self, **planes)

    def __getattr__(self, name: str) -> Any:
        if name in HIT_PLANES:
            raise AttributeError(f"{name} was not asked for: add {name!r} to the planes of raycast()")
        raise AttributeError(f"Hits has no attribute {name!r}")

    def __repr__(self) -> str:
        names = [field.name for field in dataclasses.fields(self) if field.name in vars(self)]
        shape = next(iter(vars(self).values())).shape[: -1 if names[0] in ("position", "normal") else None]
        return f"<Hits of shape {shape}: {', '.join(names)}>"


class Field:
    """What can be evaluated in space. Base of `Shape`; holds a node and, once it is needed, its program."""

    __slots__ = ("_node", "_program")

    _node: _core.Node
    _program: Program | None

    def __init__(self, node: _core.Node) -> None:
        object.__setattr__(self, "_node", node)
        object.__setattr__(self, "_program", None)

    def _made(self, node: _core.Node) -> Self:
        """Return another of the same kind."""
        return type(self)(node)

    def _compiled(self) -> Program:
        if self._program is None:
            object.__setattr__(self, "_program", Program(_core.compile(self._node)))
        assert self._program is not None
        return self._program

    def distance(
        self,
        points: ArrayLike,
        *,
        precision: Precision = "float64",
        threads: int | None = None,
        isa: str | None = None,
    ) -> Floats:
        """Evaluate the field: a lower bound of the distance to the surface, negative inside.

        The bound is the distance itself for primitives and for their unions seen from outside.

        Parameters
        ----------
        points : array_like of float, shape (..., 3)
            World frame, scene units. A point with a NaN gives NaN.
        precision : {"float64", "float32"}
            Arithmetic, and type of the result.
        threads : int, optional
            Threads at the most; None for all cores.
        isa : str, optional
            One of `octomarch.isas`; None for the best, or what the environment's OCTOMARCH_ISA says.

        Returns
        -------
        ndarray, shape (...,)
            In scene units.

        Raises
        ------
        TypeError, ValueError
            If `points` are no real numbers or their last axis is not 3; if an option is not among those there are.

        Examples
        --------
        >>> import octomarch as om
        >>> om.box(2.0).distance([[0, 0, 0], [2, 0, 0], [4, 5, 1]]).tolist()
        [-1.0, 1.0, 5.0]
        """
        return self._evaluate(_core.distance, points, precision, threads, isa)

    def gradient(
        self,
        points: ArrayLike,
        *,
        precision: Precision = "float64",
        threads: int | None = None,
        isa: str | None = None,
    ) -> Floats:
        """Evaluate the exact gradient of the field, by forward differentiation.

        On a surface it points along the outward normal. Parameters and errors are those of `distance`.

        Returns
        -------
        ndarray, shape (..., 3)
            Not normalised: its length is at most `Program.lipschitz`.

        Examples
        --------
        >>> import octomarch as om
        >>> om.sphere(1.0).gradient([0, 3, 4]).round(6).tolist()
        [0.0, 0.6, 0.8]
        """
        return self._evaluate(_core.gradient, points, precision, threads, isa)

    def color(
        self,
        points: ArrayLike,
        *,
        precision: Precision = "float64",
        threads: int | None = None,
        isa: str | None = None,
    ) -> Floats:
        """Find the colour of what the shape is made of at points on its surface.

        That of the paint that shows there, blended where shapes blend, without any light. Away from the surface it is
        what the nearest operand is made of. Parameters and errors are those of `distance`.

        Returns
        -------
        ndarray, shape (..., 3)
            Linear RGB ≥ 0.

        Examples
        --------
        >>> import octomarch as om
        >>> red, blue = om.Material(color=(1, 0, 0)), om.Material(color=(0, 0, 1))
        >>> pair = om.sphere(1.0).paint(red) | om.box(1.0).translate(3, 0, 0).paint(blue)
        >>> pair.color([[0, 1, 0], [3, 0.5, 0]]).tolist()
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        """
        where = check.points("points", points).reshape(-1, 3)
        slopes = self.gradient(where, threads=threads, isa=isa)
        length = np.linalg.norm(slopes, axis=-1, keepdims=True)
        normals = np.divide(slopes, length, out=np.zeros_like(slopes), where=length > 0)
        options = check.precision(precision), check.threads(threads), check.isa(isa)
        found = _core.material(self._compiled()._native, where, normals, *options)
        return found[:, :3].reshape(np.shape(points))

    def raycast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        march: March | None = None,
        t_max: float = math.inf,
        planes: HitPlane | Sequence[HitPlane] | Sequence[str] = HIT_PLANES,
        precision: Precision = "float64",
        threads: int | None = None,
        isa: str | None = None,
    ) -> Hits:
        """Find the first surface along each ray by sphere tracing.

        Parameters
        ----------
        origins, directions : array_like of float, shape (..., 3)
            World frame, scene units; the shapes are broadcast. Directions need not be unit: `t` counts in their
            length. Rays that are not finite, or of zero direction, are `Status.INVALID`.
        march : March, optional
            Method, step limit and tolerances; None for the defaults.
        t_max : float
            Farthest ray parameter searched, > 0, besides the march's own max_distance.
        planes : sequence of str
            What to compute, of ``t position normal object_id material_id steps status``: all by default.
        precision, threads, isa
            As for `distance`.

        Returns
        -------
        Hits
            Arrays with the leading shape of the rays.

        Raises
        ------
        TypeError, ValueError
            If arrays hold no real numbers, their last axis is not 3, or their shapes do not broadcast; if an option
            is outside its range or not among those there are.

        Examples
        --------
        >>> import octomarch as om
        >>> hits = om.sphere(1.0).raycast([0, 0, 3], [0, 0, -1])
        >>> float(hits.t), hits.normal.tolist()
        (2.0, [0.0, 0.0, 1.0])
        """
        starts, aims, shape = _rays(origins, directions)
        march = March() if march is None else march
        if not isinstance(march, March):
            raise TypeError(f"march must be an om.March, got {check.shown(march)}")
        limit = check.number("t_max", t_max)
        if not limit > 0:
            raise ValueError(f"t_max must be > 0, got {check.shown(t_max)}")
        names = check.planes(planes, HIT_PLANES)
        options = check.precision(precision), names, check.threads(threads), check.isa(isa)
        program = self._compiled()
        native = march.resolve(program, origins, pixels=False)._native()
        normals = Shading().resolve(program)._native()
        found = _core.raycast(program._native, starts, aims, native, normals, limit, *options)
        return Hits({name: found[name].reshape(shape + found[name].shape[1:]) for name in names})

    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the corners (lo, hi) of an axis-aligned box that holds the solid, in scene units.

        The box may be wider than need be, and is infinite where the solid has no end.

        Examples
        --------
        >>> import octomarch as om
        >>> lo, hi = om.box((2, 4, 6)).translate(1, 0, 0).bounds()
        >>> lo.tolist(), hi.tolist()
        ([0.0, -2.0, -3.0], [2.0, 2.0, 3.0])
        """
        lo, hi = self._compiled().bounds
        return np.array(lo), np.array(hi)

    def _evaluate(
        self, kernel: Any, points: ArrayLike, precision: Precision, threads: int | None, isa: str | None
    ) -> Floats:
        where = check.points("points", points)
        options = check.precision(precision), check.threads(threads), check.isa(isa)
        values: Floats = kernel(self._compiled()._native, where.reshape(-1, 3), *options)
        return values.reshape(where.shape[:-1] + values.shape[1:])


def _rays(
    origins: ArrayLike, directions: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[int, ...]]:
    """Return origins and directions as (n, 3) arrays, and their common leading shape."""
    starts, aims = check.points("origins", origins), check.points("directions", directions)
    try:
        shape = np.broadcast_shapes(starts.shape, aims.shape)
    except ValueError:
        message = f"origins and directions must broadcast, got shapes {starts.shape} and {aims.shape}"
        raise ValueError(message) from None
    flat = [np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1, 3) for array in (starts, aims)]
    return flat[0], flat[1], shape[:-1]
