"""Random flat shapes, and the solids that they become by `extrude` and `revolve`."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

import octomarch as om
from samples import Array, Sample, coordinate, length, norm, positive, smooth, turn

pair = st.tuples(coordinate, coordinate)


def _flat(x: float, y: float) -> Array:
    return np.array([x, y, math.inf])


def _circle(radius: float) -> Sample:
    return Sample(om.circle(radius), radius, 1, _flat(radius, radius))


def _rectangle(size: tuple[float, float]) -> Sample:
    return Sample(om.rectangle(size), norm(size), 1, _flat(size[0] / 2, size[1] / 2))


def _polygon(corners: list[tuple[float, float]]) -> Sample:
    x, y = np.abs(corners).max(axis=0)
    return Sample(om.polygon(corners), math.hypot(x, y), 2, _flat(x, y), folded=True)


def _regular(sides: int, radius: float) -> Sample:
    return Sample(om.regular_polygon(sides, radius), radius, 2, _flat(radius, radius))


def _star(points: int, outer: float, inner: float) -> Sample:
    radius = max(outer, inner)
    return Sample(om.star(points, outer, inner), radius, 2, _flat(radius, radius))


def _segment(a: tuple[float, float], b: tuple[float, float], radius: float) -> Sample:
    x, y = np.maximum(np.abs(a), np.abs(b)) + radius
    return Sample(om.segment(a, b, radius), norm(a) + norm(b) + radius, 4, _flat(x, y))


def _ellipse(radii: tuple[float, float]) -> Sample:
    return Sample(om.ellipse(radii), max(radii), 2, _flat(*radii), monotone=False)


FLATS: dict[str, st.SearchStrategy[Sample]] = {
    "circle": st.builds(_circle, length),
    "rectangle": st.builds(_rectangle, st.tuples(length, length)),
    "polygon": st.builds(_polygon, st.lists(pair, min_size=3, max_size=7)),
    "regular polygon": st.builds(_regular, st.integers(3, 8), length),
    "star": st.builds(_star, st.integers(2, 6), length, length),
    "segment": st.builds(_segment, pair, pair, length),
    "ellipse": st.builds(_ellipse, st.tuples(positive, positive)),
}


def _combined(kind: str, a: Sample, b: Sample, k: float) -> Sample:
    shape = getattr(a.shape, kind)(b.shape, smooth=k)
    monotone = kind == "union" and a.monotone and b.monotone
    reach = np.maximum(a.reach, b.reach)
    extent, levels = max(a.extent, b.extent) + k, max(a.levels, b.levels) + 1
    return Sample(shape, extent, levels, reach, monotone, folded=a.folded or b.folded)


def _placed(inner: Sample, degrees: float, offset: tuple[float, float]) -> Sample:
    radius = math.hypot(*inner.reach[:2])
    return replace(
        inner,
        shape=inner.shape.rotate(degrees, "z").translate(*offset),
        extent=inner.extent + norm(offset),
        levels=inner.levels + 2,
        reach=_flat(radius + abs(offset[0]), radius + abs(offset[1])),
    )


def _hollow(inner: Sample, thickness: float) -> Sample:
    return replace(
        inner,
        shape=inner.shape.shell(thickness),
        extent=inner.extent + thickness,
        levels=inner.levels + 1,
        reach=inner.reach + thickness,
        monotone=False,
    )


_primitive = st.one_of(*FLATS.values())
_kinds = st.sampled_from(["union", "intersection", "difference"])
flat = st.one_of(
    _primitive,
    st.builds(_placed, _primitive, turn, pair),
    st.builds(_combined, _kinds, _primitive, st.builds(_placed, _primitive, turn, pair), smooth),
    st.builds(_hollow, _primitive, length),
)


def extruded(inner: Sample, height: float) -> Sample:
    return replace(
        inner,
        shape=inner.shape.extrude(height),
        extent=inner.extent + height,
        levels=inner.levels + 1,
        reach=np.array([*inner.reach[:2], height / 2]),
    )


def revolved(inner: Sample, offset: float) -> Sample:
    radius = inner.reach[0] + offset
    return replace(
        inner,
        shape=inner.shape.revolve(offset),
        extent=inner.extent + offset,
        levels=inner.levels + 1,
        reach=np.array([radius, inner.reach[1], radius]),
        monotone=False,
    )
