"""Hypothesis strategies of shapes, each with what tests need to know of it to say how exact its field must be.

A `Sample` carries bounds that grow with every operator put on top, by the rules in `grown`. Numbers are drawn from a
few that floats hold exactly, which make ties, and from ranges, which make none.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]

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
    """Nothing is subtracted, so that a field grows with that of each primitive: see `repeated`."""


EXACT = st.sampled_from([0.0, 0.25, 0.5, 1.0, 1.5])
length = st.one_of(EXACT, st.floats(0.05, 1.5))
coordinate = st.one_of(EXACT, EXACT.map(lambda x: -x), st.floats(-2, 2, allow_subnormal=False))
vector = st.tuples(coordinate, coordinate, coordinate)
smooth = st.sampled_from([0.0, 0.0, 0.125, 0.5, 0.3])


def _norm(v: tuple[float, ...]) -> float:
    return math.sqrt(sum(x * x for x in v))


direction = vector.filter(lambda v: _norm(v) > 1e-3)
axis = st.one_of(st.sampled_from(sorted(AXES)), direction)


def _along(name: str | tuple[float, ...], radial: float, axial: float) -> Array:
    """Half edges of a box about a solid of revolution."""
    unit = AXES[name] if isinstance(name, str) else np.array(name) / _norm(name)
    across = np.sqrt(np.maximum(1 - unit**2, 0)) * radial
    return across + np.array([abs(u) * axial if u else 0.0 for u in unit])


def _sphere(radius: float) -> Sample:
    return Sample(om.sphere(radius), radius, 1, np.full(3, radius))


def _box(size: tuple[float, ...]) -> Sample:
    return Sample(om.box(size), _norm(size), 1, np.array(size) / 2)


def _plane(normal: tuple[float, ...], point: tuple[float, ...]) -> Sample:
    return Sample(om.plane(normal, point), _norm(point), 1, np.full(3, math.inf))


def _cylinder(radius: float, height: float | None, name: str | tuple[float, ...]) -> Sample:
    half = math.inf if height is None else height / 2
    return Sample(om.cylinder(radius, height, name), radius + (height or 0), 2, _along(name, radius, half))


def _torus(radius: float, tube: float, name: str | tuple[float, ...]) -> Sample:
    return Sample(om.torus(radius, tube, name), radius + tube, 2, _along(name, radius + tube, tube) + tube)


def _capsule(a: tuple[float, ...], b: tuple[float, ...], radius: float) -> Sample:
    reach = np.maximum(np.abs(a), np.abs(b)) + radius
    return Sample(om.capsule(a, b, radius), _norm(a) + _norm(b) + radius, 1, reach)


PRIMITIVES: dict[str, st.SearchStrategy[Sample]] = {
    "sphere": st.builds(_sphere, length),
    "box": st.builds(_box, st.tuples(length, length, length)),
    "plane": st.builds(_plane, st.one_of(st.sampled_from([(0, 1, 0), (-1, 0, 0)]), direction), vector),
    "cylinder": st.builds(_cylinder, length, st.none(), axis),
    "capped_cylinder": st.builds(_cylinder, length, length, axis),
    "torus": st.builds(_torus, length, length, axis),
    "capsule": st.builds(_capsule, vector, vector, length),
}
primitive = st.one_of(*PRIMITIVES.values())


def combined(kind: Callable[..., om.Shape], operands: list[Sample], k: float) -> Sample:
    return Sample(
        kind(*(operand.shape for operand in operands), smooth=k),
        max(operand.extent for operand in operands) + k,
        max(operand.levels for operand in operands) + len(operands) - 1,
        np.max([operand.reach for operand in operands], axis=0),
        kind is not om.difference and all(operand.monotone for operand in operands),
    )


def complemented(inner: Sample) -> Sample:
    return replace(inner, shape=~inner.shape, levels=inner.levels + 1, monotone=False)


def translated(inner: Sample, offset: tuple[float, ...]) -> Sample:
    return replace(
        inner,
        shape=inner.shape.translate(offset),
        extent=inner.extent + _norm(offset),
        levels=inner.levels + 1,
        reach=inner.reach + np.abs(offset),
    )


def rotated(inner: Sample, degrees: float, name: str | tuple[float, ...]) -> Sample:
    radius = float(np.linalg.norm(inner.reach))  # of a ball, which no turn changes; +inf stays +inf
    return replace(inner, shape=inner.shape.rotate(degrees, name), levels=inner.levels + 1, reach=np.full(3, radius))


def scaled(inner: Sample, factor: float) -> Sample:
    return replace(
        inner,
        shape=inner.shape.scale(factor),
        extent=inner.extent * factor,
        levels=inner.levels + 1,
        reach=inner.reach * factor,
    )


def painted(inner: Sample, grey: float) -> Sample:
    return replace(inner, shape=inner.shape.paint(om.Material(grey)))


def repeated(inner: Sample, axes: tuple[bool, ...], counts: tuple[int | None, ...], slack: float) -> Sample:
    """Repetition along the axes on which every primitive fits into a cell.

    With monotone content the nearest cell and its next neighbour are then enough, and on an axis of mirror symmetry
    the nearest cell alone: a primitive in its own cell is never farther than its copy in a cell beyond.
    """
    fits = np.isfinite(inner.reach) & np.array(axes) & inner.monotone
    period = np.where(fits, 2 * inner.reach * (1 + slack) + 0.25, 0.0)
    if not fits.any():
        return inner
    copies = [count or 0 for count in counts]
    spread = [p * (n - 1) / 2 if n else (math.inf if p else 0.0) for p, n in zip(period, copies, strict=True)]
    return Sample(
        inner.shape.repeat(period.tolist(), counts),
        inner.extent + 2 * float(period.sum()),
        inner.levels + 4,  # the repeat, and at most three unions with copies next to it in sequence
        inner.reach + np.array(spread),
    )


def grown(children: st.SearchStrategy[Sample]) -> st.SearchStrategy[Sample]:
    """One operator of any kind on top of `children`."""
    operands = st.lists(children, min_size=2, max_size=3)
    flags = st.tuples(st.booleans(), st.booleans(), st.booleans())
    count = st.sampled_from([None, None, 2, 3])
    degrees = st.one_of(st.sampled_from([90.0, 180.0, -90.0, 45.0]), st.floats(-400, 400, allow_subnormal=False))
    combination = st.builds(combined, st.sampled_from([om.union, om.intersection, om.difference]), operands, smooth)
    return st.one_of(
        combination,
        combination,
        st.builds(complemented, children),
        st.builds(translated, children, vector),
        st.builds(rotated, children, degrees, axis),
        st.builds(scaled, children, st.one_of(st.sampled_from([0.5, 2.0]), st.floats(0.3, 3))),
        st.builds(painted, children, st.sampled_from([0.25, 0.5, 0.75])),
        st.builds(repeated, children, flags, st.tuples(count, count, count), st.sampled_from([0.0, 0.3])),
    )


def nested(depth: int = 5) -> st.SearchStrategy[Sample]:
    """Shapes up to `depth` operators deep."""
    strategy = primitive
    for level in range(depth):
        above = grown(strategy)
        strategy = above if level == depth - 1 else st.one_of(primitive, above, above)
    return strategy


def _points() -> Array:
    rng = np.random.default_rng(17)
    lattice = np.array(list(itertools.product((-1.0, -0.5, 0.0, 0.5, 1.0), repeat=3)))
    return np.concatenate(
        [rng.normal(scale=1.5, size=(120, 3)), rng.choice(lattice, 40, replace=False), np.eye(3) * 30]
    )


POINTS = _points()
"""Points at random, points on a lattice where ties are, and three far away: 163, which fill no block evenly."""
GENERIC = slice(0, 120)
