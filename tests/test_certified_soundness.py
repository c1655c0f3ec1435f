"""What the certified search knows of a field is never contradicted by values: random shapes, pieces of rays, and rays.

Values are the scalar reference's, in float64: each is off by roundings, which the tests allow for.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import expression_strategies
import octomarch as om
from octomarch import _core
from octomarch.reference import Verdict, certified
from strategies import PRIMITIVES, Array, Sample, nested

ROUNDING = 1e-13
"""Relative to the coordinates in a shape, for each level of it."""
SAMPLES = 32
FARTHEST = 40.0
UNKNOWN = np.inf

Error = Callable[[Array], Array]
shape = st.one_of(*PRIMITIVES.values(), nested(2), nested(5))
seeds = st.integers(0, 2**31)


def error_of(sample: Sample) -> Error:
    def error(p: Array) -> Array:
        size = 1 + sample.extent + np.abs(p).max(axis=-1)
        return ROUNDING * sample.gain * sample.levels * size

    return error


def error_of_expression(sample: expression_strategies.Sample) -> Error:
    def error(p: Array) -> Array:
        tracked = sample.at(p.reshape(-1, 3), 2.0**-53)
        known = np.isfinite(tracked.error)
        return np.where(known, 8 * tracked.u * tracked.error + 1e-14, UNKNOWN).reshape(p.shape[:-1])

    return error


def segments(seed: int) -> tuple[Array, Array]:
    """Return starts and ends of segments from very short to long; some are along axes, or begin where ties are."""
    rng = np.random.default_rng(seed)
    starts = rng.normal(scale=1.5, size=(24, 3))
    starts[:6] = np.round(starts[:6] * 2) / 2
    ways = 10.0 ** rng.uniform(-6, 1, (24, 1)) * rng.normal(size=(24, 3))
    ways[3:9] *= np.eye(3)[rng.integers(0, 3, 6)]
    ways[9] = 0
    return starts, starts + ways


def hold_values_and_changes(shape: om.Shape, error: Error, seed: int) -> None:
    starts, ends = segments(seed)
    lo, hi, least_rise, greatest_rise = _core.reference_ranges(shape._node, starts, ends).T[..., None]
    share = np.linspace(0, 1, SAMPLES + 1)
    points = starts[:, None] + (ends - starts)[:, None] * share[:, None]
    points[:, -1] = ends
    values, slack = om.reference.distance(shape, points), error(points)
    known = np.isfinite(values) & np.isfinite(slack)
    assert (known <= (values >= lo - slack)).all()
    assert (known <= (values <= hi + slack)).all()
    # the rate between neighbours, per segment
    known = known[:, 1:] & known[:, :-1]
    rates = np.diff(np.where(np.isfinite(values), values, 0), axis=1) * SAMPLES
    slack = (slack[:, 1:] + slack[:, :-1]) * SAMPLES
    assert (known <= (rates >= least_rise - slack)).all()
    assert (known <= (rates <= greatest_rise + slack)).all()


def agree_with_samples(shape: om.Shape, error: Error, extent: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(8, 3))
    origins *= (3 + extent) / np.linalg.norm(origins, axis=1)[:, None]
    directions = (rng.normal(size=(8, 3)) - origins) * rng.uniform(0.1, 2, (8, 1))
    found = certified(shape, origins, directions, max_distance=FARTHEST)
    t = np.linspace(0, FARTHEST / np.linalg.norm(directions, axis=1), 1200, axis=1)
    points = origins[:, None] + t[..., None] * directions[:, None]
    values, slack = om.reference.distance(shape, points), error(points)
    inside = values < -slack
    assert not inside[t < found.t_lo[:, None]].any()  # all of a ray that misses
    # whose sampled values change sign, has a bracket that ends no later
    first = np.where(inside.any(axis=1), t[np.arange(8), inside.argmax(axis=1)], np.inf)
    decided = found.status != Verdict.UNDECIDED
    assert (found.t_hi <= first)[decided].all()
    ends = np.isfinite(found.t_hi)
    at_ends = origins[ends] + found.t_hi[ends, None] * directions[ends]
    values = om.reference.distance(shape, at_ends)
    assert (np.isnan(values) | (values <= error(at_ends))).all()
    hits = found.status == Verdict.HIT
    assert (found.t_hi[hits] - found.t_lo[hits] <= 1e-10 * found.t_hi[hits]).all()


@given(sample=shape, seed=seeds)
def test_ranges_hold_the_values_of_shapes(sample: Sample, seed: int):
    hold_values_and_changes(sample.shape, error_of(sample), seed)


@given(sample=shape, seed=seeds)
def test_brackets_of_shapes_agree_with_samples(sample: Sample, seed: int):
    agree_with_samples(sample.shape, error_of(sample), sample.extent, seed)


@given(sample=expression_strategies.expression(), seed=seeds)
def test_ranges_hold_the_values_of_expressions(sample: expression_strategies.Sample, seed: int):
    field = om.field(sample.expression, lipschitz=1)
    hold_values_and_changes(field, error_of_expression(sample), seed)


@given(sample=expression_strategies.expression(), seed=seeds)
def test_brackets_of_expressions_agree_with_samples(sample: expression_strategies.Sample, seed: int):
    field = om.field(sample.expression, lipschitz=1)
    agree_with_samples(field, error_of_expression(sample), 1.0, seed)


@given(
    size=st.sampled_from([(1, 1), (2, 3), (5, 4)]),
    options=st.sampled_from([{"wrap": "repeat"}, {"wrap": "clamp", "size": (0.7, 2.0)}, {"mapping": "spherical"}]),
    seed=seeds,
)
def test_ranges_hold_texels(size: tuple[int, int], options: dict[str, object], seed: int):
    picture = np.random.default_rng(seed).uniform(-1, 1, (*size, 3)).astype(np.float32)
    texture = om.image_texture(picture, **options)
    field = om.field(texture.components[1], lipschitz=1)
    hold_values_and_changes(field, lambda p: np.full(p.shape[:-1], 1e-12 * (1 + np.abs(p).max())), seed)


def test_ranges_are_tight_where_they_can_be():
    """The field's own change along short pieces is all that is left; along long ones no more than twice that."""
    shape = om.torus(1.0, 0.25).union(om.box(0.9).rotate(30, axis=(1, 2, 3)), smooth=0.3).twist(20, axis="y")
    rng = np.random.default_rng(4)
    starts = rng.normal(size=(500, 3))
    for length, share in ((1e-5, 1.01), (1e-2, 1.5)):
        ends = starts + length * rng.normal(size=(500, 3))
        lo, hi, *_ = _core.reference_ranges(shape._node, starts, ends).T
        points = starts[:, None] + (ends - starts)[:, None] * np.linspace(0, 1, 20)[:, None]
        values = om.reference.distance(shape, points)
        width = values.max(axis=1) - values.min(axis=1)
        assert np.median((hi - lo) / width) < share
