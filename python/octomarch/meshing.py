"""`mesh`: the surface of a shape as triangles. `Shape.mesh` calls it; `queries` answers what it asks of the field.

Space is cut into cells. Cubes of cells are halved, and those that the field's Lipschitz bound proves free of surface
are left out [1]_, so that values are known at the corners of cells near the surface only. Marching cubes [2]_
(libigl's) joins these cells; each vertex then goes along its cell's edge to the root of the field there. It never
leaves that edge, so the mesh stays as closed as marching cubes made it. `creases` brings edges and corners back.

.. [1] J. C. Hart, "Sphere tracing", The Visual Computer 12(10), 1996: the empty ball about a point.
.. [2] W. E. Lorensen, H. E. Cline, "Marching cubes", SIGGRAPH 1987.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch import png
from octomarch._validate import VectorLike
from octomarch.creases import with_creases
from octomarch.primitives import box

if TYPE_CHECKING:
    import trimesh

    from octomarch.shapes import Shape

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Bounds: TypeAlias = tuple[VectorLike, VectorLike]
Colors: TypeAlias = Literal["srgb", "linear"]

FINEST = 4096
_BLOCK = 64  # cells on a block's edge: what it holds is worked on at once
_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
_BESIDE = 1.5 + np.array([0.1213, 0.1481, 0.0917]) / math.sqrt(2)
_ROOM = 1 + 1e-9  # for roundings of distances and of cells' corners
_CLOSE = 1e-9  # of the grid's diagonal: a vertex is on the surface
_MOST_PROJECTIONS = 8
_MOST_STEPS = 60  # of the search along an edge, a third of which halve what is left


def mesh(
    shape: Shape, resolution: int, bounds: Bounds | None, colors: Colors | None, threads: int | None
) -> trimesh.Trimesh:
    """Return the surface of a shape as triangles; see `Shape.mesh`.

    Examples
    --------
    >>> import octomarch as om
    >>> mesh(om.box(2.0), 16, None, None, None).is_watertight
    True
    """
    cells = check.integer("resolution", resolution, 2, FINEST)
    check.choice("colors", colors, ("srgb", "linear", None))
    igl, trimesh = libraries()
    part, (lo, hi) = _bounded(shape, bounds)
    field = _Sampled(part, _Grid.about(lo, hi, cells), threads)
    lattice, values, corners = _near_surface(field)
    known = field.evaluations
    if not len(corners):
        raise ValueError(f"no surface was found between {_point(lo)} and {_point(hi)} at resolution={resolution}")
    crossings, faces, _ = igl.marching_cubes(values, lattice.astype(np.float64), corners, 0.0)
    start, end = np.floor(crossings), np.ceil(crossings)
    crossings = _on_surface(field, start, end, _looked_up(field, lattice, values, start, end))
    vertices = field.points(crossings)
    if not math.isinf(field.reach):
        slopes = _unit(part.gradient(vertices, threads=threads))
        points, faces = with_creases(crossings, slopes, faces, field.project)
        vertices = np.concatenate([vertices, field.points(points)])
    result = trimesh.Trimesh(vertices, faces, process=False)
    result.vertex_normals = _normals(part, vertices, result, threads)
    if colors is not None:
        linear = shape.color(vertices, threads=threads)
        result.visual.vertex_colors = png.levels(linear) if colors == "srgb" else _bytes(linear)
    result.metadata["evaluations"] = field.evaluations
    result.metadata["cell_evaluations"] = known
    result.metadata["spacing"] = field.grid.spacing
    return result  # type: ignore[no-any-return, unused-ignore]


def libraries() -> tuple[Any, Any]:
    """Return libigl and trimesh."""
    try:
        import igl
        import scipy.sparse  # noqa: F401  creases needs it
        import trimesh
    except ImportError as error:
        raise ImportError(f'meshes need {error.name}: pip install "octomarch[mesh]"', name=error.name) from None
    return igl, trimesh


def _point(point: VectorLike) -> str:
    return f"({', '.join(f'{float(number):.6g}' for number in point)})"


def _bounded(shape: Shape, bounds: Bounds | None) -> tuple[Shape, tuple[Floats, Floats]]:
    """Return the part of the shape between the bounds, and the box that holds it."""
    if bounds is not None:
        corners = check.sequence("bounds", bounds, "two corners")
        if len(corners) != 2:
            raise ValueError(f"bounds must be two corners, got {check.shown(bounds)}")
        lo, hi = (np.array(check.point(f"bounds[{i}]", corner)) for i, corner in enumerate(corners))
        if not (lo < hi).all():
            raise ValueError(f"bounds must be two corners (lo, hi) with lo < hi, got {check.shown(bounds)}")
        shape = box(hi - lo).translate(*(lo + hi) / 2) & shape  # in this order what is no number stays none
    lo, hi = shape.bounds()
    endless = [axis for axis, low, high in zip("xyz", lo, hi, strict=True) if not math.isfinite(high - low)]
    if endless:
        focus = shape._compiled().focus
        hint = "" if focus is None else f", such as bounds=({_point(focus[0])}, {_point(focus[1])})"
        raise ValueError(f"bounds must be given, since the shape has no end along {', '.join(endless)}{hint}")
    if not (lo < hi).all():
        raise ValueError(f"no surface was found: the shape is empty, or flat, between {_point(lo)} and {_point(hi)}")
    return shape, (lo, hi)


@dataclass(frozen=True)
class _Grid:
    """Cubic cells; a lattice point is a corner of cells."""

    origin: Floats
    spacing: float
    counts: Integers

    @classmethod
    def about(cls, lo: Floats, hi: Floats, resolution: int) -> _Grid:
        """Return `resolution` cells along the longest edge, and between one and two beyond on each side.

        The share of a cell is no number that people choose: no face of the solid should lie just on lattice points,
        where roundings would decide on which side of it they are, and crowd vertices there.
        """
        spacing = float((hi - lo).max()) / resolution
        counts = np.ceil((hi - lo) / spacing - 1e-6).astype(np.int64)
        middle = lo + (hi - lo) / 2
        return cls(middle - spacing * (counts / 2 + _BESIDE), spacing, counts + 3)

    @property
    def diagonal(self) -> float:
        return self.spacing * float(np.linalg.norm(self.counts))


class _Sampled:
    """A field at lattice points, and how often it was asked."""

    def __init__(self, shape: Shape, grid: _Grid, threads: int | None) -> None:
        program = shape._compiled()
        self.grid = grid
        self.reach = math.inf if program.is_solid else program.lipschitz * grid.spacing * _ROOM
        self.evaluations = 0
        self._shape = shape
        self._threads = threads

    def points(self, lattice: NDArray[Any]) -> Floats:
        found: Floats = self.grid.origin + self.grid.spacing * lattice
        return found

    def __call__(self, lattice: NDArray[Any]) -> Floats:
        """Return the field, ≤ 0 inside, at lattice points or between them."""
        points = self.points(lattice)
        values: Floats = self._shape.distance(points, threads=self._threads).astype(np.float64, copy=False)
        self.evaluations += len(points)
        unknown = np.isnan(values)
        if unknown.any():
            raise ValueError(f"the shape has no distance at {_point(points[unknown][0])}: its field is no number there")
        return values

    def project(self, lattice: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Take points between lattice points to the surface, by Newton's steps; tell which have come there."""
        close = _CLOSE * self.grid.diagonal
        found = lattice.copy()
        values = self(found)
        for _ in range(_MOST_PROJECTIONS):
            far = np.flatnonzero(np.abs(values) > close)
            if not len(far):
                break
            slopes = self._shape.gradient(self.points(found[far]), threads=self._threads)
            square = np.einsum("ij,ij->i", slopes, slopes)
            steps = np.divide(values[far], square, out=np.zeros(len(far)), where=square > 0) / self.grid.spacing
            found[far] -= np.clip(steps, -1.0, 1.0)[:, np.newaxis] * slopes
            values[far] = self(found[far])
        return found, np.abs(values) <= close

    def may_cross(self, cubes: Integers, size: int) -> NDArray[np.bool_]:
        """Tell which cubes of `size` cells, given by their lowest corners, may hold surface."""
        if math.isinf(self.reach):
            return np.ones(len(cubes), dtype=bool)
        within: NDArray[np.bool_] = np.abs(self(cubes + size / 2)) <= self.reach * size * math.sqrt(3) / 2
        return within


def _near_surface(field: _Sampled) -> tuple[Integers, Floats, Integers]:
    """Return lattice points, the field there, and the corners among them of each cell that the surface crosses."""
    found = [_crossed(field, block) for block in _blocks(field)]
    ids = np.concatenate([block_ids for block_ids, _, _ in found]) if found else np.empty(0, np.int64)
    unique, first, place = np.unique(ids, return_index=True, return_inverse=True)
    starts = itertools.accumulate((len(block_ids) for block_ids, _, _ in found), initial=0)
    corners = [place[start + cells] for start, (_, _, cells) in zip(starts, found, strict=False)]
    values = np.concatenate([values for _, values, _ in found])[first] if found else np.empty(0)
    lattice = np.stack(np.unravel_index(unique, field.grid.counts + 1), axis=-1)
    return lattice, values, np.concatenate(corners) if found else np.empty((0, 8), np.int64)


def _blocks(field: _Sampled) -> Integers:
    """Return the lowest corners of the blocks that may hold surface."""
    counts = field.grid.counts
    size = _BLOCK * 2 ** max(0, math.ceil(math.log2(counts.max() / _BLOCK)) - 1)
    cubes = np.stack(np.meshgrid(*(np.arange(0, n, size) for n in counts), indexing="ij"), axis=-1).reshape(-1, 3)
    while True:
        cubes = cubes[field.may_cross(cubes, size)]
        if size == _BLOCK:
            return cubes
        size //= 2
        cubes = _halved(cubes, size, counts)


def _halved(cubes: Integers, size: int, counts: Integers) -> Integers:
    parts: Integers = (cubes[:, np.newaxis] + size * _CORNERS).reshape(-1, 3)
    return parts[(parts < counts).all(axis=1)]


def _crossed(field: _Sampled, block: Integers) -> tuple[Integers, Floats, Integers]:
    """Return the same of one block, its lattice points by their numbers."""
    size, cubes = _BLOCK, block[np.newaxis]
    while size > 1:
        size //= 2
        cubes = _halved(cubes, size, field.grid.counts)
        cubes = cubes[field.may_cross(cubes, size)]
    edge = _BLOCK + 1
    steps = np.array([edge * edge, edge, 1])
    ids = (cubes - block) @ steps
    corners, known = _numbered(ids[:, np.newaxis] + _CORNERS @ steps, edge**3)
    lattice = block + np.stack(np.unravel_index(known, (edge, edge, edge)), axis=-1)
    values = field(lattice) if len(known) else np.empty(0)
    inside = (values <= 0)[corners]
    corners, used = _numbered(corners[inside.any(axis=1) & ~inside.all(axis=1)], len(known))
    numbers = np.ravel_multi_index(tuple(lattice[used].T), tuple(field.grid.counts + 1))
    return numbers.astype(np.int64), values[used], corners


def _numbered(ids: Integers, count: int) -> tuple[Integers, Integers]:
    """Return ids below `count` as places in the ascending list of those that occur, and that list."""
    occurs = np.zeros(count, dtype=bool)
    occurs[ids] = True
    known = np.flatnonzero(occurs)
    places = np.zeros(count, dtype=np.int64)
    places[known] = np.arange(len(known))
    return places[ids], known


def _looked_up(field: _Sampled, lattice: Integers, values: Floats, *wanted: Floats) -> list[Floats]:
    """Return the values at wanted ones of the lattice points, which ascend."""
    shape = tuple(field.grid.counts + 1)
    known = np.ravel_multi_index(tuple(lattice.T), shape)
    numbers = (np.ravel_multi_index(tuple(points.T.astype(np.int64)), shape) for points in wanted)
    return [values[np.searchsorted(known, number)] for number in numbers]


def _on_surface(field: _Sampled, start: Floats, end: Floats, values: list[Floats]) -> Floats:
    """Return, in cells, where the field has its roots between lattice points whose values are known.

    Secants find them. After the second of two the end that stayed counts half, as the Illinois method does it, and
    every third step halves what is left, so that fields which jump come to an end as well.
    """
    at_start, at_end = values
    low, high, best = np.zeros(len(start)), np.ones(len(start)), np.zeros(len(start))
    close = 0.0 if math.isinf(field.reach) else _CLOSE * field.grid.diagonal
    best[np.abs(at_end) <= close] = 1.0
    active = np.flatnonzero((np.abs(at_start) > close) & (np.abs(at_end) > close))
    for step in range(_MOST_STEPS):
        a, b = at_start[active], at_end[active]
        share = 0.5 if step % 3 == 2 or math.isinf(field.reach) else a / (a - b)
        t = low[active] + (high[active] - low[active]) * share
        value = field(start[active] + (end - start)[active] * t[:, np.newaxis])
        best[active] = t
        with_start = (value <= 0) == (a <= 0)
        later, earlier = active[with_start], active[~with_start]
        low[later], at_start[later] = t[with_start], value[with_start]
        high[earlier], at_end[earlier] = t[~with_start], value[~with_start]
        if step % 3 == 1:
            at_end[later] /= 2
            at_start[earlier] /= 2
        active = active[(np.abs(value) > close) & (high[active] - low[active] > _CLOSE)]
        if not len(active):
            break
    found: Floats = start + (end - start) * best[:, np.newaxis]
    return found


def _normals(shape: Shape, vertices: Floats, faces: trimesh.Trimesh, threads: int | None) -> Floats:
    """Return unit gradients; where there is none, as on solids, what the faces around a vertex say."""
    normals = _unit(shape.gradient(vertices, threads=threads))
    missing = ~normals.any(axis=1)
    if missing.any():
        normals[missing] = faces.vertex_normals[missing]
    return normals


def _unit(gradient: NDArray[Any]) -> Floats:
    """Return gradients at unit length, 0 where there is none."""
    length = np.linalg.norm(gradient, axis=-1, keepdims=True)
    usable = np.isfinite(length) & (length > 0)
    normals: Floats = np.divide(gradient, length, out=np.zeros_like(gradient), where=usable)
    return normals


def _bytes(colors: NDArray[Any]) -> NDArray[np.uint8]:
    levels: NDArray[np.uint8] = np.rint(255 * np.clip(colors, 0, 1)).astype(np.uint8)
    return levels
