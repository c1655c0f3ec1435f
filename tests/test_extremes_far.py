"""Far away: scenes far from the origin, and eyes and rays far from scenes."""

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
    march = om.March(epsilon=1e-5, pixel_tolerance=0)  # two pictures differ within a pixel's
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


METHODS = {
    "plain": om.March("plain"),
    "auto": om.March(),
    "relaxed": om.March("relaxed"),
    "fixed": om.March("fixed", step=0.01),
    "biased": om.March(bias=1e-3),
    "unfinished": om.March("plain", finish=None),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("distance", [5.0, 1e3, 1e6])
def test_pictures_from_far_away_are_those_of_the_reference(method: str, distance: float, precision: str):
    """By every method, with lights, shadows, mirrors and textures, and far from the origin too."""
    at = np.array([1e7, -5e6, 2.5e6])
    mirror = om.Material((0.2, 0.5, 0.8), reflectivity=0.5)
    tiles = om.Material(om.checker((1, 0, 0), (0, 1, 0), size=0.5))
    shape = BODY.paint(mirror) | om.box((4, 0.2, 4), center=(0, -1.2, 0)).paint(tiles)
    lights = [om.PointLight(at + np.array([2, 5, 2]), 20), om.DirectionalLight((-1, -2, -1), 0.5)]
    lit = om.Scene(shape.translate(*at), lights=lights, ambient=0.2)
    angle = math.degrees(2 * math.atan(2.2 / distance))
    camera = om.Camera(at + distance * np.array([3, 2, 4]) / math.sqrt(29), at, fov=angle)
    options = {"march": METHODS[method], "shading": om.Shading(bounces=2), "planes": ("color", "depth", "status")}
    found = om.render(lit, camera, (24, 18), precision=precision, **options)
    expected = om.reference.render(lit, camera, (24, 18), dtype=precision, **options)
    assert (found.status == expected.status).mean() > 0.99
    hit = (found.status == om.Status.HIT) & (expected.status == om.Status.HIT)
    assert hit.sum() > 100
    same = method in ("plain", "unfinished", "fixed")  # the others take other samples, within the same tolerance
    assert np.quantile(np.abs(found.color - expected.color), 0.9) <= (1e-5 if same else 1e-3)
    unit = np.spacing(np.array(distance, precision))
    assert np.quantile(np.abs(found.depth[hit] - expected.depth[hit]), 0.9) <= 2 * unit + (1e-5 if same else 0.03)


@pytest.mark.parametrize("offset", [0.0, 4e6])
def test_programs_in_parts_far_from_the_origin(offset: float, isa: str, precision: str):
    """Cells lie where the scene is: parts of the program give the bits of the whole there."""
    centers = np.random.default_rng(8).uniform(-3, 3, (300, 3))
    at = np.array([0.0, offset, -offset])
    balls = om.spheres(centers + at, 0.3, smooth=0.1)
    options = {"planes": ("depth", "steps", "normal", "status"), "precision": precision, "isa": isa}
    whole, parts = (
        om.render(balls, om.Camera(at + np.array([1, 2, 5]), at), (64, 48), march=om.March(prune=prune), **options)
        for prune in (False, True)
    )
    assert parts.stats["cells"] > 0
    for plane in ("depth", "steps", "normal", "status"):
        assert_array_equal(getattr(parts, plane), getattr(whole, plane))
    origins = np.random.default_rng(9).uniform(-3, 3, (5000, 3)) + at
    few = balls.distance(origins[:100], precision=precision, isa=isa)
    assert_array_equal(balls.distance(origins, precision=precision, isa=isa)[:100], few)


def test_crops_and_threads_of_pictures_from_far_away(isa: str, precision: str):
    """A ray knows its own pixel only, and cones lie where they lie in the whole picture."""
    camera = om.Camera((3e4, 2e4, 4e4), (0, 0, 0), fov=0.004)
    options = {"planes": ("color", "depth", "steps", "normal"), "samples": 2, "precision": precision, "isa": isa}
    whole = om.render(BODY, camera, (80, 72), threads=1, **options)
    part = om.render(BODY, camera, (80, 72), crop=(21, 13, 47, 30), threads=2, **options)
    for plane in ("color", "depth", "steps", "normal"):
        assert_array_equal(getattr(part, plane), getattr(whole, plane)[13:43, 21:68])


@pytest.mark.parametrize("size", [1e-300, 1e-30, 1.0, 1e30, 1e300])
@pytest.mark.parametrize("place", [0.0, 1e-300, 1e30, 1e300])
def test_places_and_sizes_at_the_ends_of_numbers(size: float, place: float, isa: str, precision: str):
    """Nothing is NaN there."""
    shape = om.sphere(size).translate(place, -place, 0)
    eye = np.array([place, -place, 3 * size + 1e-3 * place])
    camera = om.Camera(eye, eye - np.array([0, 0, max(size, 1e-3 * place)]), up=(0, 1, 0))
    image = om.render(shape, camera, (4, 4), planes=("depth", "normal", "status"), precision=precision, isa=isa)
    assert not np.isnan(image.depth).any()
    assert not np.isnan(image.normal).any()
    hits = shape.raycast([eye, [place, 0, 0]], [0, 0, -1], precision=precision, isa=isa)
    assert not np.isnan(hits.t).any()
    assert not np.isnan(shape.distance(eye, precision="float64", isa=isa)).any()


def test_programs_say_what_they_count_from():
    program = om.compile(BODY.translate(1e6, 0, -4e4))
    assert program.anchor == (1e6, 0, -4e4)
    assert "x y z count from (1e+06, 0, -40000)" in str(program)
    assert program.focus is not None
    assert program.focus[0][0] == pytest.approx(1e6, abs=2)
    assert om.compile(BODY).anchor == (0, 0, 0)
    assert "count from" not in str(om.compile(BODY))
