"""Ways of stepping: each finds the surfaces that plain steps find, never passes one, and says so truly."""

from __future__ import annotations

import functools
import itertools
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om
from octomarch.planes import PLANES

Array = NDArray[np.float64]

SIZE = 96, 72
FAR = 100.0
METHODS = ["auto", "plain", "relaxed", "enhanced"]
LONGER = ["auto", "relaxed", "enhanced"]


def blend() -> om.Shape:
    """Return scene A of the benchmarks."""
    ball, cube = om.sphere(1.0), om.box(1.5).translate(0.9, 0.3, 0.0)
    return ball.union(cube, smooth=0.25) | om.plane(point=(0, -1, 0))


def building() -> om.Shape:
    """Return scene B of the benchmarks."""
    windows = om.box((0.6, 0.8, 0.6)).repeat((1, 1.5, 1))
    return om.box((4, 12, 4)) - windows - om.cylinder(1.2, axis="y") | om.plane(point=(0, -6, 0))


def crowd() -> om.Shape:
    """Return balls, so many that the octree runs them."""
    rng = np.random.default_rng(7)
    return om.union(*(om.sphere(0.3, center=rng.uniform(-2, 2, 3)) for _ in range(100)), smooth=0.05)


def twisted() -> om.Shape:
    """Return a field that is far steeper in one place than in others."""
    return om.box((1, 3, 1)).twist(40, axis="y") | om.torus(2, 0.1, axis="y")


SCENES: dict[str, tuple[om.Shape, om.Camera]] = {
    "blend": (blend(), om.Camera((3, 2, 4), (0, 0, 0))),
    "building": (building(), om.Camera((9, 4, 12), (0, 0, 0))),
    "crowd": (crowd(), om.Camera((3, 2, 6), (0, 0, 0))),
    "twisted": (twisted(), om.Camera((3, 2, 4), (0, 0, 0))),
}


@functools.cache
def picture(name: str, precision: str = "float32", **settings) -> om.Image:
    shape, camera = SCENES[name]
    march = om.March(**({"max_distance": FAR} | settings))
    return om.render(shape, camera, SIZE, march=march, precision=precision, planes=("depth", "status", "steps"))


def truth(name: str) -> om.Image:
    """Plain steps to a tolerance that is as good as none, in double."""
    return picture(name, "float64", method="plain", max_steps=20_000, epsilon=1e-9, pixel_tolerance=0.0)


@pytest.fixture(params=SCENES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.mark.parametrize("method", METHODS)
def test_surfaces_are_found(name: str, method: str, precision: str):
    """No surface is missed. A ray that comes within the hit epsilon of an edge may hit there, and few do."""
    found, expected = picture(name, precision, method=method), truth(name)
    assert not (expected.status == om.Status.STEP_LIMIT).any()
    surface = expected.status == om.Status.HIT
    assert_array_equal(found.status[surface], om.Status.HIT)
    assert np.count_nonzero(found.status[~surface] != om.Status.MISS) <= 0.005 * found.status.size
    off = np.abs(found.depth[surface] - expected.depth[surface]) / expected.depth[surface]
    assert np.median(off) < {"float32": 1e-7, "float64": 3e-8}[precision]
    assert np.quantile(off, 0.9) < (1e-2 if name == "crowd" else 1e-5)
    # a hit is never behind the surface, but by its tolerance
    assert (found.depth[surface] <= expected.depth[surface] * (1 + 1e-3)).all()


@pytest.mark.parametrize("method", METHODS)
def test_steps_are_counted_and_limited(name: str, method: str):
    steps = picture(name, method=method).steps
    assert steps.max() < 256
    few = picture(name, method=method, max_steps=9)
    assert few.steps.max() == 9
    assert_array_equal(few.steps[few.status == om.Status.STEP_LIMIT], 9)


@pytest.mark.parametrize("max_steps", [1, 2, 3, 5, 9, 20])
@pytest.mark.parametrize("method", METHODS)
def test_no_surface_lies_before_a_candidate(name: str, method: str, max_steps: int):
    """A step of which is not known whether the surface was passed does not count."""
    found, expected = picture(name, "float64", method=method, max_steps=max_steps), truth(name)
    spent = found.status == om.Status.STEP_LIMIT
    assert spent.any() or (name, method, max_steps) == ("building", "auto", 20)  # needs fewer
    assert (found.depth[spent] <= expected.depth[spent] * (1 + 1e-9)).all()
    others = ~spent & (expected.status == om.Status.HIT)
    assert_array_equal(found.status[others], om.Status.HIT)


def rays(count: int) -> tuple[Array, Array]:
    """Return rays from all sides, most of which hit something."""
    rng = np.random.default_rng(12)
    origins = rng.normal(size=(count, 3))
    origins *= 7 / np.linalg.norm(origins, axis=1)[:, None]
    return origins, rng.normal(size=(count, 3)) - origins


@pytest.mark.parametrize("finish", ["secant", None])
@pytest.mark.parametrize("method", METHODS)
def test_rays_are_those_of_the_reference(name: str, method: str, finish: str | None, isa: str):
    """Enhanced steps differ in the last digits of their length, so that few rays need one more or one less."""
    shape, (origins, directions) = SCENES[name][0], rays(150)
    for limits in ({}, {"max_steps": 6}, {"min_distance": 3.0, "max_distance": 6.5}):
        march = om.March(method, finish=finish, **({"max_distance": FAR} | limits))
        found = shape.raycast(origins, directions, march=march, precision="float64", isa=isa)
        expected = om.reference.raycast(shape, origins, directions, march=march)
        known = expected.status != om.Status.STEP_LIMIT if method == "auto" else np.full(150, True)
        assert_array_equal(found.status[known], expected.status[known])
        ended = known & (found.status != om.Status.STEP_LIMIT)
        sooner = ~known & (found.status != om.Status.STEP_LIMIT)
        if sooner.any():
            further = om.March(method, finish=finish, **({"max_distance": FAR} | limits | {"max_steps": 5000}))
            settled = om.reference.raycast(shape, origins[sooner], directions[sooner], march=further)
            assert_array_equal(found.status[sooner], settled.status)
            assert_allclose(found.t[sooner], settled.t, rtol=1e-3 if finish is None else 1e-4)
        assert_allclose(found.t[ended], expected.t[ended], rtol=1e-3 if finish is None else 1e-4)
        if method in ("plain", "relaxed"):
            assert_allclose(found.t, expected.t, rtol=1e-6)
            assert_array_equal(found.steps, expected.steps)
        if method == "auto":  # less is marched
            assert found.steps.sum() <= expected.steps.sum()
        else:
            assert np.median(np.abs(found.steps - expected.steps)) == 0
            assert np.abs(found.steps - expected.steps).max() <= 8


@pytest.mark.parametrize("method", LONGER)
@pytest.mark.parametrize("distance", [1.3, 1.7, 1.999])
def test_no_shell_before_the_farthest_distance_is_missed(method: str, distance: float, isa: str, precision: str):
    """Long steps end at max_distance, where walls a little before it, thin ones too, are still in the way."""
    rng = np.random.default_rng(3)
    height = rng.uniform(0.3, 0.99, 500) * distance
    slope = np.concatenate([np.zeros(250), rng.uniform(0, 0.3, 250)])
    directions = np.stack([np.sin(slope), 0 * slope, -np.cos(slope)], axis=-1)
    march = om.March(method, max_distance=distance, epsilon=1e-6)
    origins = np.stack([0 * height, 0 * height, height], axis=-1)
    hits = (
        om.plane((0, 0, 1), (0, 0, 0))
        .shell(1e-3)
        .raycast(origins, directions, march=march, precision=precision, isa=isa)
    )
    expected = (height - 5e-4) / np.cos(slope)
    clear = expected < distance * 0.9999
    assert_array_equal(hits.status[clear], om.Status.HIT)
    assert_allclose(hits.t[clear], expected[clear], rtol=1e-5)


@pytest.mark.parametrize("method", LONGER)
def test_a_farthest_distance_that_a_sum_is_rounded_past(method: str, isa: str):
    """The sum t + (t_max − t) may be the number after t_max, as in float of these. What lies before is hit."""
    unit = 2.0**-23
    for far, start in itertools.product(1 + np.arange(1001, 1301, 50) * unit, np.arange(0.5, 8) * unit):
        heights = np.linspace(0.65, 0.99, 40)
        origins = np.stack([0 * heights, 0 * heights, heights], axis=-1)
        march = om.March(method, max_distance=far, min_distance=start)
        hits = om.plane((0, 0, 1)).raycast(origins, [0, 0, -1], march=march, precision="float32", isa=isa)
        assert_array_equal(hits.status, om.Status.HIT)


@pytest.mark.parametrize("finish", ["secant", None])
@pytest.mark.parametrize("method", METHODS)
def test_hits_do_not_lie_behind_a_wall(method: str, finish: str | None, isa: str, precision: str):
    """Square to a wall, the sphere of a sample behind it touches the one before it, as after a step well taken."""
    heights = np.linspace(0.5, 5, 333)
    origins = np.stack([0 * heights, 0 * heights, heights], axis=-1)
    march = om.March(method, finish=finish, epsilon=1e-5)
    for shape in (om.plane((0, 0, 1)), om.box((4, 4, 1)).translate(0, 0, -0.5), om.sphere(1).translate(0, 0, -1)):
        hits = shape.raycast(origins, [0, 0, -1], march=march, precision=precision, isa=isa)
        assert_array_equal(hits.status, om.Status.HIT)
        assert_allclose(hits.t, heights, atol=2e-5)
        if precision == "float64":
            reference = om.reference.raycast(shape, origins[::7], [0, 0, -1], march=march)
            assert_allclose(reference.t, heights[::7], atol=2e-5)


@pytest.mark.parametrize("method", METHODS)
def test_what_is_no_number_behind_a_surface_does_not_matter(method: str, isa: str, precision: str):
    """A long step may end there, and goes back. Before the surface, it makes rays invalid."""
    _, y, z = om.coordinates()
    wall = om.field(om.where(z < 0.2, om.sqrt(-1 - z * z), z - 0.3), lipschitz=1)
    heights = np.linspace(0.5, 6, 100)
    directions = np.stack([0.4 * np.sin(heights), 0 * heights, -np.ones(100)], axis=-1)
    origins = np.stack([0 * heights, 0 * heights, heights], axis=-1)
    march = om.March(method)
    hits = wall.raycast(origins, directions, march=march, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    assert_allclose(hits.t, heights - 0.3, rtol=1e-5)
    assert_array_equal(om.reference.raycast(wall, origins, directions, march=march).status, om.Status.HIT)
    fog = om.field(om.where(abs(z - 2) < 1, om.sqrt(-1 - y * y), z - 0.3), lipschitz=1)
    assert_array_equal(
        fog.raycast([[0, 0, 2.5], [0, 0, 0.5]], [0, 0, -1], march=march, isa=isa).status,
        [om.Status.INVALID, om.Status.HIT],
    )


def test_longer_steps_and_cones_need_fewer_evaluations(name: str):
    """Cones' own evaluations counted."""
    counts = {}
    for method in METHODS:
        stats = picture(name, method=method).stats
        counts[method] = stats["stages"]["primary"]["evaluations"] + stats["stages"]["cones"]["evaluations"]
        assert (stats["stages"]["cones"]["evaluations"] > 0) == (method == "auto")
    assert counts["auto"] < 0.8 * counts["enhanced"]
    assert counts["enhanced"] < 0.85 * counts["plain"]
    assert counts["relaxed"] < 1.1 * counts["plain"]


def test_long_programs_have_cones_about_few_pixels_too():
    """They save evaluations that cost more than they do; of a short program those cost too little."""
    blocks = SIZE[0] * SIZE[1] // 64
    counts = {name: picture(name).stats["stages"]["cones"]["count"] for name in SCENES}
    assert counts["twisted"] == counts["blend"] == blocks
    assert counts["crowd"] == (1 + 4 + 16) * blocks
    found, alone = (picture("crowd", method=method).stats["stages"] for method in ("auto", "enhanced"))
    evaluations = found["primary"]["evaluations"] + found["cones"]["evaluations"]
    assert evaluations < 0.45 * alone["primary"]["evaluations"]
    assert found["primary"]["evaluations"] < 0.3 * alone["primary"]["evaluations"]


CAMERAS = {
    "perspective": om.Camera((3, 2, 4), (0, 0, 0)),
    "wide": om.Camera((0.5, 1.5, 2), (0, 0, 0), fov=150),
    "orthographic": om.OrthographicCamera((3, 2, 4), (0, 0, 0), height=5),
    "panoramic": om.PanoramicCamera((2, 2, 2), (0, 0, 0)),
    "inside": om.Camera((0.1, 0.2, 0.3), (3, 0, 0)),
}


def cast(shape: om.Shape, camera: str, method: str, **options) -> om.Image:
    march = om.March(method, **({"max_distance": FAR} | options.pop("march", {})))
    return om.render(shape, CAMERAS[camera], (61, 43), march=march, **options)


def hit_tolerance(camera: str, t: np.ndarray, march: dict[str, float]) -> np.ndarray:
    """Return the hit epsilon at t in pictures of 43 rows, as docs/semantics.md has it; 1e-5 for what roundings need."""
    seen = CAMERAS[camera]
    if isinstance(seen, om.OrthographicCamera):
        pixel = np.full_like(t, seen.height / 2 / 43)
    elif isinstance(seen, om.PanoramicCamera):
        pixel = t * math.radians(seen.fov[1]) / 2 / 43
    else:
        pixel = t * math.tan(math.radians(seen.fov) / 2) / 43
    return np.maximum(march.get("epsilon", 1e-5), march.get("pixel_tolerance", 0.1) * pixel)


def are_missed_in_truth(
    shape: om.Shape, camera: str, alone: om.Image, together: om.Image, rays: np.ndarray, march: dict[str, float]
) -> np.ndarray:
    """Tell for which of some rays it is proven that the first picture's hits are none, as the second one says."""
    if not rays.any() or camera == "orthographic":
        return np.zeros(np.count_nonzero(rays), dtype=bool)
    eye = np.array(CAMERAS[camera].eye)
    limits = {"t_min": march.get("min_distance", 0.0), "max_distance": march.get("max_distance", FAR)}
    along = alone.position[rays] - eye
    is_hit = (alone.status[rays] == om.Status.HIT) & (together.status[rays] == om.Status.MISS)
    along = np.where(is_hit[:, None], along / np.linalg.norm(along, axis=1, keepdims=True), (1.0, 0.0, 0.0))
    verdict = om.reference.certified(shape, eye, along, **limits).status
    return is_hit & (verdict == om.reference.Verdict.MISS)


@pytest.mark.parametrize("camera", CAMERAS)
def test_cones_change_no_hit(name: str, camera: str, precision: str):
    """But at silhouettes, where rays pass within the hit epsilon. Hits lie as near to the surface as without them."""
    shape = SCENES[name][0]
    for march in ({}, {"min_distance": 1.5}, {"max_distance": 5.0}, {"epsilon": 0.02}, {"pixel_tolerance": 2.0}):
        alone, together = (
            cast(shape, camera, method, march=march, precision=precision, planes=("status", "depth", "position"))
            for method in ("enhanced", "auto")
        )
        different = alone.status != together.status
        different[different] = ~are_missed_in_truth(shape, camera, alone, together, different, march)
        is_coarse = "epsilon" in march or "pixel_tolerance" in march
        assert np.count_nonzero(different) <= (0.02 if is_coarse else 0.002) * different.size
        inside = (alone.status == together.status) & (alone.status == om.Status.INSIDE)
        assert_array_equal(together.depth[inside], alone.depth[inside])
        hits = (alone.status == together.status) & (alone.status == om.Status.HIT)
        lipschitz = om.compile(shape).lipschitz
        errors = [abs(shape.distance(image.position[hits])) for image in (together, alone)]
        for error, image in zip(errors, (together, alone), strict=True):
            assert (error <= lipschitz * hit_tolerance(camera, image.depth[hits].astype(float), march) * 1.001).all()
        if camera != "wide":  # where a ray that grazes the ball ends nearer to that limit than any without cones
            near, nearer = (error.max(initial=0) for error in errors)
            assert near <= 1.25 * nearer + 1e-6


@pytest.mark.parametrize("shape", [blend(), crowd()], ids=["blend", "crowd"])
@pytest.mark.parametrize("camera", CAMERAS)
def test_crops_and_samples_of_cones_have_the_bits_of_the_whole(camera: str, shape: om.Shape, precision: str):
    options = {"precision": precision, "planes": tuple(PLANES)}
    for samples in (1, 3):
        whole = cast(shape, camera, "auto", samples=samples, **options)
        for x, y, width, height in ((0, 0, 9, 9), (13, 7, 1, 1), (5, 3, 50, 30), (60, 42, 1, 1)):
            crop = cast(shape, camera, "auto", crop=(x, y, width, height), samples=samples, **options)
            for plane in PLANES:
                expected = np.ascontiguousarray(getattr(whole, plane)[y : y + height, x : x + width])
                assert getattr(crop, plane).tobytes() == expected.tobytes(), plane


def test_cones_do_not_enter_what_is_no_number():
    """A cone's axis may pass where there is no number, though none of its rays does, and the other way round."""
    x, y, z = om.coordinates()
    shape = om.field(om.where(abs(x) + abs(y) < 0.05, om.sqrt(-1 - z * z), om.length(x, y, z) - 1), lipschitz=1)
    camera = om.OrthographicCamera((0, 0, 4), (0, 0, 0), height=2)
    images = [
        om.render(shape, camera, (64, 64), march=om.March(method), planes=("status", "depth"))
        for method in ("enhanced", "auto")
    ]
    assert (images[0].status == om.Status.HIT).sum() > 2000
    assert_array_equal(images[1].status, images[0].status)


def test_rays_that_begin_in_the_solid_are_inside_with_cones_too(precision: str):
    many = om.spheres(np.random.default_rng(5).uniform(20, 30, (100, 3)), np.full(100, 0.1))
    solid, thick = om.sphere(0.8), om.sphere(2.0).shell(1.2)
    for shape, start in ((solid, 0.0), (thick, 1.5), (solid | many, 0.0), (thick | many, 1.5)):
        camera = om.Camera((0, 0, 0), (0, 0, -1), fov=60)
        image = om.render(
            shape, camera, (32, 32), march=om.March(min_distance=start), precision=precision, planes=("status",)
        )
        assert_array_equal(image.status, om.Status.INSIDE)


@pytest.mark.parametrize("method", LONGER)
def test_with_a_bias_all_steps_are_plain(method: str, isa: str, precision: str):
    """Bit by bit."""
    shape, (origins, directions) = blend(), rays(500)
    for bias in (1e-6, 0.01, 1.0):
        found, expected = (
            shape.raycast(origins, directions, march=om.March(m, bias=bias), precision=precision, isa=isa)
            for m in (method, "plain")
        )
        for plane in ("t", "status", "steps"):
            assert getattr(found, plane).tobytes() == getattr(expected, plane).tobytes()


def test_cones_keep_off_by_the_bias_too():
    """A ball that says it is farther than it is, by no more than the bias, is found by what begins at cones' ends."""
    x, y, z = om.coordinates()
    distance = om.length(x, y, z) - 1
    shape = om.field(distance + om.minimum(0.05, 0.1 * om.maximum(distance, 0)), lipschitz=1)
    camera = om.Camera((0, 0, 4), (0, 0, 0))
    truth, found = (
        om.render(s, camera, (64, 64), march=march, planes=("status", "depth"))
        for s, march in ((om.sphere(1.0), om.March("plain")), (shape, om.March(bias=0.05)))
    )
    hits = truth.status == om.Status.HIT
    assert np.count_nonzero(found.status != truth.status) < 10
    assert_array_equal(found.status[hits], om.Status.HIT)
    assert np.quantile(np.abs(found.depth[hits] - truth.depth[hits]), 0.95) < 1e-4


@pytest.mark.parametrize("method", METHODS)
def test_shadows_are_those_of_plain_steps(method: str):
    """However camera rays go, shadow rays take plain steps: pictures differ by no more than hits do."""
    lights = [om.DirectionalLight((-1, -2, -1)), om.PointLight((3, 3, 3), 5)]
    scene = om.Scene(blend(), ambient=0.2, lights=lights)
    for shadows in ("hard", "soft"):
        plain, other = (
            om.render(scene, CAMERAS["perspective"], (61, 43), march=om.March(m), shading=om.Shading(shadows=shadows))
            for m in ("plain", method)
        )
        off = np.abs(plain.color - other.color).max(axis=-1)
        assert (off < 1e-3).mean() > 0.98


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        (
            {"method": "fast"},
            ValueError,
            "method must be one of 'auto', 'plain', 'relaxed', 'enhanced', 'fixed', 'certified', got 'fast'",
        ),
        ({"method": "Auto"}, ValueError, "method must be .* got 'Auto'"),
        ({"method": 1}, (TypeError, ValueError), "method must be"),
        ({"method": None}, (TypeError, ValueError), "method must be"),
        *(
            ({"method": method, "step": 0.1}, ValueError, "step must be None unless method is 'fixed', got 0.1")
            for method in METHODS
        ),
        *(({"method": m, "bias": b}, ValueError, "bias must be") for m, b in itertools.product(LONGER, (-1.0, np.nan))),
    ],
)
def test_wrong_arguments(settings: dict[str, object], error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.March(**settings)


def test_auto_is_what_there_is_by_default():
    assert om.March() == om.March("auto")
    found, expected = (
        om.render(blend(), size=(40, 30), planes=("depth",), **options) for options in ({}, {"march": om.March("auto")})
    )
    assert found.depth.tobytes() == expected.depth.tobytes()
