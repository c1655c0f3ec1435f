"""Camera rays of crowds of balls begin at the first that they come near to, with fewer evaluations and equal hits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

import octomarch as om

SIZE = 64, 48
CAMERA = om.Camera((4, 3, 7), (0, 0, 0))
PLANES = ("depth", "status", "steps", "position")


def dust(count: int, smooth: float = 0.0, seed: int = 1) -> om.Shape:
    random = np.random.default_rng(seed)
    return om.spheres(random.uniform(-2, 2, (count, 3)), random.uniform(0.05, 0.25, count), smooth=smooth)


def evaluations(image: om.Image) -> int:
    stages = image.stats["stages"]
    return stages["primary"]["evaluations"] + stages["cones"]["evaluations"]


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param(dust(300), id="united"),
        pytest.param(dust(300, 0.02), id="blended"),
        pytest.param(dust(100, 0.02) | dust(100, 0.03, seed=2) | om.box(0.3).rotate(20, "y"), id="crowds and a box"),
        pytest.param(dust(300) | om.plane(point=(0, -2, 0)), id="on a floor"),
        pytest.param(
            om.union(*(om.sphere(0.2, center=(x, 0, z)) for x in range(-3, 4) for z in range(-3, 4))), id="lattice"
        ),
    ],
)
def test_rays_of_crowds_need_few_evaluations(shape: om.Shape):
    found = {
        method: om.render(shape, CAMERA, SIZE, march=om.March(method), planes=PLANES) for method in ("auto", "enhanced")
    }
    stage = found["auto"].stats["stages"]["cones"]
    assert (stage["evaluations"], stage["count"]) == (0, SIZE[0] * SIZE[1] // 64)
    assert evaluations(found["auto"]) < 0.35 * evaluations(found["enhanced"])


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param(dust(15), id="few"),
        pytest.param(dust(300, 0.5), id="more blend than balls"),
        pytest.param(dust(300) & om.sphere(2), id="cut"),
        pytest.param(dust(300) | om.cylinder(0.1), id="something endless"),
        pytest.param(om.capsules(*np.random.default_rng(3).uniform(-2, 2, (2, 100, 3)), 0.05), id="thin"),
    ],
)
def test_others_have_cones(shape: om.Shape):
    assert om.render(shape, CAMERA, SIZE, planes=("depth",)).stats["stages"]["cones"]["evaluations"] > 0


def test_where_the_hit_epsilon_grows_fast_nothing_is_lost():
    """At the rim of so wide a picture a pixel is wider than it is far away: rays are within it of all balls at once."""
    wide = om.Camera((0, 0, 7), (0, 0, 0), fov=175)
    for tolerance in (0.1, 0.5, 1.0, 3.0):
        auto, enhanced = (
            om.render(dust(100), wide, (80, 40), march=om.March(method, pixel_tolerance=tolerance), planes=("status",))
            for method in ("auto", "enhanced")
        )
        lost = (enhanced.status == om.Status.HIT) & (auto.status != om.Status.HIT)
        assert np.count_nonzero(lost) <= 2, tolerance


@pytest.mark.parametrize("smooth", [0.0, 0.02])
def test_bits_do_not_depend_on_how_they_are_found(smooth: float, isa: str, precision: str):
    shape = dust(500, smooth)
    expected = om.render(shape, CAMERA, SIZE, planes=PLANES, precision=precision, isa="scalar", threads=1)
    for march in (om.March(), om.March(prune=False)):
        image = om.render(shape, CAMERA, SIZE, march=march, planes=PLANES, precision=precision, isa=isa, threads=2)
        for plane in PLANES:
            assert_array_equal(getattr(image, plane), getattr(expected, plane))
    crop = om.render(shape, CAMERA, SIZE, planes=PLANES, precision=precision, isa=isa, crop=(19, 11, 23, 17))
    assert_array_equal(crop.depth, expected.depth[11:28, 19:42])
    assert_array_equal(crop.steps, expected.steps[11:28, 19:42])


CAMERAS = st.sampled_from(
    [
        CAMERA,
        om.Camera((0.1, 0.2, 0.3), (1, 0, 0), fov=120),
        om.OrthographicCamera((3, 2, 4), (0, 0, 0), height=5),
        om.PanoramicCamera((0.5, 1, 2), (0, 0, 0)),
        om.Camera((1e4, 2e3, 1e4), (0, 0, 0), fov=0.02),
    ]
)


@settings(deadline=None, max_examples=60)
@given(
    camera=CAMERAS,
    seed=st.integers(0, 10**6),
    count=st.integers(16, 200),
    k=st.sampled_from([0.0, 0.004, 0.02, 0.05]),
    scale=st.sampled_from([1e-4, 1.0, 1e4]),
    tolerance=st.sampled_from([0.0, 0.1, 3.0]),
)
def test_no_hit_is_lost(camera, seed: int, count: int, k: float, scale: float, tolerance: float):
    """Whatever plain steps meet is met, as near to the surface; within the hit epsilon of silhouettes more may be."""
    if scale != 1.0:
        camera = om.Camera((4 * scale, 3 * scale, 7 * scale), (0, 0, 0))
    shape = dust(count, k, seed).scale(scale)
    epsilon = 1e-4 * scale
    options = {"size": (40, 30), "planes": PLANES, "precision": "float64"}
    march = {"epsilon": epsilon, "pixel_tolerance": tolerance, "max_distance": 3e4 * scale}
    found = om.render(shape, camera, march=om.March(**march), **options)
    truth = om.render(
        shape, camera, march=om.March("plain", max_steps=4000, **march | {"pixel_tolerance": 0.0}), **options
    )
    is_hit = found.status == om.Status.HIT
    lost = (truth.status == om.Status.HIT) & ~is_hit
    # of those only rays that pass within the truth's own epsilon
    assert np.all(shape.distance(truth.position[lost]) > 0)
    assert np.count_nonzero(lost) <= 1
    assert np.all(np.isfinite(found.depth[is_hit]))
    pixel = np.zeros(()) if isinstance(camera, om.OrthographicCamera) else found.depth[is_hit] * 0.2
    near = np.maximum(epsilon, tolerance * np.maximum(pixel, 0.1 * scale))
    assert np.all(np.abs(shape.distance(found.position[is_hit])) <= near)
