"""Rays against closed forms, and against what a march may never do: cross a surface, take spent steps for a miss, go
behind its origin.
"""

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from closed_forms import SOLIDS, Array, FirstRoot
from rounding import field_error, unit_roundoff
from strategies import Sample, nested

EPSILON = 1e-5
STEEP = 0.1
"""Least cosine between ray and normal at which a root is asked for: hits on flatter ones are off by epsilon over it."""

rng = np.random.default_rng(11)
ORIGINS = rng.normal(size=(600, 3))
ORIGINS *= 4 / np.linalg.norm(ORIGINS, axis=1)[:, None]
AIMS = rng.normal(scale=0.9, size=(600, 3)) - ORIGINS
UNIT = AIMS / np.linalg.norm(AIMS, axis=1)[:, None]
LENGTHS = np.exp(rng.uniform(-3, 3, 600))


def hit_epsilon(origins: Array, t: Array, precision: str, epsilon: float = EPSILON) -> Array:
    """Return the documented tolerance of a query at unit parameter t."""
    return np.maximum(epsilon, 16 * unit_roundoff(precision) * np.maximum(np.abs(origins).max(axis=-1), t))


def outside(shape: om.Shape) -> Array:
    return np.flatnonzero(om.reference.distance(shape, ORIGINS) > 0.1)


@pytest.fixture(params=SOLIDS)
def solid(request: pytest.FixtureRequest) -> tuple[om.Shape, FirstRoot]:
    return SOLIDS[request.param]


def test_hits_are_the_first_roots(solid: tuple[om.Shape, FirstRoot], isa: str, precision: str):
    """A hit is within epsilon of the surface, and so within epsilon over the cosine of the root along the ray.

    Origin, direction and position are rounded to float by then: less than another epsilon, by the floor it has.
    """
    shape, first_root = solid
    rays = outside(shape)
    origins, unit, lengths = ORIGINS[rays], UNIT[rays], LENGTHS[rays]
    root = first_root(origins, unit)
    march = om.March(epsilon=EPSILON, max_distance=100)
    hits = shape.raycast(origins, unit * lengths[:, None], march=march, precision=precision, isa=isa)
    t = hits.t.astype(np.float64) * lengths

    met = np.isfinite(root) & (root < 100)
    positions = origins + np.where(met, root, 0)[:, None] * unit
    cosine = -np.einsum("ij,ij->i", om.reference.gradient(shape, positions), unit)
    clear = met & (cosine > STEEP)
    assert clear.sum() > 100
    assert_array_equal(hits.status[clear], om.Status.HIT)
    tolerance = (2 * hit_epsilon(origins, root, precision) / cosine)[clear]
    assert (np.abs(t[clear] - root[clear]) <= tolerance).all()
    assert (np.linalg.norm(hits.position - positions, axis=1)[clear] <= 2 * tolerance).all()

    missed = ~met & (closest_approach(shape, origins, unit) > 0.01)
    assert missed.sum() > 20
    assert_array_equal(hits.status[missed], om.Status.MISS)
    assert np.isposinf(hits.t[missed]).all()


def closest_approach(shape: om.Shape, origins: Array, unit: Array, reach: float = 100.0) -> Array:
    """Least distance of each ray from the solid, no better than the spacing of samples."""
    t = np.concatenate([np.linspace(0, 10, 400), np.linspace(10, reach, 50)[1:]])
    points = origins[:, None] + t[:, None] * unit[:, None]
    least: Array = om.reference.distance(shape, points).min(axis=1)
    return least


def test_secant_finish_brings_hits_far_nearer(solid: tuple[om.Shape, FirstRoot], isa: str):
    shape, first_root = solid
    rays = outside(shape)
    origins, unit = ORIGINS[rays], UNIT[rays]
    root = first_root(origins, unit)
    errors = {}
    for finish in ("secant", None):
        march = om.March("enhanced", epsilon=1e-3, max_distance=100, finish=finish)
        hits = shape.raycast(origins, unit, march=march, isa=isa)
        met = (hits.status == om.Status.HIT) & np.isfinite(root)
        errors[finish] = np.abs(hits.t[met] - root[met])
    assert np.quantile(errors["secant"], 0.95) < 0.2 * np.quantile(errors[None], 0.95)
    assert np.median(errors["secant"]) < 0.02 * np.median(errors[None])


@given(sample=nested())
def test_no_ray_crosses_a_surface(isa: str, precision: str, sample: Sample):
    """Whatever the shape: samples before the end lie outside, hits on the surface, and origins INSIDE within it."""
    origins, unit = ORIGINS[:60], UNIT[:60]
    march = om.March(epsilon=EPSILON, max_distance=20, max_steps=64)
    hits = sample.shape.raycast(origins, unit * 2, march=march, precision=precision, isa=isa)
    assert not np.isnan(hits.t).any()
    t = 2 * hits.t.astype(np.float64)
    end = np.minimum(t, 20)
    slack = field_error(sample, origins, precision) + field_error(sample, 20 * unit, precision)
    travelled = np.linspace(0, 1, 50, endpoint=False)[1:, None] * end
    field = om.reference.distance(sample.shape, origins + travelled[..., None] * unit)
    free = hits.status != om.Status.INSIDE
    assert (field >= -slack)[:, free].all()
    at_end = om.reference.distance(sample.shape, origins + end[:, None] * unit)
    surface = hits.status == om.Status.HIT
    assert (np.abs(at_end) <= hit_epsilon(origins, t, precision) + slack)[surface].all()
    assert (at_end <= hit_epsilon(origins, end, precision) + slack)[~free].all()
    assert_array_equal(hits.t[~free], 0)
    assert_array_equal(hits.steps[hits.status == om.Status.STEP_LIMIT], 64)


@pytest.mark.parametrize("max_steps", [1, 2, 3, 7, 20])
def test_spent_steps_are_never_a_miss(max_steps: int, isa: str, precision: str):
    """Rays that graze the floor come down far away, and each answer keeps them before it."""
    angles = np.geomspace(1e-4, 1, 65)
    directions = np.stack([np.cos(angles), -np.sin(angles), 0 * angles], axis=-1)
    march = om.March("enhanced", max_steps=max_steps, epsilon=1e-6, max_distance=1e6)
    hits = om.plane().raycast([0, 1, 0], directions, march=march, precision=precision, isa=isa)
    assert (hits.status != om.Status.MISS).all()
    spent = hits.status == om.Status.STEP_LIMIT
    assert spent.any()
    assert_array_equal(hits.steps[spent], max_steps)
    assert (hits.steps[~spent] <= max_steps).all()
    root = 1 / np.sin(angles)
    assert (hits.t[spent] > 0).all()
    assert (hits.t[spent] <= root[spent] * (1 + 1e-5)).all()
    assert_array_equal(hits.normal[spent], np.broadcast_to([0, 1, 0], (spent.sum(), 3)))
    assert_array_equal(hits.object_id[spent], 0)


def test_origins_in_the_solid_or_on_it_are_inside(isa: str, precision: str):
    origins = [(0, 0, 0), (0.5, 0, 0), (1, 0, 0), (1 + 0.9 * EPSILON, 0, 0), (1 + 100 * EPSILON, 0, 0)]
    march = om.March(epsilon=EPSILON)
    hits = om.sphere(1.0).raycast(origins, [1, 0, 0], march=march, precision=precision, isa=isa)
    assert [om.Status(s).name for s in hits.status] == ["INSIDE"] * 4 + ["MISS"]
    assert_array_equal(hits.t[:4], 0)
    assert_array_equal(hits.position[:4], 0)
    assert_array_equal(hits.object_id[:4], -1)
    assert_array_equal(hits.steps[:4], 1)


BAD = [np.nan, np.inf, -np.inf]


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("component", range(6))
def test_rays_that_are_none_are_invalid(value: float, component: int, isa: str, precision: str):
    ray = np.array([0, 0, 3, 0, 0, -1.0])
    ray[component] = value
    hits = om.sphere(1.0).raycast(ray[:3], ray[3:], precision=precision, isa=isa)
    assert hits.status == om.Status.INVALID
    assert np.isposinf(hits.t)
    assert hits.normal.tolist() == hits.position.tolist() == [0, 0, 0]
    assert hits.object_id == hits.material_id == -1


LENGTHS_HELD = {"float32": [1e-30, 1e-3, 2.0, 1e30], "float64": [1e-300, 1e-3, 2.0, 1e300]}  # t is one over them


def test_t_counts_in_lengths_of_the_direction_however_long(isa: str, precision: str):
    lengths = np.array(LENGTHS_HELD[precision])
    directions = np.array([0, 0, -1]) * lengths[:, None]
    hits = om.sphere(1.0).raycast([0, 0, 3], directions, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    assert_allclose(hits.t, 2 / lengths, rtol=4 * unit_roundoff(precision))
    assert_array_equal(hits.position, np.broadcast_to([0, 0, 1], (4, 3)))


def test_a_direction_of_no_length_is_invalid(isa: str, precision: str):
    hits = om.sphere(1.0).raycast([0, 0, 3], [[0, 0, 0], [0, -0.0, 0], [0, 0, -5e-324]], precision=precision, isa=isa)
    assert hits.status[:2].tolist() == [om.Status.INVALID] * 2
    assert hits.status[2] == om.Status.HIT


@pytest.mark.parametrize("length", [0.5, 1.0, 3.0])
def test_limits_end_rays(length: float, isa: str, precision: str):
    """max_distance counts in scene units, t_max in lengths of the direction; what lies just within is still met."""
    ball = om.sphere(1.0)

    def status(**limits) -> om.Status:
        march = om.March(max_distance=limits.pop("max_distance", 100))
        hits = ball.raycast([0, 0, 3], [0, 0, -length], march=march, precision=precision, isa=isa, **limits)
        return om.Status(int(hits.status))

    assert status(max_distance=2.001) == status(t_max=2.001 / length) == om.Status.HIT
    assert status(max_distance=1.999) == status(t_max=1.999 / length) == om.Status.MISS
    assert status(max_distance=1.999, t_max=9) == status(max_distance=9, t_max=1.999 / length) == om.Status.MISS


def test_the_finish_stays_in_front_of_the_origin_and_within_the_limit(isa: str, precision: str):
    """Rays that start a few epsilon off the surface, in all directions, and rays that end there."""
    gaps = np.array([1.1, 2, 5, 20, 50]) * 1e-3
    origins = np.repeat(np.stack([1 + gaps, 0 * gaps, 0 * gaps], -1), 120, axis=0)
    march = om.March(epsilon=1e-3, max_distance=0.5)
    hits = om.sphere(1.0).raycast(origins, UNIT[:600], march=march, precision=precision, isa=isa)
    ended = hits.status == om.Status.HIT
    assert ended.sum() > 100
    assert (hits.t[ended] > 0).all()
    assert (hits.t[ended] <= 0.5).all()
    short = om.sphere(1.0).raycast([3, 0, 0], [-1, 0, 0], t_max=1.9995, march=march, precision=precision, isa=isa)
    assert np.isposinf(short.t) or short.t <= 1.9995


@pytest.mark.parametrize("rise", [0.0, 4e-7])
def test_a_ray_alongside_a_plane_takes_no_secant(rise: float, isa: str):
    """Its distance never falls: it ends where the tolerance, which grows with t, has reached it.

    Where the distance rises, the secant through the last two samples has its root far behind the origin.
    """
    march = om.March("enhanced", epsilon=0, max_distance=1e6, max_steps=2_000_000)
    hits = om.plane().raycast([0, 1e-3, 0], [1, rise, 0], march=march, precision="float32", isa=isa)
    assert hits.status == om.Status.HIT
    assert (16 * 2.0**-24 - rise) * hits.t == pytest.approx(1e-3, rel=1e-4)


def test_the_finish_never_leads_behind_the_camera(isa: str, precision: str):
    """Rays that rise more slowly than their pixels widen end above the floor; their secant meets it behind the eye."""
    camera = om.Camera((0, 0.01, 0), (1, 0.01, 0), fov=10)
    march = om.March("enhanced", epsilon=1e-6, pixel_tolerance=20)
    image = om.render(
        om.plane(), camera, (16, 16), march=march, planes=("depth", "status"), precision=precision, isa=isa
    )
    rising = image.status[:8] == om.Status.HIT
    assert rising.sum() > 20
    assert (image.depth > 0).all()


def test_fields_beyond_the_numbers_are_misses_at_once(isa: str):
    """Squares overflow: the field is +inf, and the ray is over after a step or two."""
    hits = om.sphere(1.0).raycast([[1e30, 0, 0]], [-1, 0, 0], precision="float32", isa=isa)
    assert hits.status == om.Status.MISS
    assert hits.steps <= 2


@pytest.mark.parametrize("offset", [1e3, 1e5, 1e6])
def test_tolerance_grows_with_the_coordinates(offset: float, isa: str):
    """Far from the origin of the world floats are coarse: rays still end, within the tolerance they have there."""
    shape = om.sphere(1.0, center=(offset, 0, 0))
    origins = np.array([[offset, 0, 4.0]]) + np.array([[dx, 0, 0] for dx in (-0.5, 0.0, 0.25)])
    hits = shape.raycast(origins, [0, 0, -1], march=om.March(epsilon=1e-6), precision="float32", isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    expected = 4 - np.sqrt(1 - np.array([0.5, 0, 0.25]) ** 2)
    assert (np.abs(hits.t - expected) <= 2 * hit_epsilon(origins, hits.t, "float32", 1e-6)).all()
