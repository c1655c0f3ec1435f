"""What lies between samples on a grid, one axis after the other, by numpy; and how it goes on beyond their box."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _places(count: int, u: Array) -> tuple[NDArray[np.intp], Array]:
    cell = np.clip(np.floor(u).astype(int), 0, count - 2)
    return cell, u - cell


def _linear(samples: Array, u: Array) -> Array:
    """Interpolate along the first axis of samples (n, points, …) at u (points)."""
    cell, t = _places(len(samples), u)
    points = np.arange(len(u))
    t = t.reshape(-1, *[1] * (samples.ndim - 2))
    return (1 - t) * samples[cell, points] + t * samples[cell + 1, points]


def _cubic(samples: Array, u: Array) -> Array:
    """Do the same by Catmull and Rom's splines, as their matrix."""
    ends = 2 * samples[0] - samples[1], 2 * samples[-1] - samples[-2]
    longer = np.concatenate([ends[0][None], samples, ends[1][None]])
    cell, t = _places(len(samples), u)
    matrix = np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]]) / 2
    weights = np.stack([t**0, t, t**2, t**3], -1) @ matrix
    points = np.arange(len(u))
    return sum(weights[:, k].reshape(-1, *[1] * (samples.ndim - 2)) * longer[cell + k, points] for k in range(4))


def inside(values: Array, lo: Array, hi: Array, kind: str, p: Array) -> Array:
    """Return the interpolant at points (n, 3) of the box."""
    along = _linear if kind == "linear" else _cubic
    u = (p - lo) / (hi - lo) * (np.array(values.shape) - 1)
    samples = np.broadcast_to(values[:, None], (values.shape[0], len(p), *values.shape[1:]))
    for axis in range(3):
        samples = along(samples, u[:, axis])
        if axis < 2:
            samples = np.swapaxes(samples, 0, 1)
    return samples


def field(values: Array, bounds: tuple[Array, Array], kind: str, steepness: float, p: Array) -> Array:
    """Return the field at points (n, 3)."""
    lo, hi = (np.asarray(corner, dtype=float) for corner in bounds)
    nearest = np.clip(p, lo, hi)
    value = inside(values, lo, hi, kind, nearest)
    outside = steepness * np.linalg.norm(p - nearest, axis=1)
    depth = steepness * np.minimum(p - lo, hi - p).min(axis=1)
    return np.where(outside > 0, np.hypot(outside, np.maximum(value, 0)), np.maximum(value, -depth))
