"""Programs that are run in parts, by an octree, give the numbers of the whole program: whatever they are made of.

Zeros may differ in their sign; everything else is compared as it is.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

import octomarch as om
from crowds import SCENES, balls, scattered
from octomarch.planes import PLANES
from octomarch.queries import HIT_PLANES
from strategies import Sample, nested

SIZE = 45, 37  # no whole number of blocks
WHOLE = {"prune": False}
MANY = 4096
"""Queries of fewer points or rays run the whole program."""

Array = NDArray[np.float64]


CAMERAS = {
    "perspective": om.Camera((3, 2, 6), (0, 0, 0)),
    "orthographic": om.OrthographicCamera((3, 2, 6), (0, 0, 0), height=6),
    "panoramic": om.PanoramicCamera((1, 3, 3), (0, 0, 0)),
}
SHADINGS = [
    om.Shading(normals="exact", shadows="soft", occlusion=5),
    om.Shading(normals="central", shadows="hard", bounces=1),
    om.Shading(normals="tetrahedron", shadows="none", occlusion=2),
]
MARCHES = {
    "auto": {},
    "plain": {"method": "plain", "finish": None},
    "relaxed": {"method": "relaxed", "min_distance": 2.5},
    "enhanced": {"method": "enhanced", "max_distance": 7.0},
    "few steps": {"max_steps": 7},
    "one step": {"method": "relaxed", "max_steps": 1},
    "biased": {"bias": 1e-3, "epsilon": 1e-3},
}


@functools.cache
def scene(name: str) -> om.Scene:
    lights = [om.DirectionalLight((-1, -2, -1)), om.PointLight((3, 4, 3), 8)]
    material = om.Material(0.7, reflectivity=0.3)
    return om.Scene(SCENES[name]().paint(material), ambient=0.2, lights=lights)


def rendered(name: str, camera: str = "perspective", march: dict[str, object] | None = None, **options) -> om.Image:
    """Render all planes, with prune as the march says."""
    options = {"planes": tuple(PLANES), "shading": SHADINGS[0]} | options
    return om.render(scene(name), CAMERAS[camera], SIZE, march=om.March(**(march or {})), **options)


def check_same(found: om.Image, expected: om.Image) -> None:
    for plane in expected.planes:
        assert_array_equal(getattr(found, plane), getattr(expected, plane), err_msg=plane)


def uses_octree(image: om.Image) -> bool:
    return image.stats["cell_bytes"] > 0


@pytest.mark.parametrize("name", SCENES)
def test_pictures_are_the_same(name: str, precision: str):
    """Every scene, with a shading of its own."""
    shading = SHADINGS[list(SCENES).index(name) % len(SHADINGS)]
    whole = rendered(name, march=WHOLE, precision=precision, shading=shading)
    found = rendered(name, precision=precision, shading=shading)
    assert uses_octree(found)
    assert not uses_octree(whole)
    assert found.stats["cell_bytes"] > 0
    check_same(found, whole)
    assert np.count_nonzero(found.status == om.Status.HIT) > 50


@pytest.mark.parametrize("march", MARCHES)
@pytest.mark.parametrize("camera", CAMERAS)
def test_every_march_and_camera(march: str, camera: str):
    for name in ("everything", "smooth unions", "a crowd of pins"):
        expected = rendered(name, camera, MARCHES[march] | WHOLE)
        check_same(rendered(name, camera, MARCHES[march]), expected)
        if march == "few steps":
            assert (expected.status == om.Status.STEP_LIMIT).any()


@pytest.mark.parametrize("name", ["everything", "metaballs", "blended boxes", "a mixed crowd", "a crowd and more"])
def test_every_instruction_set_number_of_threads_and_crop(name: str, isa: str, precision: str):
    shading = SHADINGS[0 if "crowd" in name else 1]
    options = {"precision": precision, "isa": isa, "shading": shading}
    whole = rendered(name, march=WHOLE, precision=precision, shading=shading)
    for threads in (1, 3):
        check_same(rendered(name, threads=threads, **options), whole)
    crop = 13, 9, 21, 18
    part = rendered(name, crop=crop, threads=2, **options)
    for plane in part.planes:
        assert_array_equal(getattr(part, plane), getattr(whole, plane)[9:27, 13:34], err_msg=plane)


def test_samples_are_the_same():
    for name in ("unions", "deformed"):
        check_same(rendered(name, samples=3), rendered(name, march=WHOLE, samples=3))


def test_counts_of_the_field_are_those_of_the_whole():
    """Which rays are marched together changes no ray's samples."""
    for name in ("everything", "unions", "smooth unions", "a mixed crowd", "a crowd and more"):
        found, whole = rendered(name).stats, rendered(name, march=WHOLE).stats
        assert found["evaluations"] == whole["evaluations"] > 0
        for stage, counts in whole["stages"].items():
            assert found["stages"][stage]["evaluations"] == counts["evaluations"], stage


def query_points(count: int) -> Array:
    """Points among the balls and far from them, on walls between cells, and such as are none."""
    points = np.random.default_rng(3).uniform(-2.5, 2.5, (count, 3))
    points[::5] *= 1e3
    points[1::7, 0] = 0.0
    points[2::64] = np.round(points[2::64])
    points[3::97, 1] = np.nan
    points[4::101, 2] = np.inf
    points[5::103] = -np.inf
    points[6::107] *= 1e30
    return points


@pytest.mark.parametrize("name", SCENES)
def test_queries_of_many_points_are_those_of_few(name: str, precision: str):
    """Queries of fewer than 4096 points use no octree."""
    shape, points = scene(name).shape, query_points(MANY + 37)
    for query, threads in ((shape.distance, 1), (shape.gradient, 2)):
        few = [query(part, precision=precision) for part in (points[:2000], points[2000:])]
        assert_array_equal(query(points, precision=precision, threads=threads), np.concatenate(few))


def test_queries_in_large_chunks(precision: str):
    """It does not matter how points and rays are divided among threads, nor who is with whom in a cell."""
    shape = scene("smooth unions").shape
    points = query_points(300_000)
    directions = np.random.default_rng(6).normal(size=points.shape)
    distance = shape.distance(points, precision=precision, threads=1)
    hits = shape.raycast(points[:70_000], directions[:70_000], precision=precision, threads=1)
    for threads in (2, 3):
        assert_array_equal(shape.distance(points, precision=precision, threads=threads), distance)
        again = shape.raycast(points[:70_000], directions[:70_000], precision=precision, threads=threads)
        for plane in HIT_PLANES:
            assert_array_equal(getattr(again, plane), getattr(hits, plane), err_msg=plane)
    for first in range(0, 300_000, 97_003):
        few = shape.distance(points[first : first + 2000], precision=precision)
        assert_array_equal(distance[first : first + 2000], few)


@pytest.mark.parametrize("method", ["auto", "plain", "relaxed", "enhanced", "fixed"])
def test_rays_are_those_of_the_whole_program(method: str, precision: str):
    origins = query_points(MANY)
    directions = np.random.default_rng(4).normal(size=(MANY, 3)) * 0.3 - np.clip(origins, -1e3, 1e3)
    directions[7::89] = np.nan
    for name in ("everything", "expressions", "a crowd", "blended boxes"):
        found, whole = (
            scene(name).shape.raycast(
                origins,
                directions,
                march=om.March(method, max_steps=60, max_distance=1e4, prune=prune),
                precision=precision,
            )
            for prune in (True, False)
        )
        for plane in HIT_PLANES:
            assert_array_equal(getattr(found, plane), getattr(whole, plane), err_msg=plane)
        assert set(np.unique(whole.status)) >= {om.Status.HIT, om.Status.INVALID}


@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(sample=nested(4), seed=st.integers(0, 9), smooth=st.sampled_from([0.0, 0.0, 0.1]), double=st.booleans())
def test_shapes_of_any_make(sample: Sample, seed: int, smooth: float, double: bool):
    """A crowd of one shape, of which hypothesis thinks: points and pixels."""
    crowd = om.union(*scattered(24, lambda i: sample.shape, seed), smooth=smooth)
    assume(not om.compile(crowd).is_solid)
    precision = "float64" if double else "float32"
    points = query_points(MANY)
    for query in (crowd.distance, crowd.gradient):
        few = [query(part, precision=precision) for part in (points[:2000], points[2000:])]
        assert_array_equal(query(points, precision=precision), np.concatenate(few))
    images = [
        om.render(crowd, CAMERAS["perspective"], (24, 16), planes=tuple(PLANES), march=march, precision=precision)
        for march in (om.March(), om.March(prune=False))
    ]
    check_same(*images)


@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(
    samples=st.lists(nested(3), min_size=1, max_size=3),
    seed=st.integers(0, 9),
    smooth=st.sampled_from([0.0, 0.02]),
    double=st.booleans(),
)
def test_crowds_of_any_make(samples: list[Sample], seed: int, smooth: float, double: bool):
    """So many that rays go alone where they can, among up to three kinds of shapes and balls."""
    kinds = [sample.shape for sample in samples] + [om.sphere(0.2)]
    crowd = om.union(*scattered(200, lambda i: kinds[i % len(kinds)].scale(0.3), seed, spread=3.0), smooth=smooth)
    assume(not om.compile(crowd).is_solid)
    precision = "float64" if double else "float32"
    images = [
        om.render(crowd, CAMERAS["perspective"], (24, 16), planes=tuple(PLANES), march=march, precision=precision)
        for march in (om.March(), om.March(), om.March(prune=False))
    ]
    for found in images[:2]:
        check_same(found, images[2])


def test_ties_have_the_slope_of_the_operand_that_has_one():
    """A plane through the middle of space touches what is 0 all over: on it, only the plane has a slope."""
    flat = om.box(8, form="exterior")
    plane = om.plane((1, 0, 0), (0, 0, 0)) & om.box(40)
    crowd = [om.sphere(0.1, center=sign * np.array(ball)) for ball in np.eye(3) * 9 + 1 for sign in (1, -1)]
    shape = om.union(~plane & om.box(40), flat, *(ball.translate(0.01 * i, 0, 0) for i in range(10) for ball in crowd))
    points = np.random.default_rng(6).uniform(-3, 3, (MANY, 3))
    points[::2, 0] = 0.0
    few = np.concatenate([shape.gradient(points[:2000]), shape.gradient(points[2000:])])
    assert_array_equal(shape.gradient(points), few)


@pytest.mark.parametrize("factor", [1e-30, 1e-12, 1e12, 1e30, 1e37])
def test_tiny_and_huge_scenes(factor: float, precision: str):
    shape = om.union(*balls(40)).scale(factor)
    camera = om.Camera((3 * factor, 2 * factor, 6 * factor), (0, 0, 0))
    images = [
        om.render(shape, camera, SIZE, planes=tuple(PLANES), march=om.March(prune=prune), precision=precision)
        for prune in (True, False)
    ]
    check_same(*images)
    few = [shape.distance(part * factor, precision=precision) for part in np.split(query_points(MANY), 2)]
    assert_array_equal(shape.distance(query_points(MANY) * factor, precision=precision), np.concatenate(few))


def test_shapes_all_in_one_point():
    """There is nothing to divide; it once took for ever."""
    points = om.union(*(om.capped_cone(0, 0, 0, axis=(1, i, 3)) for i in range(60)))
    image = om.render(points, om.Camera((0, 0, 3), (0, 0, 0)), (16, 16), planes=("status",))
    assert not uses_octree(image)
    assert points.distance(np.ones((MANY, 3)))[0] == pytest.approx(np.sqrt(3))


@pytest.mark.parametrize(
    ("shape", "march"),
    [
        pytest.param(om.union(*balls(8)), om.March(), id="short"),
        pytest.param(om.union(*balls(200), smooth=100), om.March(), id="all of it everywhere"),
        pytest.param(om.union(*balls(200)), om.March("fixed", step=0.1), id="fixed steps"),
        pytest.param(om.union(*balls(200)), om.March(prune=False), id="told not to"),
        pytest.param(om.union(*(om.plane((1, i, 2), (0, 0, 0)) for i in range(60))), om.March(), id="nowhere bounded"),
    ],
)
def test_no_octree_where_there_is_no_use(shape: om.Shape, march: om.March):
    stats = om.render(shape, CAMERAS["perspective"], (16, 16), march=march).stats
    assert (stats["cells"], stats["cell_bytes"]) == (0, 0)


def test_cells_follow_what_is_seen():
    """A picture of many spheres has cells; a part of it, fewer."""
    whole = om.render(om.union(*balls(300)), CAMERAS["perspective"], (96, 72)).stats
    part = om.render(om.union(*balls(300)), CAMERAS["perspective"], (96, 72), crop=(40, 32, 8, 8)).stats
    assert whole["cells"] > 100
    assert 0 < part["cells"] < whole["cells"] / 2
    assert 0 < part["cell_bytes"] < whole["cell_bytes"] < 2**24


def test_cells_stay_with_the_shape():
    """The same picture again makes fewer, as they pay, and gains by them; one from far away needs few more."""
    shape = om.union(*balls(300))
    pictures = [om.render(shape, CAMERAS["perspective"], (96, 72), threads=1) for _ in range(12)]
    first, again, last = (pictures[i].stats for i in (0, 1, -1))
    assert first["cells"] > 100
    assert first["cells"] > again["cells"] > 2 * last["cells"]
    assert first["instructions"] > again["instructions"] > last["instructions"]
    assert last["cell_bytes"] >= first["cell_bytes"]
    for picture in pictures[1:]:
        np.testing.assert_array_equal(picture.color, pictures[0].color)
    far = om.Camera(eye=(0, 0, 500), target=(0, 0, 0), fov=2.0)
    march = om.March(max_distance=1000.0)
    assert om.render(shape, far, (96, 72), march=march, threads=1).stats["cells"] < first["cells"] / 2


def test_ids_and_materials_by_cells():
    """Their programs are run in parts too, to the same bits: smooth and sharp seams, ids that are carved out."""
    random = np.random.default_rng(5)
    paints = [om.Material(color=tuple(random.uniform(0.1, 0.9, 3))) for _ in range(4)]
    painted = [om.union(*balls(60)[k::4], smooth=0.05 * k).paint(paints[k]) for k in range(4)]
    shape = om.union(*painted[:2], smooth=0.1) | (painted[2] - om.metaballs(*balls(40), k=0.001).paint(paints[3]))
    planes = ("color", "object_id", "material_id")
    parts, whole = (
        om.render(shape, size=(96, 72), planes=planes, march=om.March(prune=prune)) for prune in (True, False)
    )
    assert parts.stats["cells"] > 0
    assert len(np.unique(parts.material_id)) > 3
    for plane in planes:
        np.testing.assert_array_equal(getattr(parts, plane), getattr(whole, plane), plane)


def test_prune_is_a_flag():
    with pytest.raises(TypeError, match="prune must be"):
        om.March(prune=1)
    assert om.March().prune
