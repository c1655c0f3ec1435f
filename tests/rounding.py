"""How far two evaluations of one field may lie apart: bounds derived from the arithmetic, not fitted to results."""

import numpy as np
from numpy.typing import NDArray

from strategies import Array, Sample

ROUNDINGS = 16
"""Roundings in sequence at one level of a shape, in the longest formula of a level, the capsule's: its constants (3),
the offset from its end, the dot product (3), its quotient, the nearest point (2), the length (4), the radius, and what
an operator adds around it (1). Longer formulas count as several levels."""


def unit_roundoff(precision: str) -> float:
    return float(np.finfo(precision).eps) / 2


def field_error(sample: Sample, points: Array, precision: str) -> Array:
    """Bound of the difference between a field in some precision and in double.

    Each rounding errs by a unit roundoff of a number that is no larger than |p| + extent, and the operations after it
    magnify the error by no more than the gain: for most the slope of each is 1 at the most. Double is compared with
    another evaluation in double that errs as well. Squares below the smallest normal number are lost: they add its
    root.
    """
    size = np.linalg.norm(points, axis=-1) + sample.extent
    evaluations = 2 if precision == "float64" else 1
    lost = np.sqrt(float(np.finfo(precision).tiny)) * sample.levels
    bound: Array = ROUNDINGS * sample.levels * evaluations * unit_roundoff(precision) * size * sample.gain + lost
    return bound


def representable(points: NDArray[np.floating], precision: str) -> Array:
    """Round points to a precision, so that both evaluations start from the same ones."""
    return np.asarray(points).astype(precision).astype(np.float64)
