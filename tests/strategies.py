"""Hypothesis strategies of shapes: operators on top of `sample_primitives`, and the points at which tests look.

The bounds that a `samples.Sample` carries grow with every operator put on top, by the rules here.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

import octomarch as om
from sample_primitives import PRIMITIVES, primitive
from samples import AXES, Array, Name, Sample, axis, length, norm, positive, smooth, turn, vector

__all__ = ["PRIMITIVES", "Array", "Sample", "primitive", "vector"]


def combined(kind: Callable[..., om.Shape], operands: list[Sample], k: float) -> Sample:
    return Sample(
        kind(*(operand.shape for operand in operands), smooth=k),
        max(operand.extent for operand in operands) + k,
        max(operand.levels for operand in operands) + len(operands) - 1,
        np.max([operand.reach for operand in operands], axis=0),
        kind is not om.difference and all(operand.monotone for operand in operands),
        max(operand.gain for operand in operands),
        any(operand.folded for operand in operands),
    )


def melted(operands: list[Sample], k: float) -> Sample:
    as_union = combined(om.union, operands, 0.0)
    return replace(
        as_union,
        shape=om.metaballs(*(operand.shape for operand in operands), k=k),
        extent=as_union.extent + k,
        levels=as_union.levels + len(operands) - 1,  # twice those of a union, for an exponential and a logarithm
    )


def complemented(inner: Sample) -> Sample:
    return replace(inner, shape=~inner.shape, levels=inner.levels + 1, monotone=False)


def translated(inner: Sample, offset: tuple[float, ...]) -> Sample:
    return replace(
        inner,
        shape=inner.shape.translate(offset),
        extent=inner.extent + norm(offset),
        levels=inner.levels + 1,
        reach=inner.reach + np.abs(offset),
    )


def rotated(inner: Sample, degrees: float, name: Name) -> Sample:
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


def stretched(inner: Sample, factors: tuple[float, ...]) -> Sample:
    return replace(
        inner,
        shape=inner.shape.stretch(factors),
        extent=inner.extent * max(factors),
        levels=inner.levels + 1,
        reach=inner.reach * np.array(factors),
        monotone=False,
    )


def rounded(inner: Sample, radius: float) -> Sample:
    return replace(
        inner,
        shape=inner.shape.round(radius),
        extent=inner.extent + radius,
        levels=inner.levels + 1,
        reach=inner.reach + radius,
    )


def hollowed(inner: Sample, thickness: float) -> Sample:
    grown = rounded(inner, thickness)
    return replace(grown, shape=inner.shape.shell(thickness), monotone=False)


def mirrored(inner: Sample, axes: str) -> Sample:
    return replace(inner, shape=inner.shape.mirror(axes), levels=inner.levels + 1)


def elongated(inner: Sample, lengths: tuple[float, ...]) -> Sample:
    return replace(
        inner,
        shape=inner.shape.elongate(lengths),
        extent=inner.extent + norm(lengths),
        levels=inner.levels + 1,
        reach=inner.reach + np.array(lengths) / 2,
        monotone=False,
    )


def twisted(inner: Sample, degrees: float, name: str | None) -> Sample:
    """Twist about an axis, or bend (None). What has no end across the axis stays as it is."""
    across = 1 - AXES[name or "z"]
    radius = float(np.linalg.norm(np.where(across > 0, inner.reach, 0))) + inner.extent
    try:
        shape = inner.shape.twist(degrees, name) if name else inner.shape.bend(degrees)
    except ValueError:
        return inner
    if math.isinf(radius):  # a twist by nothing is none, and needs no end
        return inner
    return replace(
        inner,
        shape=shape,
        extent=inner.extent + radius,
        levels=inner.levels + 2,
        reach=np.where(across > 0, radius, inner.reach),
        monotone=False,
        gain=inner.gain * (1 + math.radians(abs(degrees)) * radius),
    )


def waved(inner: Sample, amplitude: float, frequency: float) -> Sample:
    x, y, z = om.coordinates()
    wave = amplitude * om.sin(frequency * x) * om.sin(frequency * (y + z))
    return replace(
        inner,
        shape=inner.shape.displace(wave, lipschitz=2 * amplitude * frequency),
        extent=inner.extent + amplitude,
        levels=inner.levels + 2,
        reach=inner.reach + amplitude,
        monotone=False,
        gain=inner.gain + 2 * amplitude * frequency,
    )


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
    return replace(
        inner,
        shape=inner.shape.repeat(period.tolist(), counts),
        extent=inner.extent + 2 * float(period.sum()),
        levels=inner.levels + 4,  # the repeat, and at most three unions with copies next to it in sequence
        reach=inner.reach + np.array(spread),
    )


def grown(children: st.SearchStrategy[Sample]) -> st.SearchStrategy[Sample]:
    """One operator of any kind on top of `children`."""
    operands = st.lists(children, min_size=2, max_size=3)
    flags = st.tuples(st.booleans(), st.booleans(), st.booleans())
    count = st.sampled_from([None, None, 2, 3])
    kinds = st.sampled_from([om.union, om.intersection, om.difference])
    factor = st.one_of(st.sampled_from([0.5, 2.0]), st.floats(0.3, 3))
    rate = st.one_of(st.sampled_from([-45.0, 20.0, 90.0]), st.floats(-90, 90, allow_subnormal=False))
    return st.one_of(
        st.builds(combined, kinds, operands, smooth),
        st.builds(combined, kinds, operands, smooth),
        st.builds(melted, operands, st.sampled_from([0.0, 0.05, 0.3])),
        st.builds(complemented, children),
        st.builds(translated, children, vector),
        st.builds(rotated, children, turn, axis),
        st.builds(scaled, children, factor),
        st.builds(painted, children, st.sampled_from([0.25, 0.5, 0.75])),
        st.builds(repeated, children, flags, st.tuples(count, count, count), st.sampled_from([0.0, 0.3])),
        st.builds(stretched, children, st.tuples(positive, positive, positive)),
        st.builds(rounded, children, length),
        st.builds(hollowed, children, length),
        st.builds(mirrored, children, st.sampled_from(["x", "y", "z", "xz", "xyz"])),
        st.builds(elongated, children, st.tuples(length, length, length)),
        st.builds(twisted, children, rate, st.sampled_from(["x", "y", "z", None])),
        st.builds(waved, children, st.sampled_from([0.05, 0.1]), st.sampled_from([1.0, 3.0])),
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
