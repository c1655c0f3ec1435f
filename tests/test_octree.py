"""Programs that are run in parts, by an octree, give the numbers of the whole program: whatever they are made of.

Zeros may differ in their sign; everything else is compared as it is.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

import every_node
import octomarch as om
from octomarch.planes import PLANES
from octomarch.queries import HIT_PLANES
from strategies import Sample, nested

SIZE = 45, 37  # no whole number of blocks
WHOLE = {"prune": False}
MANY = 4096
"""Queries of fewer points or rays run the whole program."""

Array = NDArray[np.float64]


def scattered(count: int, make: Callable[[int], om.Shape], seed: int = 5, spread: float = 2.0) -> list[om.Shape]:
    """Return shapes about the origin, each turned, scaled and moved in its own way."""
    rng = np.random.default_rng(seed)
    return [
        make(i)
        .rotate(float(rng.uniform(-180, 180)), axis=rng.normal(size=3))
        .scale(float(rng.uniform(0.2, 0.5)))
        .translate(*rng.uniform(-spread, spread, 3))
        for i in range(count)
    ]


def balls(count: int, seed: int = 7) -> list[om.Shape]:
    rng = np.random.default_rng(seed)
    return [om.sphere(0.3, center=rng.uniform(-2, 2, 3)).paint(om.Material(float(rng.random()))) for _ in range(count)]


def boxes(count: int) -> list[om.Shape]:
    return scattered(count, lambda i: om.box((1.0, 0.5 + i % 3, 0.7)))


def crowd(count: int = 3000, seed: int = 9) -> om.Shape:
    return om.spheres(np.random.default_rng(seed).uniform(-2, 2, (count, 3)), np.full(count, 0.05), smooth=0.02)


def mixed_crowd() -> om.Shape:
    """Return small shapes of four kinds, so many that rays go alone among them."""
    rng = np.random.default_rng(10)
    kinds = [om.sphere(0.04), om.box((0.07, 0.03, 0.05)), om.capsule((0, 0, 0), (0.06, 0.06, 0), 0.02)]
    turned = [om.cone(0.03, 0.1).rotate(float(rng.uniform(-180, 180)), axis="z") for _ in range(1500)]
    shapes = [kinds[i % 3] for i in range(3000)] + turned
    rng.shuffle(shapes)
    return om.union(*(shape.translate(*rng.uniform(-2, 2, 3)) for shape in shapes), smooth=0.02)


def pins() -> om.Shape:
    """Return copies of a shape that is made of several, turned."""
    pin = (om.cylinder(0.02, 0.2) | om.sphere(0.05, center=(0, 0.1, 0))) - om.box(0.03, center=(0, 0.12, 0.03))
    rng = np.random.default_rng(11)
    matrices = np.tile(np.eye(4), (1100, 1, 1))
    matrices[:, :3, :3] = np.linalg.qr(rng.normal(size=(1100, 3, 3))).Q
    matrices[:, :3, 3] = rng.uniform(-2, 2, (1100, 3))
    return pin.instances(matrices, smooth=0.01)


def crowd_and_more() -> om.Shape:
    """Return a crowd between shapes of which there is one each, cut by others."""
    x, y, z = om.coordinates()
    wavy = om.sphere(0.7).displace(0.05 * om.noise(4 * x, 4 * y, 4 * z, seed=3), lipschitz=0.6)
    turned = om.box((0.5, 1.5, 0.7)).rotate(30, axis=(1, 1, 0)).translate(-1, 0, 1)
    crowds = crowd(1500) | crowd(300, seed=12).scale(2.0)
    return om.union(turned, crowds, wavy, smooth=0.03) - om.box(2.0, center=(1.5, 1.5, 1.5)) - om.sphere(0.9)


def polygon(corners: int) -> om.Shape:
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    radii = 0.5 + 0.3 * (np.arange(corners) % 2)
    return om.polygon(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1))


def everything() -> om.Shape:
    """Return copies of all kinds of nodes but solids, over a floor."""
    kinds = [shape for shape in every_node.shapes() if not om.compile(shape).is_solid]
    painted = [shape.paint(paint) for shape, paint in zip(kinds, every_node.materials() * 2, strict=False)]
    return om.union(
        *scattered(3 * len(painted), lambda i: painted[i % len(painted)], spread=4), om.plane(point=(0, -2, 0))
    )


def deformed() -> om.Shape:
    crowd = om.union(*balls(25), *boxes(25))
    return crowd.twist(25, axis="y").translate(-4, 0, 0) | crowd.bend(12).translate(4, 0, 0)


def noisy() -> om.Shape:
    x, y, z = om.coordinates()
    bumps = 0.05 * om.noise(4 * x, 4 * y, 4 * z, seed=3)
    return om.union(*(shape.displace(bumps, lipschitz=0.6) for shape in balls(20) + boxes(10)), smooth=0.05)


def written() -> om.Shape:
    """Return fields of one's own: with choices by comparisons and constants, and parts that are no number."""
    x, y, z = om.coordinates()

    def one(i: int) -> om.Shape:
        ball = om.length(x - 0.1 * i, y, z) - 0.3
        kinds = [
            om.where((x < 0.02 * i) & (y > -1), ball, abs(ball) + 0.01),
            om.minimum(om.maximum(abs(x) - 0.4, abs(y) - 0.2), om.clamp(z, 0.1 * i, 3.0)),
            om.maximum(om.minimum(ball, 0.5), -0.1) + 0.05 * om.floor(2 * x) * 0,
            om.where((abs(y - 0.9) < 0.1) & (abs(x) + abs(z) < 0.2), om.sqrt(-1 - y * y), ball),
        ]
        return om.field(kinds[i % len(kinds)], lipschitz=1.5, bounds=((-1, -1, -1), (1, 1, 1)))

    return om.union(*scattered(32, one))


SCENES: dict[str, Callable[[], om.Shape]] = {
    "everything": everything,
    "unions": lambda: om.union(*balls(100), *boxes(30)),
    "intersections": lambda: om.union(*(box & box.translate(0.1, 0.2, 0.1) & ~box.scale(0.95) for box in boxes(40))),
    "differences": lambda: om.difference(om.box(3.5), *balls(60), *boxes(20)),
    "smooth unions": lambda: om.union(*balls(60), smooth=0.2),
    "smooth differences": lambda: om.difference(om.box(3.5), *balls(60), smooth=0.1),
    "smooth intersections": lambda: om.intersection(*(~ball for ball in balls(60)), om.box(3), smooth=0.15),
    "metaballs": lambda: om.metaballs(*balls(100), k=5e-4),
    "repeats": lambda: (
        om.union(*(shape.scale(0.4) for shape in balls(40) + boxes(20))).repeat((2.5, 0, 3.0), counts=(2, None, 2))
        | om.plane(point=(0, -1, 0))
    ),
    "deformed": deformed,
    "noise": noisy,
    "expressions": written,
    "polygons": lambda: om.union(
        *scattered(12, lambda i: polygon(10).extrude(0.4) if i % 2 else polygon(8).revolve(0.6))
    ),
    "rotated boxes": lambda: om.union(*boxes(60)),
    "blended boxes": lambda: om.union(*boxes(60), smooth=0.1),
    "shells": lambda: om.union(*(ball.shell(0.1) for ball in balls(60)), smooth=0.05),
    "capsules": lambda: om.capsules(*np.random.default_rng(8).uniform(-2, 2, (2, 80, 3)), np.full(80, 0.1), smooth=0.1),
    "a crowd": crowd,
    "a mixed crowd": mixed_crowd,
    "a crowd of pins": pins,
    "a crowd and more": crowd_and_more,
    "a room": lambda: om.union(om.box(8).shell(0.1), *balls(60)),
}
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
    """A picture of many spheres has cells; one of its corner, fewer."""
    whole = om.render(om.union(*balls(300)), CAMERAS["perspective"], (96, 72)).stats
    corner = om.render(om.union(*balls(300)), CAMERAS["perspective"], (96, 72), crop=(0, 0, 8, 8)).stats
    assert whole["cells"] > 100
    assert 0 < corner["cells"] < whole["cells"] / 2
    assert 0 < corner["cell_bytes"] < whole["cell_bytes"] < 2**24


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
