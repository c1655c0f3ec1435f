"""Edges and corners of meshes: marching cubes cuts them off, and here they come back.

`meshing` comes before. Where the normals of a triangle differ, the planes of the surface around the patch that it
belongs to, within its cell, are taken to where they meet; the patch becomes a fan about that point, and edges between
two fans are turned along the crease [1]_. Rims of patches stay as they are, so that the mesh stays closed. Points count
in cells.

.. [1] L. P. Kobbelt, M. Botsch, U. Schwanecke, H.-P. Seidel, "Feature sensitive surface extraction from volume data",
   SIGGRAPH 2001. doi:10.1145/383259.383265
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]

_FLATTEST = 0.9  # cosine of the angle between normals from which on there is a crease
_LEAST_SPREAD = 0.05  # of the planes' normals along an axis, in proportion to the largest, to decide where they meet
_SAME = 1e-4  # cells
_BESIDE = 0.3  # cells by which a crease's point may lie beside its own


@dataclass
class _Rims:
    """Edges around patches: of each the patch, and the vertices from which and to which it runs."""

    count: int
    patch: Integers
    start: Integers
    end: Integers

    def of(self, chosen: Flags) -> _Rims:
        """Return the rims of the patches that are chosen, numbered anew."""
        kept = chosen[self.patch]
        number = np.cumsum(chosen) - 1
        return _Rims(int(chosen.sum()), number[self.patch[kept]], self.start[kept], self.end[kept])

    def sums(self, values: Floats) -> Floats:
        """Return the sum over each patch of what each edge of its rim has."""
        total = np.zeros((self.count, *values.shape[1:]))
        np.add.at(total, self.patch, values)
        return total

    def sides(self) -> Integers:
        """Return the number of edges around each patch."""
        return np.bincount(self.patch, minlength=self.count)


def with_creases(
    vertices: Floats, normals: Floats, faces: Integers, project: Callable[[Floats], tuple[Floats, Flags]]
) -> tuple[Floats, Integers]:
    """Return points on creases, to follow the vertices, and all triangles.

    Parameters
    ----------
    vertices, normals : ndarray, shape (n, 3)
        On edges of cells, in whose edge they count, and the surface's unit normals there.
    faces : ndarray, shape (m, 3)
        Triangles, each within a cell.
    project : callable
        Takes points to the surface, and tells where that was possible.

    Examples
    --------
    >>> corner = np.eye(3) * 0.5 + 0.25  # three faces of a cube meet at (0.75, 0.75, 0.75)
    >>> points, faces = with_creases(corner, np.eye(3), np.array([[0, 1, 2]]), lambda p: (p, p[:, 0] > 0))
    >>> points.tolist(), len(faces)
    ([[0.75, 0.75, 0.75]], 3)
    """
    near, patch = _patches(vertices, normals, faces)
    rims = _rims(faces[near], patch)
    chosen = _are_discs(rims, patch)
    rims = rims.of(chosen)
    points = _meeting_points(rims, vertices, normals)
    points, found = project(points)
    middle = rims.sums(vertices[rims.start]) / np.maximum(rims.sides(), 1)[:, np.newaxis]
    beside = np.abs(points - np.floor(middle) - 0.5).max(axis=1) - 0.5
    found &= (beside <= _BESIDE) & _first_of_equals(points, beside)
    while True:  # until no triangle looks inward: most times once or twice
        rims, points = rims.of(found), points[found]
        chosen[chosen] = found
        fans, inward = _fans(rims, np.concatenate([vertices, points]), normals)
        found = np.bincount(rims.patch[inward], minlength=rims.count) == 0
        if found.all():
            break
    kept = np.ones(len(faces), dtype=bool)
    kept[near] = ~chosen[patch]
    return points, np.concatenate([faces[kept], fans])


def _patches(vertices: Floats, normals: Floats, faces: Integers) -> tuple[Integers, Integers]:
    """Return which triangles lie in cells that a crease passes, and the number of each one's connected patch there."""
    from scipy.sparse import coo_array  # here, as all that the extra brings
    from scipy.sparse.csgraph import connected_components

    cells = np.floor(vertices[faces].mean(axis=1)).astype(np.int64)
    cell = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(axis=0) + 1))
    around = normals[faces]
    bent = (np.einsum("ijk,ijk->ij", around, np.roll(around, 1, axis=1)) < _FLATTEST).any(axis=1)
    near = np.flatnonzero(np.isin(cell, cell[bent]))
    _, cell_number = np.unique(cell[near], return_inverse=True)
    corners, place = np.unique(cell_number[:, np.newaxis] * len(vertices) + faces[near], return_inverse=True)
    place = place.reshape(-1, 3)
    pairs = np.concatenate([place[:, :2], place[:, 1:]])
    links = coo_array((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(len(corners),) * 2)
    _, label = connected_components(links, directed=False)
    return near, label[place[:, 0]].astype(np.int64)


def _rims(faces: Integers, patch: Integers) -> _Rims:
    """Return the edges that have a triangle of their patch on one side only."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    of = np.repeat(patch, 3)
    ends = np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)
    _, edge = np.unique(ends, return_inverse=True)
    _, place, times = np.unique(of * (len(edge) + 1) + edge, return_inverse=True, return_counts=True)
    outer = times[place] == 1
    return _Rims(int(patch.max(initial=-1)) + 1, of[outer], start[outer], end[outer])


def _are_discs(rims: _Rims, patch: Integers) -> Flags:
    """Tell which patches are discs without a vertex inside: n triangles, and n + 2 edges around them, once each way."""
    triangles = np.bincount(patch, minlength=rims.count)
    _, first = np.unique(rims.patch * (int(rims.start.max(initial=0)) + 1) + rims.start, return_index=True)
    distinct = np.bincount(rims.patch[first], minlength=rims.count)
    found: Flags = (rims.sides() == triangles + 2) & (distinct == triangles + 2)
    return found


def _meeting_points(rims: _Rims, vertices: Floats, normals: Floats) -> Floats:
    """Return the points nearest to the planes of each rim's vertices; of several the one nearest to their middle."""
    n, p = normals[rims.start], vertices[rims.start]
    middle = rims.sums(p) / np.maximum(rims.sides(), 1)[:, np.newaxis]
    height = np.einsum("ij,ij->i", n, p - middle[rims.patch])
    values, axes = np.linalg.eigh(rims.sums(n[:, :, np.newaxis] * n[:, np.newaxis, :]))
    along = np.einsum("kij,ki->kj", axes, rims.sums(n * height[:, np.newaxis]))
    steps = np.divide(along, values, out=np.zeros_like(along), where=values > _LEAST_SPREAD * values[:, 2:])
    found: Floats = middle + np.einsum("kij,kj->ki", axes, steps)
    return found


def _first_of_equals(points: Floats, rank: Floats) -> Flags:
    """Tell which points are the first in rank of those that lie in the same place: neighbours may find one corner."""
    order = np.argsort(rank, kind="stable")
    _, first = np.unique(np.rint(points[order] / _SAME), axis=0, return_index=True)
    found = np.zeros(len(points), dtype=bool)
    found[order[first]] = True
    return found


def _across(points: Floats, faces: Integers) -> Floats:
    """Return normals of triangles, as long as twice their area."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    normals: Floats = np.cross(b - a, c - a)
    return normals


def _fans(rims: _Rims, points: Floats, normals: Floats) -> tuple[Integers, Flags]:
    """Return a triangle for each edge of a rim, and which of them look inward.

    An edge between two fans is turned, so that it joins their points: the last ones of `points`.
    """
    fans = np.stack([rims.start, rims.end, rims.patch + len(normals)], axis=1)
    one, other = _opposed(rims)
    (a, b, f), g = fans[one].T, fans[other, 2]
    first, second = np.stack([f, a, g], axis=1), np.stack([g, b, f], axis=1)
    pair = np.minimum(f, g) * len(points) + np.maximum(f, g)
    _, place, times = np.unique(pair, return_inverse=True, return_counts=True)
    turns = times[place] == 1  # two would make the same edge twice
    for triangles, end in ((first, a), (second, b)):
        turns &= np.einsum("ij,ij->i", _across(points, triangles), normals[end]) > 0
    inward = np.einsum("ij,ij->i", _across(points, fans), normals[rims.start] + normals[rims.end]) < 0
    for triangles, turned in ((first, one[turns]), (second, other[turns])):
        fans[turned] = triangles[turns]
        inward[turned] = False
    return fans, inward


def _opposed(rims: _Rims) -> tuple[Integers, Integers]:
    """Return pairs of edges that run between the same vertices, one there and one back."""
    low, high = np.minimum(rims.start, rims.end), np.maximum(rims.start, rims.end)
    order = np.lexsort((high, low))
    same = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
    one, other = order[:-1][same], order[1:][same]
    opposed = rims.start[one] == rims.end[other]
    return one[opposed], other[opposed]
