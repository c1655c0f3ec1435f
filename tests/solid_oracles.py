"""Distances from first principles, for tests of the reference: no formula here is that of the shape it stands for.

Solids with flat faces are measured triangle by triangle, solids of revolution by the segments of their profile, flat
polygons edge by edge. Points are (..., 3), profiles and polygons are lists of corners (n, 2).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def norm(v: Array) -> Array:
    return np.sqrt((v * v).sum(axis=-1))


def to_segment(p: Array, a: ArrayLike, b: ArrayLike) -> Array:
    """Distance from points to a segment, in any dimension."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    length = (b - a) @ (b - a)
    share = np.clip((p - a) @ (b - a) / length, 0, 1) if length else np.zeros(p.shape[:-1])
    return norm(p - a - share[..., None] * (b - a))


def to_triangle(p: Array, corners: Array) -> Array:
    """Distance from points to a triangle in space: to its plane above it, to its edges elsewhere."""
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    edges = [to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)]
    least = np.minimum.reduce(edges)
    if not normal.any():
        return least
    normal /= np.linalg.norm(normal)
    sides = [(p - start) @ np.cross(normal, end - start) for start, end in ((a, b), (b, c), (c, a))]
    above = (np.array(sides) >= 0).all(axis=0)
    return np.where(above, np.abs((p - a) @ normal), least)


def convex(p: Array, faces: Sequence[ArrayLike]) -> Array:
    """Signed distance of a convex solid about the origin, given its faces as lists of corners."""
    triangles = [
        np.array([face[0], face[i], face[i + 1]], float)
        for face in (np.asarray(face, float) for face in faces)
        for i in range(1, len(face) - 1)
    ]
    distance = np.minimum.reduce([to_triangle(p, triangle) for triangle in triangles])
    inside = np.ones(p.shape[:-1], bool)
    for a, b, c in triangles:
        normal = np.cross(b - a, c - a)
        normal *= np.sign(normal @ a)  # away from the origin
        inside &= (p - a) @ normal <= 0
    return np.where(inside, -distance, distance)


def polygon(p: Array, corners: ArrayLike) -> Array:
    """Signed distance in the plane of the first two coordinates: inside where a ray to +x crosses an odd number of
    edges.
    """
    q, corners = p[..., :2], np.asarray(corners, float)
    edges = list(zip(corners, np.roll(corners, -1, axis=0), strict=True))
    distance = np.minimum.reduce([to_segment(q, a, b) for a, b in edges])
    crossings = np.zeros(q.shape[:-1], int)
    for a, b in edges:
        spans = (a[1] <= q[..., 1]) != (b[1] <= q[..., 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            x = a[0] + (q[..., 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
        crossings += spans & (x > q[..., 0])
    return np.where(crossings % 2 == 1, -distance, distance)


def revolution(p: Array, profile: ArrayLike) -> Array:
    """Signed distance of the solid that a closed profile (radius, y) encloses when it turns about y: its part at
    radii below 0 stands for the other side of the axis.
    """
    radius = np.hypot(p[..., 0], p[..., 2])
    return polygon(np.stack([radius, p[..., 1]], -1), profile)


def sampled(p: Array, curve: Array) -> Array:
    """Distance to the nearest of many points."""
    return np.min([norm(p - point) for point in curve], axis=0)
