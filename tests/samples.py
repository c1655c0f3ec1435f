"""`Sample`: a random shape with what tests need to know of it, and the numbers that such shapes are made of.

Numbers are drawn from a few that floats hold exactly, which make ties, and from ranges, which make none.
`sample_primitives` and `sample_flats` make the first samples, `strategies` puts operators on top.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]
Name = str | tuple[float, ...]

AXES = {"x": np.array([1.0, 0, 0]), "y": np.array([0, 1.0, 0]), "z": np.array([0, 0, 1.0])}


@dataclass(frozen=True)
class Sample:
    """A shape, and what is known of it without looking at its program."""

    shape: om.Shape
    extent: float
    """Sum of the sizes and offsets on the longest way through the shape: no coordinate in it exceeds |p| + extent."""
    levels: int
    """Operators on the longest way from a primitive to the whole, the primitive included."""
    reach: Array
    """Half edges of a box about the origin that holds every primitive as placed; +inf along an endless axis."""
    monotone: bool = True
    """A field grows with the distance from each primitive, and nothing is subtracted: see `strategies.repeated`."""
    gain: float = 1.0
    """By how much an error of coordinates can grow on its way to the field."""
    folded: bool = False
    """Parts of an outline may lie on one another: there the normal of either side will do."""


EXACT = st.sampled_from([0.0, 0.25, 0.5, 1.0, 1.5])
length = st.one_of(EXACT, st.floats(0.05, 1.5))
positive = st.one_of(st.sampled_from([0.25, 0.5, 1.0, 2.0]), st.floats(0.2, 2))
coordinate = st.one_of(EXACT, EXACT.map(lambda x: -x), st.floats(-2, 2, allow_subnormal=False))
vector = st.tuples(coordinate, coordinate, coordinate)
smooth = st.sampled_from([0.0, 0.0, 0.125, 0.5, 0.3])
turn = st.one_of(st.sampled_from([90.0, 180.0, -90.0, 45.0]), st.floats(-400, 400, allow_subnormal=False))


def norm(v: tuple[float, ...]) -> float:
    return math.sqrt(sum(x * x for x in v))


direction = vector.filter(lambda v: norm(v) > 1e-3)
axis = st.one_of(st.sampled_from(sorted(AXES)), direction)


def along(name: Name, radial: float, axial: float) -> Array:
    """Half edges of a box about a solid of revolution."""
    unit = AXES[name] if isinstance(name, str) else np.array(name) / norm(name)
    across = np.sqrt(np.maximum(1 - unit**2, 0)) * radial
    return across + np.array([abs(u) * axial if u else 0.0 for u in unit])
