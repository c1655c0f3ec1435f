"""Bounds of expressions over boxes: never exceeded by values and slopes, and tight where that can be asked."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import octomarch as om
from expression_strategies import Sample, expression
from octomarch import _core

X, Y, Z = om.coordinates()
INF = math.inf
SPACE = ((-INF,) * 3, (INF,) * 3)
CUBE = ((-2.0,) * 3, (2.0,) * 3)


def bounds(e: om.Expression, box=SPACE) -> tuple[float, float, float]:
    return _core.expression_bounds(e._node, *box)


def points_within(box, count: int) -> np.ndarray:
    """Return points of a box: at random, on a lattice where kinks and jumps are, and its corners."""
    lo, hi = np.array(box)
    rng = np.random.default_rng(3)
    lattice = np.array(np.meshgrid(*(np.linspace(a, b, 5) for a, b in zip(lo, hi, strict=True)))).reshape(3, -1).T
    return np.concatenate([rng.uniform(lo, hi, (count, 3)), lattice])


corner = st.tuples(*(st.sampled_from([-2.0, -1.0, -0.5, 0.0, 0.25]) for _ in range(3)))
edge = st.tuples(*(st.sampled_from([0.25, 0.5, 1.0, 2.0]) for _ in range(3)))
box = st.builds(lambda lo, size: (lo, tuple(np.add(lo, size).tolist())), corner, edge)


@given(sample=expression(), box=box)
def test_bounds_hold_values_and_gradients(sample: Sample, box):
    lo, hi, slope = bounds(sample.expression, box)
    points = points_within(box, 300)
    shape = om.field(sample.expression, lipschitz=1)
    values = om.reference.distance(shape, points)
    gradients = om.reference.gradient(shape, points)
    expected = sample.at(points, 2.0**-53)
    rounding = 4 * expected.u * expected.error
    known = np.isfinite(expected.error)
    assert (values >= lo - rounding)[known].all(), sample.text
    assert (values <= hi + rounding)[known].all(), sample.text
    # not at kinks, where a gradient is that of one side; and it is rounded too, a little where nothing cancels
    steepness = np.linalg.norm(gradients, axis=1)[:300]
    assert (steepness[known[:300]] <= slope * (1 + 1e-9) + 1e-9).all(), sample.text


@given(sample=expression(), box=box)
def test_no_difference_is_steeper_than_the_slope(sample: Sample, box):
    """Jumps have no gradient: only differences across them show."""
    slope = bounds(sample.expression, box)[2]
    if not math.isfinite(slope):
        return
    points = points_within(box, 400)
    rng = np.random.default_rng(5)
    lengths = 10.0 ** rng.uniform(-6, 0, len(points))[:, None]
    others = np.clip(points + rng.normal(size=points.shape) * lengths, *np.array(box))
    first, second = (sample.at(p, 2.0**-53) for p in (points, others))
    rounding = 4 * first.u * (first.error + second.error)
    allowed = slope * np.linalg.norm(points - others, axis=1) * (1 + 1e-12) + rounding
    known = np.isfinite(rounding)
    excess = np.abs(first.value[known] - second.value[known]) - allowed[known]
    assert not (excess > 0).any(), (sample.text, points[known][excess > 0][0], others[known][excess > 0][0])


@given(sample=expression(), box=box)
def test_bounds_of_all_space_hold_in_boxes(sample: Sample, box):
    whole = bounds(sample.expression)
    part = bounds(sample.expression, box)
    values = sample.at(points_within(box, 100), 2.0**-53)
    known = np.isfinite(values.error)
    rounding = 4 * values.u * values.error[known]
    assert (values.value[known] >= whole[0] - rounding).all()
    assert (values.value[known] <= whole[1] + rounding).all()
    assert part[2] <= whole[2] * (1 + 1e-9)


WITHOUT_BOUNDS = {
    "coordinate": (X, 1.0),
    "sum": (3 * X + 4 * Y, 5.0),
    "length": (om.length(X, Y, Z) - 1, 1.0),
    "length of one": (om.sqrt(X * X), 1.0),
    "torus": (om.length(om.length(X, Z) - 2, Y) - 0.5, 1.0),
    "stretched length": (om.sqrt(X * X + 4 * Y * Y), 2.0),
    "length above 0": (om.sqrt(X * X + Y * Y + 0.25), 1.0),
    "minimum of lengths": (om.minimum(om.length(X, Y, Z), om.length(X - 3, Y, Z)), 1.0),
    "sine": (om.sin(X), 1.0),
    "product of sines": (om.sin(X) * om.sin(Y) * om.sin(Z), math.sqrt(3)),
    "ripples": (0.1 * om.sin(10 * X), 1.0),
    "abs": (abs(X) - 1, 1.0),
    "box": (om.maximum(abs(X) - 1, abs(Y) - 1, abs(Z) - 1), 1.0),
    "clamp": (om.clamp(2 * X, 0, 1), 2.0),
    "arc tangent": (om.atan(X), 1.0),
    "constant": (om.minimum(3.0), 0.0),
    "noise": (om.noise(2 * X, 2 * Y, 2 * Z), 2 * 3.8),
    "angle times length": (om.sin(om.length(X, Y, Z)), 1.0),
    "same on both sides": (om.where(X < 0, Y, Y), INF),
    "the same number on both sides": (om.where(X < 0, 2.0, 2.0), 0.0),
}


@pytest.mark.parametrize("name", WITHOUT_BOUNDS)
def test_slopes_over_all_space(name: str):
    e, expected = WITHOUT_BOUNDS[name]
    assert bounds(e)[2] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", ["coordinate", "sum", "length", "torus", "box", "clamp"])
def test_slopes_are_exact_where_numbers_are(name: str):
    e, expected = WITHOUT_BOUNDS[name]
    assert bounds(e)[2] == expected
    assert om.compile(om.field(e)).lipschitz == expected


UNBOUNDED = {
    "square": X * X,
    "exponential": om.exp(X),
    "root": om.sqrt(abs(X)),
    "inverse": 1 / X,
    "logarithm": om.log(abs(X)),
    "floor": om.floor(X),
    "mod": X % 1,
    "step": X < 0,
    "where": om.where(X < 0, -X, X),
    "where at one point": om.where(X, 1, 0),
    "angle": om.atan2(Y, X),
    "tangent": om.tan(X),
    "arc sine": om.asin(X),
    "broken power": om.power(X, 0.5),
    "normal": om.normals()[0],
    "infinite": X * INF,
}


@pytest.mark.parametrize("name", UNBOUNDED)
def test_slopes_without_bound_are_infinite(name: str):
    assert bounds(UNBOUNDED[name])[2] == INF


JUMPS = {
    "floor": (om.floor(X), (1.0, 2.0), (1.25, 1.75)),
    "floor from below": (om.floor(X), (0.5, 1.0), (0.5, 0.75)),
    "mod": (X % 1.0, (0.5, 1.5), (0.25, 0.75)),
    "mod of a negative divisor": (X % -1.0, (-0.5, 0.5), (0.25, 0.75)),
    "step": (X < 1, (0.0, 1.0), (0.0, 0.75)),
    "step with its edge": (X <= 1, (1.0, 2.0), (0.0, 1.0)),
    "where": (om.where(X < 1, 0, X), (0.0, 1.0), (0.0, 0.5)),
    "inverse": (1 / X, (0.0, 1.0), (0.5, 1.0)),
    "root": (om.sqrt(X), (0.0, 1.0), (0.25, 1.0)),
    "root of what may be below 0": (om.sqrt(X), (-1.0, 1.0), (0.25, 1.0)),
    "logarithm": (om.log(X), (0.0, 1.0), (0.25, 1.0)),
    "angle": (om.atan2(Y, X), (-2.0, 0.0), (0.5, 1.0)),
    "tangent": (om.tan(X), (1.0, 2.0), (-1.0, 1.0)),
    "arc sine": (om.asin(X), (0.0, 1.0), (-0.5, 0.5)),
    "power": (X**0.5, (0.0, 1.0), (0.5, 1.0)),
    "comparison of what is no number": (om.where(om.sqrt(X) < 1, 0, 5), (-1.0, -0.5), (0.0, 0.5)),
}


@pytest.mark.parametrize("name", JUMPS)
def test_jumps_and_poles_count_where_the_box_holds_them(name: str):
    e, inside, outside = JUMPS[name]
    slopes = [bounds(e, ((lo, -1.0, -1.0), (hi, 1.0, 1.0)))[2] for lo, hi in (inside, outside)]
    assert slopes[0] == INF
    assert slopes[1] < 20


TIGHT = {
    "square": (X * X, 4.0),
    "negative square": (-X * X, 4.0),
    "cube": (X**3, 12.0),
    "bell": (om.exp(-X * X), math.sqrt(2) * math.exp(-0.5)),
    "smooth step": (om.smoothstep(-1, 1, X), 0.75),
    "paraboloid": (X * X + Y * Y + Z * Z, 4 * math.sqrt(3)),
    "saddle": (X * Y, 2 * math.sqrt(2)),
    "hyperbola": (1 / (X + 3), 1.0),
    "kink": (om.maximum(X, 0) ** 2, 4.0),
}


@pytest.mark.parametrize("name", TIGHT)
def test_slopes_over_a_box_are_tight(name: str):
    e, truth = TIGHT[name]
    slope = bounds(e, CUBE)[2]
    assert truth <= slope * (1 + 1e-12)
    assert slope <= 1.06 * truth


def test_an_endless_axis_that_is_not_looked_at_does_no_harm():
    assert bounds(X * X, ((-2, -INF, -INF), (2, INF, INF)))[2] == 4
    assert bounds(X * Y, ((-2, -INF, -INF), (2, INF, INF)))[2] == INF


def test_texels_rise_at_most_as_their_neighbours_differ():
    picture = np.zeros((4, 5, 3))
    picture[1, 2] = 1
    texture = om.image_texture(picture, size=(10, 8))
    lo, hi, slope = bounds(texture.components[0])
    assert (lo, hi) == (0, 1)
    assert slope == pytest.approx(math.hypot(0.5, 0.5))  # one texel is two units wide and high
    ramp = om.image_texture(np.arange(5.0)[None, :] * np.ones((4, 1)), size=(5, 4))
    assert bounds(ramp.components[0])[2] == pytest.approx(4)  # from the last column to the first
    held = om.image_texture(np.arange(5.0)[None, :] * np.ones((4, 1)), size=(5, 4), wrap="clamp")
    assert bounds(held.components[0])[2] == pytest.approx(1)


def test_gradients_of_noise_stay_below_their_bound():
    points = np.random.default_rng(8).uniform(-150, 150, (200_000, 3))
    shape = om.field(om.noise(X, Y, Z), lipschitz=1)
    lo, hi, slope = bounds(om.noise(X, Y, Z))
    steepness = np.linalg.norm(shape.gradient(points), axis=1)
    values = shape.distance(points)
    assert 2 < steepness.max() <= slope
    assert lo <= values.min()
    assert 0.8 < values.max() <= hi


def test_dense_graphs_cost_no_more_than_their_nodes():
    """Each of 200 nodes uses the one before twice: as a tree it would have 2²⁰⁰."""
    e = X
    for _ in range(200):
        e = om.sin(e + e * Y)
    assert math.isfinite(bounds(e, CUBE)[1])
    squares = X * X
    for _ in range(100):
        squares = squares + squares
    assert bounds(om.sqrt(squares), CUBE)[2] >= 2.0**50


def test_chains_of_any_length_have_bounds():
    e = X
    for i in range(50_000):
        e = om.sin(e) if i % 2 else e + Y
    assert math.isfinite(bounds(e)[2])


def test_field_finds_its_bound():
    assert om.compile(om.field(om.length(X, Y, Z) - 1)).lipschitz == 1
    ball = om.field(X * X + Y * Y + Z * Z - 1, bounds=((-1.25,) * 3, (1.25,) * 3))
    assert 2.5 * math.sqrt(3) <= om.compile(ball).lipschitz < 4.6
    with pytest.raises(ValueError, match="lipschitz must be given"):
        om.field(X * X)
    with pytest.raises(ValueError, match="lipschitz must be given"):
        om.field(om.floor(X), bounds=CUBE)


FIELDS = {
    "ball of squares": om.field(X * X + Y * Y + Z * Z - 1, bounds=((-1.5,) * 3, (1.5,) * 3)),
    "heart": om.field(
        (X * X + 9 / 4 * Z * Z + Y * Y - 1) ** 3 - X * X * Y**3 - 9 / 80 * Z * Z * Y**3,
        bounds=((-1.3,) * 3, (1.3,) * 3),
    ),
    "gyroid": om.field(
        om.sin(4 * X) * om.cos(4 * Y) + om.sin(4 * Y) * om.cos(4 * Z) + om.sin(4 * Z) * om.cos(4 * X),
        bounds=((-1,) * 3, (1,) * 3),
    ),
    "bumps": om.field(om.length(X, Y, Z) - 1 + 0.05 * om.noise(8 * X, 8 * Y, 8 * Z)),
    "star": om.field(
        om.length(X, Z) - 0.8 - 0.2 * om.cos(5 * om.atan2(Z, X)),
        lipschitz=4,
        bounds=((-1.2, -0.3, -1.2), (1.2, 0.3, 1.2)),
    ),
}


@pytest.mark.parametrize("name", FIELDS)
def test_marches_miss_no_surface_of_a_field(name: str, isa: str):
    """Wherever a ray ends, a march of fine steps finds nothing solid before."""
    shape = FIELDS[name]
    rng = np.random.default_rng(1)
    origins = rng.normal(size=(400, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = rng.normal(size=(400, 3)) * 0.3 - origins / 3
    hits = shape.raycast(origins, directions, march=om.March(max_steps=4096, epsilon=1e-5), isa=isa)
    ends = np.where(np.isfinite(hits.t), hits.t, 6.0)
    fractions = np.linspace(0, 1, 400)[:, None]
    t = fractions * (ends - 1e-3)
    samples = shape.distance(origins + t[..., None] * directions)
    assert (samples > -1e-4).all()
    assert (hits.status == om.Status.HIT).sum() > 50
