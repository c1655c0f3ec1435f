"""Closed outlines in the plane: which cross, which lie in which, and what they enclose together.

`flat` and `outlines` make polygons of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ring = NDArray[np.float64]
"""Corners, shape (n, 2); the last goes on to the first."""

_MOST_PAIRS = 1 << 20  # of edges looked at at once


@dataclass(frozen=True)
class Region:
    """A ring, and the rings of its holes."""

    outline: Ring
    holes: list[Ring]


def signed_area(ring: Ring) -> float:
    """Return the area that a ring encloses, > 0 if it goes counter-clockwise."""
    x, y = (ring - ring[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def contains(ring: Ring, point: NDArray[np.float64]) -> bool:
    """Tell whether an odd number of edges separates a point from afar."""
    a, b = ring, np.roll(ring, -1, axis=0)
    spans = (a[:, 1] <= point[1]) != (b[:, 1] <= point[1])
    a, b = a[spans], b[spans]
    across = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return int(np.count_nonzero(across > point[0])) % 2 == 1


def crossing(a: Ring, b: Ring) -> NDArray[np.float64] | None:
    """Return a point in which an edge of one ring crosses one of the other, or None. Edges that touch do not cross."""
    if (a.max(axis=0) < b.min(axis=0)).any() or (b.max(axis=0) < a.min(axis=0)).any():
        return None
    c, d = b, np.roll(b, -1, axis=0)
    rows = max(1, _MOST_PAIRS // len(b))
    for first in range(0, len(a), rows):
        p = a[first : first + rows, None]
        q = np.roll(a, -1, axis=0)[first : first + rows, None]
        of_p, of_q = _side(c, d, p), _side(c, d, q)
        crosses = (of_p * of_q < 0) & (_side(p, q, c) * _side(p, q, d) < 0)
        if crosses.any():
            i, j = np.argwhere(crosses)[0]
            share = of_p[i, j] / (of_p[i, j] - of_q[i, j])
            point: NDArray[np.float64] = p[i, 0] + share * (q[i, 0] - p[i, 0])
            return point
    return None


def lies_in(inner: Ring, outer: Ring) -> bool:
    """Tell whether a ring lies within another that it does not cross; by the middle of an edge, lest corners touch."""
    return contains(outer, (inner[0] + inner[1]) / 2)


def regions(rings: Sequence[Ring]) -> list[Region]:
    """Return what rings enclose together by the rule that fonts are drawn with.

    Inside is where they do not go round as often in one sense as in the other. What crosses must have the same sense.

    Raises
    ------
    ValueError
        Where a ring crosses itself, or one of the other sense.
    """
    closed = [ring for ring in map(_without_repeats, rings) if len(ring) >= 3 and signed_area(ring) != 0]
    senses = [1 if signed_area(ring) > 0 else -1 for ring in closed]
    crossed = _crossings(closed, senses)
    outlines: list[Ring] = []
    holes: list[Ring] = []
    for i, ring in enumerate(closed):
        around = sum(
            senses[j]
            for j, other in enumerate(closed)
            if i != j and frozenset((i, j)) not in crossed and lies_in(ring, other)
        )
        is_filled = around + senses[i] != 0
        if is_filled != (around != 0):
            (outlines if is_filled else holes).append(ring)
    areas = [abs(signed_area(outline)) for outline in outlines]
    held: list[list[Ring]] = [[] for _ in outlines]
    for hole in holes:
        around_it = [k for k, outline in enumerate(outlines) if lies_in(hole, outline)]
        held[min(around_it, key=areas.__getitem__)].append(hole)
    return [Region(outline, inside) for outline, inside in zip(outlines, held, strict=True)]


def _crossings(rings: list[Ring], senses: list[int]) -> set[frozenset[int]]:
    """Return the pairs of rings that cross."""
    pairs: set[frozenset[int]] = set()
    for i, ring in enumerate(rings):
        if (point := crossing(ring, ring)) is not None:
            raise ValueError(f"outlines must not cross themselves, got one that does at {shown(point)}")
        for j in range(i):
            if (point := crossing(ring, rings[j])) is None:
                continue
            if senses[i] != senses[j]:
                raise ValueError(f"a hole must not cross an outline, got one that does at {shown(point)}")
            pairs.add(frozenset((i, j)))
    return pairs


def shown(point: NDArray[np.float64]) -> str:
    """Return a point as it appears in messages."""
    return f"({point[0]:.6g}, {point[1]:.6g})"


def _without_repeats(ring: Ring) -> Ring:
    """Return a ring without corners that repeat the one before."""
    return ring[(ring != np.roll(ring, 1, axis=0)).any(axis=1)] if len(ring) else ring


def _side(a: Ring, b: Ring, p: Ring) -> NDArray[np.float64]:
    """Return twice the signed area of the triangles a, b, p: > 0 where p lies to the left of a–b."""
    result: NDArray[np.float64] = (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
        p[..., 0] - a[..., 0]
    )
    return result
