"""First intersections of rays with solids, from their equations alone: what a march must find.

Each function takes origins and unit directions (n, 3) and returns t (n,), +inf where the line from the origin onwards
never meets the solid. Origins lie outside.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]
FirstRoot = Callable[[Array, Array], Array]


def dot(a: Array, b: Array) -> Array:
    return np.einsum("...i,...i->...", a, b)


def nearest(roots: Array) -> Array:
    """Return the least root above 0 of each row; a NaN is none."""
    return np.where(roots > 0, roots, np.inf).min(axis=-1)


def quadratic(a: Array, b: Array, c: Array) -> Array:
    """Both roots of a t² + 2 b t + c, NaN where there is none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(b * b - a * c)
        return np.stack([(-b - root) / a, (-b + root) / a], axis=-1)


def sphere(o: Array, d: Array) -> Array:
    return nearest(quadratic(dot(d, d), dot(o, d), dot(o, o) - 1))


def plane(o: Array, d: Array) -> Array:
    """Through (0, -0.5, 0) with normal (1, 2, 2)/3."""
    normal = np.array([1, 2, 2]) / 3
    return nearest((-(dot(o, normal) + 1 / 3) / dot(d, normal))[:, None])


def box(o: Array, d: Array) -> Array:
    """Slabs of half sizes 0.5, 1, 1.5."""
    half = np.array([0.5, 1.0, 1.5])
    sides = np.stack([(-half - o) / d, (half - o) / d])
    enters, leaves = sides.min(axis=0).max(axis=1), sides.max(axis=0).min(axis=1)
    return np.where((enters <= leaves) & (enters > 0), enters, np.inf)


def can(o: Array, d: Array) -> Array:
    """Radius 0.75 about y, between the caps y = ±1."""
    flat = np.array([1.0, 0, 1])
    side = quadratic(dot(d * flat, d), dot(o * flat, d), dot(o * flat, o) - 0.75**2)
    side[np.abs(o[:, 1:2] + side * d[:, 1:2]) > 1] = np.nan
    caps = (np.array([-1, 1]) - o[:, 1:2]) / d[:, 1:2]
    at_caps = o[:, None] + caps[..., None] * d[:, None]
    caps[dot(at_caps * flat, at_caps) > 0.75**2] = np.nan
    return nearest(np.concatenate([side, caps], axis=1))


def capsule(o: Array, d: Array) -> Array:
    """Radius 0.5 about the segment from (-1, 0, 0) to (1, 0, 0)."""
    across = np.array([0, 1.0, 1])
    side = quadratic(dot(d * across, d), dot(o * across, d), dot(o * across, o) - 0.25)
    side[np.abs(o[:, :1] + side * d[:, :1]) > 1] = np.nan
    balls = []
    for sign in (-1, 1):
        from_end = o - [sign, 0, 0]
        ball = quadratic(dot(d, d), dot(from_end, d), dot(from_end, from_end) - 0.25)
        ball[sign * (o[:, :1] + ball * d[:, :1]) < 1] = np.nan
        balls.append(ball)
    return nearest(np.concatenate([side, *balls], axis=1))


def torus(o: Array, d: Array) -> Array:
    """Radius 1 and tube radius 0.25 about y: (|p|² + R² − r²)² = 4 R² (x² + z²), a quartic in t."""
    flat = np.array([1.0, 0, 1])
    oo, od = dot(o, o) + 1 - 0.25**2, dot(o, d)
    xx, xd, dd = dot(o * flat, o), dot(o * flat, d), dot(d * flat, d)
    coefficients = np.stack([1 + 0 * od, 4 * od, 4 * od**2 + 2 * oo - 4 * dd, 4 * oo * od - 8 * xd, oo**2 - 4 * xx], -1)
    roots = np.array([np.roots(row) for row in coefficients])
    return nearest(np.where(np.abs(roots.imag) < 1e-9, roots.real, np.nan))


SOLIDS: dict[str, tuple[om.Shape, FirstRoot]] = {
    "sphere": (om.sphere(1.0), sphere),
    "plane": (om.plane((1, 2, 2), (0, -0.5, 0)), plane),
    "box": (om.box((1, 2, 3)), box),
    "capped cylinder": (om.cylinder(0.75, 2), can),
    "torus": (om.torus(1, 0.25), torus),
    "capsule": (om.capsule((-1, 0, 0), (1, 0, 0), 0.5), capsule),
}
