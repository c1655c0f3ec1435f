"""`from_mesh`: triangles as a shape, by their distances at the points of a grid.

`grids` comes before it; `meshing` goes the other way.
"""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch.grids import INTERPOLATIONS, Interpolation
from octomarch.meshing import Floats, Integers, libraries
from octomarch.shapes import Shape

if TYPE_CHECKING:
    import trimesh

FINEST = 1024
MARGIN = 2
"""Cells on each side of the mesh, unless `padding` says otherwise."""
_AT_ONCE = 1 << 15  # points that libigl is asked about in one call: a tenth of a second, which nothing interrupts


def from_mesh(
    mesh: trimesh.Trimesh | trimesh.Scene | str | PathLike[str],
    resolution: int = 64,
    padding: float | None = None,
    interpolation: Interpolation = "linear",
) -> Shape:
    """Return the solid within a closed mesh of triangles, as a `grid` of exact distances to these.

    Inside is where the mesh winds around a point [1]_, so parts may overlap and have cavities. What is thinner than a
    cell may get lost, and edges get round by about a cell.

    Parameters
    ----------
    mesh : trimesh.Trimesh, trimesh.Scene, str or path
        Or a file of one: STL, OBJ, PLY, GLB and whatever else trimesh reads. It must be closed.
    resolution : int
        Cells of the grid along the longest edge of the mesh's bounds, from 1 to 1024. Memory and time grow with its
        cube: for 5,000 triangles 64 take 1 MB and two seconds of a processor, 256 take 70 MB and a minute and a half;
        for 80,000 triangles four times as long.
    padding : float, optional
        How far the grid reaches beyond the mesh, at least 0; two cells for None. Within it distances are exact up to
        what lies between samples, beyond it they are lower bounds, see `grid`.
    interpolation : {"linear", "cubic"}
        As for `grid`.

    Returns
    -------
    Shape

    Raises
    ------
    ImportError
        If trimesh or libigl is missing; the extra ``octomarch[mesh]`` installs them.
    OSError
        If the file cannot be read.
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, the file holds no mesh, or the mesh is not closed: the
        message says how many holes there are, or that triangles disagree on where outside is, and what may mend it.

    References
    ----------
    .. [1] G. Barill, N. G. Dickson, R. Schmidt, D. I. W. Levin, A. Jacobson, "Fast winding numbers for soups and
       clouds", ACM TOG 37(4), 2018.

    Examples
    --------
    >>> import octomarch as om
    >>> part = om.box(2.0) - om.sphere(1.2)
    >>> again = om.from_mesh(part.mesh(32), resolution=32)
    >>> bool(abs(again.distance([0, 0, 0]) - 1.2) < 0.01)
    True
    """
    cells = check.integer("resolution", resolution, 1, FINEST)
    margin = None if padding is None else check.non_negative("padding", padding)
    kind: str = check.choice("interpolation", interpolation, INTERPOLATIONS)
    vertices, faces = _closed(*_triangles(mesh))
    lower, spacing, counts = _lattice(vertices, cells, margin)
    values = np.empty(counts + 1, dtype=np.float32)
    for layers, points in _slabs(lower, spacing, counts):
        values[layers] = _signed_distance(vertices, faces, points).reshape(-1, *(counts[1:] + 1))
    upper = lower + spacing * counts
    return Shape(_core.grid(values, tuple(lower.tolist()), tuple(upper.tolist()), kind))


def _triangles(mesh: Any) -> tuple[Floats, Integers]:
    """Return vertices and faces of a mesh or of a file's."""
    if isinstance(mesh, (str, PathLike)):
        mesh = _read(fspath(mesh))
    if hasattr(mesh, "to_mesh"):  # a scene: its parts where they stand
        mesh = mesh.to_mesh()
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        raise TypeError(f"mesh must be a trimesh.Trimesh or a file, got {check.shown(mesh)}")
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    faces = np.asarray(mesh.faces, dtype=np.int64)
    if not len(faces):
        raise ValueError("mesh must have triangles, got none")
    if not np.isfinite(vertices[faces]).all():
        raise ValueError("mesh must have finite vertices")
    return vertices, faces


def _read(file: str) -> Any:
    _, trimesh = libraries()
    with Path(file).open("rb"):  # what the system says of files that cannot be read
        pass
    try:
        return trimesh.load_mesh(file)
    except Exception as error:  # trimesh lets through whatever its readers raise
        raise ValueError(f"mesh must be a file that trimesh reads, got {file!r}: {error}") from error


def _closed(vertices: Floats, faces: Integers) -> tuple[Floats, Integers]:
    """Return a mesh whose triangles meet at shared vertices, or say where it is open.

    Files may give every triangle, or every seam of a texture, vertices of its own: those at one place count as one.
    """
    places, number = np.unique(vertices, axis=0, return_inverse=True)
    corners = number.reshape(-1)[faces]
    corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]  # without those that are a line or a point
    edges = np.concatenate([corners[:, [i, (i + 1) % 3]] for i in range(3)])
    ends, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    senses = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    uses = np.bincount(which.reshape(-1), minlength=len(ends))
    balance = np.bincount(which.reshape(-1), weights=senses, minlength=len(ends))
    is_open = uses % 2 == 1
    if is_open.any():
        holes = _components(ends[is_open])
        raise ValueError(
            f"mesh must be closed, got {np.count_nonzero(is_open)} edges without a second triangle, around {holes} "
            f"hole{'s' * (holes > 1)}; trimesh may close it: mesh.merge_vertices(digits_vertex=6), mesh.fill_holes()"
        )
    if (balance != 0).any():
        raise ValueError(
            f"mesh must have an inside, got {np.count_nonzero(balance)} edges whose triangles face opposite ways; "
            "trimesh may turn them: mesh.fix_normals()"
        )
    return places, corners


def _components(edges: Integers) -> int:
    """Return how many connected parts edges form."""
    parent: dict[int, int] = {}

    def root(vertex: int) -> int:
        while (above := parent.setdefault(vertex, vertex)) != vertex:
            parent[vertex] = parent[above]
            vertex = above
        return vertex

    for a, b in edges.tolist():
        parent[root(a)] = root(b)
    return sum(vertex == above for vertex, above in parent.items())


def _lattice(vertices: Floats, cells: int, padding: float | None) -> tuple[Floats, float, Integers]:
    """Return the lowest corner, the edge of a cell, and how many cells there are along each axis."""
    lo, hi = vertices.min(axis=0), vertices.max(axis=0)
    spacing = float((hi - lo).max()) / cells
    if not spacing > 0:
        raise ValueError("mesh must have an extent, got a point")
    margin = MARGIN * spacing if padding is None else padding
    counts = np.maximum(np.ceil((hi - lo + 2 * margin) / spacing - 1e-6), 1).astype(np.int64)
    if np.prod(counts + 1.0) >= 2**31:
        raise ValueError(f"padding must leave fewer than 2**31 samples, got {padding}")
    lower: Floats = lo + (hi - lo) / 2 - spacing * counts / 2
    return lower, spacing, counts


def _slabs(lower: Floats, spacing: float, counts: Integers) -> Iterator[tuple[slice, Floats]]:
    """Yield layers across x and their points, so many at a time as are asked about at once."""
    x, y, z = (lower[axis] + spacing * np.arange(counts[axis] + 1) for axis in range(3))
    step = max(1, _AT_ONCE // (len(y) * len(z)))
    for first in range(0, len(x), step):
        grid = np.meshgrid(x[first : first + step], y, z, indexing="ij")
        yield slice(first, first + step), np.stack(grid, axis=-1).reshape(-1, 3)


def _signed_distance(vertices: Floats, faces: Integers, points: Floats) -> NDArray[np.float64]:
    igl, _ = libraries()
    squared, _, _ = igl.point_mesh_squared_distance(points, vertices, faces)
    winding = igl.fast_winding_number(vertices, faces, points)
    distance: Floats = np.sqrt(squared)
    return np.where(np.abs(winding) > 0.5, -distance, distance)  # turned inside out, it has the same inside
