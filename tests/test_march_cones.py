"""Cones before camera rays: they save evaluations, change no hit, and do not depend on crops or samples."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from marched import CAMERAS, FAR, METHODS, SCENES, SIZE, blend, crowd, picture
from octomarch.planes import PLANES


@pytest.fixture(params=SCENES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_longer_steps_and_cones_need_fewer_evaluations(name: str):
    """Cones' own evaluations counted. Of balls there are no cones, and fewer evaluations all the same."""
    counts = {}
    for method in METHODS:
        stats = picture(name, method=method).stats
        counts[method] = stats["stages"]["primary"]["evaluations"] + stats["stages"]["cones"]["evaluations"]
        assert (stats["stages"]["cones"]["evaluations"] > 0) == (method == "auto" and name != "balls")
    assert counts["auto"] < 0.8 * counts["enhanced"]
    assert counts["enhanced"] < 0.85 * counts["plain"]
    assert counts["relaxed"] < 1.1 * counts["plain"]


def test_long_programs_have_cones_about_few_pixels_too():
    """They save evaluations that cost more than they do; of a short program those cost too little."""
    blocks = SIZE[0] * SIZE[1] // 64
    counts = {name: picture(name).stats["stages"]["cones"]["count"] for name in SCENES}
    assert counts["twisted"] == counts["blend"] == blocks
    assert counts["crowd"] == (1 + 4 + 16) * blocks
    assert counts["balls"] == blocks
    found, alone = (picture("crowd", method=method).stats["stages"] for method in ("auto", "enhanced"))
    evaluations = found["primary"]["evaluations"] + found["cones"]["evaluations"]
    assert evaluations < 0.45 * alone["primary"]["evaluations"]
    assert found["primary"]["evaluations"] < 0.3 * alone["primary"]["evaluations"]


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
