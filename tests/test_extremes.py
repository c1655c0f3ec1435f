"""Rays in extreme cases: grazing, in directions of any length, from inside, through no field, beside bad neighbours."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import unit_roundoff

BODY = om.sphere(1.0).union(om.box(1.5, center=(0.9, 0.3, 0)), smooth=0.25) - om.cylinder(0.25, 4).rotate(40, "z")
MARCH = om.March(epsilon=2e-6, max_distance=20)


@pytest.mark.parametrize("degrees", [1.0, 0.1])
def test_grazing_rays(degrees: float, isa: str, precision: str):
    """Steps are ln(h/eps) / -ln(1 - sin), and a ray that has spent its own is no miss: t lies before the surface."""
    sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    ray = [0, 1, 0], [cosine, -sine, 0]
    needed = math.log(1 / 1e-4) / -math.log1p(-sine)
    few = om.March("plain", epsilon=1e-4, max_steps=200)
    hit = om.plane().raycast(*ray, march=few, precision=precision, isa=isa)
    assert hit.status == om.Status.STEP_LIMIT
    assert 0 < hit.t < 1 / sine
    many = om.March("plain", epsilon=1e-4, max_steps=10_000, max_distance=1e4)
    hit = om.plane().raycast(*ray, march=many, precision=precision, isa=isa)
    assert hit.status == om.Status.HIT
    assert abs(hit.steps - needed) < 0.3 * needed
    assert abs(hit.t * sine - 1) <= 1e-4 + 16 * unit_roundoff(precision) / sine


@pytest.mark.parametrize("length", [1e-30, 1e-3, 2.0, 1e30])
def test_directions_not_of_unit_length(length: float, isa: str, precision: str):
    """The ray parameter counts in lengths of the direction; steps do not."""
    one = om.box(2.0).raycast([0.1, 0.2, 3], [0, 0.1, -1], precision=precision, isa=isa)
    hits = om.box(2.0).raycast([0.1, 0.2, 3], np.array([0, 0.1, -1]) * length, precision=precision, isa=isa)
    assert hits.status == om.Status.HIT
    assert_allclose(hits.t * length, one.t, rtol=4 * unit_roundoff(precision))
    for none in ([0, 0, 0], [math.nan, 0, 1], [math.inf, 0, 0]):
        assert om.box(2.0).raycast([0, 0, 3], none, precision=precision, isa=isa).status == om.Status.INVALID


def test_origins_inside_and_on_the_surface(isa: str, precision: str):
    """They are INSIDE at t = 0. The way out is that to the complement; a least distance skips what is near."""
    options = {"precision": precision, "isa": isa}
    hits = om.sphere(1.0).raycast([[0, 0, 0], [0.5, 0, 0], [1, 0, 0]], [0, 0, 1], **options)
    assert_array_equal(hits.status, om.Status.INSIDE)
    assert_array_equal(hits.t, 0)
    out = (~om.sphere(1.0)).raycast([0, 0, 0], [0, 0, 1], **options)
    assert out.status == om.Status.HIT
    assert_allclose(out.t, 1, atol=1e-5)
    leaving = om.sphere(1.0).raycast([1, 0, 0], [1, 0, 0], march=om.March(min_distance=0.1), **options)
    assert leaving.status == om.Status.MISS


def half_a_field() -> om.Shape:
    """Return a ball whose field is NaN where x < 0."""
    x, y, z = om.coordinates()
    return om.field(om.where(x < 0, om.sqrt(x), om.length(x, y, z) - 1), lipschitz=1.0)


def test_a_field_that_is_nan_ends_a_ray_at_once(isa: str, precision: str):
    """It is INVALID, and the rays in the lanes beside it do not feel it."""
    origins = np.tile([0.5, 0, 3.0], (16, 1))
    origins[::5, 0] = -0.5
    hits = half_a_field().raycast(origins, [0, 0, -1], precision=precision, isa=isa)
    alone = half_a_field().raycast(origins[1], [0, 0, -1], precision=precision, isa=isa)
    assert_array_equal(hits.status[::5], om.Status.INVALID)
    assert_array_equal(hits.steps[::5], 1)
    assert np.isposinf(hits.t[::5]).all()
    good = np.arange(16) % 5 != 0
    assert_array_equal(hits.status[good], om.Status.HIT)
    assert_array_equal(hits.t[good], alone.t)


def test_a_field_that_is_infinite_is_a_miss_at_once(isa: str, precision: str):
    x, _, _ = om.coordinates()
    endless = om.field(1 / (0 * x), lipschitz=1.0)
    hits = endless.raycast([1, 0, 0], [1, 0, 0], precision=precision, isa=isa)
    assert hits.status == om.Status.MISS
    assert hits.steps <= 2


def test_an_inside_out_room_is_hit_at_its_walls(isa: str, precision: str):
    """A box has its distance within too."""
    rays = [[0.5, 0, 0], [0, 0, 0], [0, 0.25, 1]], [[1, 0, 0], [0, -1, 0], [0, 0, -2]]
    hits = (~om.box(4.0)).raycast(*rays, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    assert_allclose(hits.t, [1.5, 2, 1.5], atol=4e-5)


@pytest.mark.parametrize("count", [1, 7, 8, 9, 63, 64, 65])
def test_lanes_do_not_touch_each_other(count: int, isa: str, precision: str):
    """One ray that is none, one from far away and any number of others: each has the bits that it has alone."""
    rng = np.random.default_rng(count)
    away = np.array([0, 0, 4])
    origins, directions = rng.normal(size=(count, 3)) + away, rng.normal(size=(count, 3)) - away
    origins[count // 2] *= 1e5
    directions[count // 3] = math.nan
    together = BODY.raycast(origins, directions, precision=precision, isa=isa, march=MARCH)
    for i in {0, count // 3, count // 2, count - 1}:
        alone = BODY.raycast(origins[i], directions[i], precision=precision, isa=isa, march=MARCH)
        for plane in ("t", "normal", "position", "status", "steps"):
            assert_array_equal(getattr(alone, plane), getattr(together, plane)[i])


def test_lanes_that_missed_leave_no_trace_along_silhouettes(isa: str, precision: str):
    """The pixels around a ball are sky, every one, and the ball is lit in all of its own."""
    sky = om.Sky(axis=(0, 1, 0), toward=0, away=0, base=(0.25, 0.5, 0.75))
    image = om.render(
        om.Scene(om.sphere(1.0), sky=sky, ambient=0.5),
        om.Camera((0, 0, 4), (0, 0, 0), fov=35),
        (65, 49),
        shading=om.Shading(occlusion=0),
        planes=("color", "status"),
        precision=precision,
        isa=isa,
    )
    missed = image.status == om.Status.MISS
    assert missed.sum() > 100
    assert_array_equal(image.color[missed], np.broadcast_to([0.25, 0.5, 0.75], (missed.sum(), 3)))
    assert_allclose(image.color[~missed], 0.4, rtol=1e-6)
