"""First intersections of rays with solids, from their equations alone: what a march must find.

Each function takes origins and unit directions (n, 3) and returns t (n,), +inf where the line from the origin onwards
never meets the solid. Origins lie outside.
"""

import itertools
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


def slabs(low: Array, high: Array) -> FirstRoot:
    """Return the function of a box between two corners."""

    def first_root(o: Array, d: Array) -> Array:
        sides = np.stack([(low - o) / d, (high - o) / d])
        enters, leaves = sides.min(axis=0).max(axis=1), sides.max(axis=0).min(axis=1)
        return np.where((enters <= leaves) & (enters > 0), enters, np.inf)

    return first_root


def convex(normals: Array, offsets: Array) -> FirstRoot:
    """Return the function of all points with normal·p ≤ offset for each face."""

    def first_root(o: Array, d: Array) -> Array:
        along, t = d @ normals.T, (offsets - o @ normals.T) / (d @ normals.T)
        enters = np.where(along < 0, t, -np.inf).max(axis=1)
        leaves = np.where(along > 0, t, np.inf).min(axis=1)
        return np.where((enters <= leaves) & (enters > 0), enters, np.inf)

    return first_root


def angle(o: Array, d: Array) -> Array:
    """Two boxes that overlap in a corner."""
    first = slabs(np.array([-1, -1, -0.75]), np.array([1, 0, 0.75]))
    second = slabs(np.array([-1, -1, -0.75]), np.array([0, 1, 0.75]))
    return np.minimum(first(o, d), second(o, d))


def ellipsoid(o: Array, d: Array) -> Array:
    """Radii 1.5, 1, 1.25."""
    radii = np.array([1.5, 1, 1.25])
    o, d = o / radii, d / radii
    return nearest(quadratic(dot(d, d), dot(o, d), dot(o, o) - 1))


def cone(o: Array, d: Array) -> Array:
    """Radius 1.25 at y = -1, 0.75 at y = 1: x² + z² = (1 − y/4)²."""
    form = np.array([1.0, -1 / 16, 1])
    b = dot(o * form, d) + d[:, 1] / 4
    side = quadratic(dot(d * form, d), b, dot(o * form, o) + o[:, 1] / 2 - 1)
    side[np.abs(o[:, 1:2] + side * d[:, 1:2]) > 1] = np.nan
    caps = (np.array([-1, 1]) - o[:, 1:2]) / d[:, 1:2]
    at_caps = (o[:, None] + caps[..., None] * d[:, None]) * [1, 0, 1]
    caps[dot(at_caps, at_caps) > np.array([1.25, 0.75]) ** 2] = np.nan
    return nearest(np.concatenate([side, caps], axis=1))


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


SIGNS = np.array(list(itertools.product((1, -1), repeat=3)))
SIXTHS = np.radians(30 + 60 * np.arange(6))
HEXAGON = np.stack([np.sin(SIXTHS), 0 * SIXTHS, np.cos(SIXTHS)], -1)
CAPS = np.array([[0.0, 1, 0], [0, -1, 0]])
SIDES = np.array([[2.0, 1, 0], [-2, 1, 0], [0, 1, 2], [0, 1, -2]])

INDEX = np.stack(np.meshgrid(*[np.linspace(-1, 1, 5)] * 3, indexing="ij"))
HALF_SPACE = [om.grid(INDEX[0] / 2 + INDEX[1], ((-1, -1, -1), (1, 1, 1)), kind) for kind in ("linear", "cubic")]
CUT_HALF_SPACE = convex(np.concatenate([[[0.5, 1, 0]], np.eye(3), -np.eye(3)]), np.array([0.0] + [1] * 6))

SOLIDS: dict[str, tuple[om.Shape, FirstRoot]] = {
    "sphere": (om.sphere(1.0), sphere),
    "plane": (om.plane((1, 2, 2), (0, -0.5, 0)), plane),
    "box": (om.box((1, 2, 3)), slabs(np.array([-0.5, -1, -1.5]), np.array([0.5, 1, 1.5]))),
    "box, largest excess": (
        om.box((1, 2, 3), form="maximum"),
        slabs(np.array([-0.5, -1, -1.5]), np.array([0.5, 1, 1.5])),
    ),
    "capped cylinder": (om.cylinder(0.75, 2), can),
    "capped cone": (om.capped_cone(1.25, 0.75, 2), cone),
    "torus": (om.torus(1, 0.25), torus),
    "capsule": (om.capsule((-1, 0, 0), (1, 0, 0), 0.5), capsule),
    "octahedron": (om.octahedron(1.5), convex(SIGNS.astype(float), np.full(8, 1.5))),
    "pyramid": (om.pyramid(2, 2), convex(np.concatenate([SIDES, CAPS[1:]]), np.ones(5))),
    "hexagonal prism": (
        om.hexagonal_prism(1, 1.5),
        convex(np.concatenate([HEXAGON, CAPS]), np.array([3**0.5 / 2] * 6 + [0.75] * 2)),
    ),
    "extruded angle": (
        om.polygon([(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)]).extrude(1.5),
        angle,
    ),
    "ellipsoid": (om.ellipsoid((1.5, 1, 1.25)), ellipsoid),
    "samples": (HALF_SPACE[0], CUT_HALF_SPACE),
    "samples, cubic": (HALF_SPACE[1], CUT_HALF_SPACE),
}
