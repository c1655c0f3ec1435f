"""Rays in extreme cases: far from the origin, from far away, grazing, beside bad neighbours."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from closed_forms import slabs
from closed_forms import sphere as first_root_of_sphere
from rounding import unit_roundoff

PLANES = ("depth", "normal", "status", "object_id", "color")
BODY = om.sphere(1.0).union(om.box(1.5, center=(0.9, 0.3, 0)), smooth=0.25) - om.cylinder(0.25, 4).rotate(40, "z")
MARCH = om.March(epsilon=2e-6, max_distance=20)


def scene(offset: np.ndarray) -> om.Scene:
    lights = [om.PointLight(offset + np.array([2, 5, 2]), 20), om.DirectionalLight((-1, -2, -1), 0.5)]
    return om.Scene(BODY.translate(*offset), lights=lights, ambient=0.2)


def cameras(offset: np.ndarray) -> dict[str, om.Camera | om.OrthographicCamera | om.PanoramicCamera]:
    eye, target = offset + np.array([3, 2, 4]), offset
    return {
        "perspective": om.Camera(eye, target, fov=45),
        "orthographic": om.OrthographicCamera(eye, target, height=4),
        "panoramic": om.PanoramicCamera(eye, target, fov=(60, 45)),
    }


@pytest.mark.parametrize("distance", [1e3, 1e5, 1e7, 1e8, 1e9])
def test_far_from_the_origin(distance: float, isa: str, precision: str):
    """Far away a scene has the bits that it has at the origin; positions are rounded as numbers are."""
    offset = distance / 25 * np.array([25, -12, 8])  # on the grid of anchors, which is one of fours
    size = (32, 24)
    for kind, camera in cameras(offset).items():
        options = {"march": MARCH, "precision": precision, "isa": isa}
        here = om.render(scene(np.zeros(3)), cameras(np.zeros(3))[kind], size, planes=(*PLANES, "position"), **options)
        there = om.render(scene(offset), camera, size, planes=(*PLANES, "position"), **options)
        for plane in ("status", "depth", "normal", "object_id"):
            assert_array_equal(getattr(there, plane), getattr(here, plane), err_msg=f"{kind}, {plane}")
        lost = 4 * np.finfo(np.float64).eps * distance  # of where the light stands
        assert_allclose(there.color, here.color, rtol=0, atol=lost)
        hit = here.status == om.Status.HIT
        assert hit.sum() > 50
        moved = there.position[hit] - offset
        assert_allclose(moved, here.position[hit], rtol=0, atol=2 * unit_roundoff(precision) * distance + 1e-6)


@pytest.mark.parametrize("distance", [1e3, 1e5, 1e8])
def test_rays_and_distances_far_from_the_origin(distance: float, isa: str, precision: str):
    rng = np.random.default_rng(5)
    offset = distance * np.array([0.3, 1, -0.7])  # which no grid of powers of two holds
    points = rng.normal(size=(200, 3)) * 2
    origins = points + np.array([0, 0, 6])
    directions = rng.normal(size=(200, 3)) * 0.5 - origins
    options = {"precision": precision, "isa": isa}
    there = BODY.translate(*offset)
    rounding = 8 * unit_roundoff(precision) * 8 + 8 * np.finfo(np.float64).eps * distance
    found = there.distance(points + offset, **options)
    assert_allclose(found, BODY.distance(points, **options), rtol=0, atol=rounding)
    gradients = there.gradient(points + offset, **options)
    assert np.median(np.abs(gradients - BODY.gradient(points, **options))) <= rounding
    here = BODY.raycast(origins, directions, march=MARCH, **options)
    hits = there.raycast(origins + offset, directions, march=MARCH, **options)
    assert (hits.status == here.status).mean() >= 0.99
    both = (hits.status == om.Status.HIT) & (here.status == om.Status.HIT)
    assert both.sum() > 50
    assert np.quantile(np.abs(hits.t[both] - here.t[both]), 0.95) <= 1e-5
    plain = om.March("plain", epsilon=2e-6)
    reference = om.reference.raycast(there, origins + offset, directions, plain, dtype="float32")
    both = (hits.status == om.Status.HIT) & (reference.status == om.Status.HIT)
    assert np.quantile(np.abs(hits.t[both] - reference.t[both]), 0.95) <= 1e-5


def test_an_eye_far_from_the_origin_over_what_has_no_bounds(isa: str, precision: str):
    """A floor through the eye's neighbourhood has no middle: coordinates count from the eye."""
    at = np.array([1e7, 1e7, -1e7])
    size = (32, 24)
    floors = [om.plane(point=at - [0, 1, 0]), om.plane(point=(0, -1, 0))]
    eyes = [at, np.zeros(3)]
    options = {"march": om.March(max_distance=200), "planes": ("depth", "status"), "precision": precision, "isa": isa}
    pictures = [
        om.render(floor, om.Camera(eye, eye + np.array([3, -1, 0])), size, **options)
        for floor, eye in zip(floors, eyes, strict=True)
    ]
    assert_array_equal(pictures[0].status, pictures[1].status)
    hit = pictures[1].status == om.Status.HIT
    assert hit.sum() > 300
    assert_allclose(pictures[0].depth[hit], pictures[1].depth[hit], rtol=1e-5)


@pytest.mark.parametrize("periods", [1e3, 1e6, 1e8])
def test_far_along_an_endless_lattice(periods: float, isa: str, precision: str):
    """All cells are alike."""
    lattice = (om.sphere(0.3) | om.box(0.2, center=(0.5, 0.1, 0))).repeat((2, 2, 4))
    march = om.March(max_distance=30)
    options = {"march": march, "planes": ("depth", "normal", "status"), "precision": precision, "isa": isa}
    here, there = (
        om.render(lattice, om.Camera(eye, eye + np.array([1, 0.3, 0.2])), (32, 24), **options)
        for eye in (np.array([1.0, 1, 2]), np.array([1, 1, 2]) + periods * np.array([2, -2, 4]))
    )
    assert (there.status == here.status).mean() > 0.99
    hit = (here.status == om.Status.HIT) & (there.status == om.Status.HIT)
    assert hit.sum() > 100
    for plane in ("depth", "normal"):
        assert np.quantile(np.abs(getattr(there, plane)[hit] - getattr(here, plane)[hit]), 0.95) < 2e-5


def test_near_things_in_a_large_scene(isa: str, precision: str):
    """A house in a town of a thousand miles: where epsilon asks for it, coordinates count from the eye."""
    rng = np.random.default_rng(1)
    houses = om.boxes(rng.uniform(-8e5, 8e5, (50, 3)), 10.0) | BODY.translate(7e5, 0, -7e5)
    eye = np.array([7e5 + 3, 2, -7e5 + 4])
    options = {"planes": ("depth", "status"), "precision": precision, "isa": isa}
    march = om.March(epsilon=1e-5)
    image = om.render(houses, om.Camera(eye, (7e5, 0, -7e5)), (32, 24), march=march, **options)
    alone = om.render(BODY, om.Camera((3, 2, 4), (0, 0, 0)), (32, 24), march=march, **options)
    hit = alone.status == om.Status.HIT
    assert hit.sum() > 100
    assert (image.status[hit] == om.Status.HIT).mean() > 0.99
    assert np.quantile(np.abs(image.depth[hit] - alone.depth[hit]), 0.95) < 2e-5


DISTANCES = [1e2, 1e4, 1e6, 1e8]


@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("kind", ["perspective", "orthographic", "panoramic"])
def test_seen_from_far_away(kind: str, distance: float, isa: str, precision: str):
    """Every ray through the ball hits, and where it is."""
    towards = np.array([2, 3, 6]) / 7
    eye, angle = distance * towards, math.degrees(2 * math.asin(1.25 / distance))
    camera = {
        "perspective": lambda: om.Camera(eye, (0, 0, 0), fov=angle),
        "orthographic": lambda: om.OrthographicCamera(eye, (0, 0, 0), height=2.5),
        "panoramic": lambda: om.PanoramicCamera(eye, (0, 0, 0), fov=(angle, angle)),
    }[kind]()
    planes = ("status", "position", "normal", "depth")
    image = om.render(om.sphere(1.0), camera, (40, 40), planes=planes, precision=precision, isa=isa)
    across = (np.arange(40) + 0.5) / 40 * 2.5 - 1.25
    from_middle = np.hypot(*np.meshgrid(across, across))
    assert (image.status == om.Status.HIT)[from_middle < 0.99].all()
    assert (image.status == om.Status.MISS)[from_middle > 1.01].all()
    clear = from_middle < 0.9
    position = image.position[clear].astype(np.float64)
    assert np.median(np.abs(np.linalg.norm(position, axis=1) - 1)) <= 9e-5
    assert_allclose(image.normal[clear], position / np.linalg.norm(position, axis=1)[:, None], atol=2e-3)
    along = distance - position @ towards  # rays are all but parallel
    assert (np.abs(image.depth[clear] - along) <= 0.02 + unit_roundoff(precision) * distance).all()
    reference = om.reference.render(
        om.sphere(1.0), camera, (40, 40), om.March("plain"), planes=("status", "depth"), dtype=precision
    )
    assert (image.status == reference.status).mean() > 0.99


@pytest.mark.parametrize("distance", DISTANCES)
def test_rays_from_far_away(distance: float, isa: str, precision: str):
    rng = np.random.default_rng(7)
    outward = rng.normal(size=(300, 3))
    origins = distance * outward / np.linalg.norm(outward, axis=1)[:, None]
    aims = rng.uniform(-1.2, 1.2, size=(300, 3))
    unit = (aims - origins) / np.linalg.norm(aims - origins, axis=1)[:, None]
    ends = origins + distance * unit  # near the solid: closed forms there keep their digits
    for shape, first_root in (
        (om.sphere(1.0), first_root_of_sphere),
        (om.box((2, 1, 1.5)), slabs(np.array([-1, -0.5, -0.75]), np.array([1, 0.5, 0.75]))),
    ):
        root = first_root(ends - 4 * unit, unit) + distance - 4
        hits = shape.raycast(origins, unit * 2, precision=precision, isa=isa)
        near = om.reference.raycast(shape, ends - 4 * unit, unit, om.March("plain", epsilon=1e-9))
        met = (near.status == om.Status.HIT) & (np.abs(np.einsum("ij,ij->i", near.normal, unit)) > 0.1)
        assert met.sum() > 60
        assert_array_equal(hits.status[met], om.Status.HIT)
        assert_allclose(2 * hits.t.astype(np.float64)[met], root[met], rtol=unit_roundoff(precision), atol=1e-3)
        assert np.median(np.linalg.norm(hits.position - (ends + (root - distance)[:, None] * unit), axis=1)[met]) < 9e-5
        lost = shape.distance(ends + np.linspace(-4, 4, 200)[:, None, None] * unit).min(axis=0) > 0.01
        assert_array_equal(hits.status[lost], om.Status.MISS)


def test_what_lies_within_a_pixel_is_hit_from_far_away(isa: str, precision: str):
    """There the hit epsilon is wider than the scene: a ray has hit before it is near, and is not inside."""
    image = om.render(
        om.sphere(1.0), om.Camera((0, 0, 1e6), (0, 0, 0)), (9, 9), planes=("status",), precision=precision, isa=isa
    )
    assert image.status[4, 4] == om.Status.HIT
    assert om.Status.INSIDE not in image.status


def test_a_minimal_distance_holds_far_away_too(isa: str, precision: str):
    """Behind the front of the ball all is inside; beyond the ball nothing is left."""
    for least, status in ((1e4 - 2, om.Status.HIT), (1e4, om.Status.INSIDE), (1e4 + 2, om.Status.MISS)):
        march = om.March(min_distance=least, max_distance=2e4)
        hits = om.sphere(1.0).raycast([0, 0, 1e4], [0, 0, -1], march=march, precision=precision, isa=isa)
        assert hits.status == status
    short = om.sphere(1.0).raycast([0, 0, 1e4], [0, 0, -1], t_max=9e3, precision=precision, isa=isa)
    assert (short.status, short.steps) == (om.Status.MISS, 0)


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
