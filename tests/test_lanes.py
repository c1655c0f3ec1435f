"""No lane knows of another: the same ray gives the same bits on whichever lane, packet, block, thread or instruction
set it runs, and whatever runs beside it.

All comparisons here are of bits.
"""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import octomarch as om
from octomarch.planes import PLANES
from octomarch.queries import HIT_PLANES
from strategies import POINTS, Sample, nested

COUNTS = [1, 7, 8, 9, 63, 64, 65, 129]

SCENE = om.union(
    om.sphere(1.0).union(om.box(1.5, center=(0.9, 0.3, 0)).rotate(20, (1, 1, 0)), smooth=0.25).paint(om.Material(0.3)),
    (om.torus(0.8, 0.2, axis="x") - om.box(0.5)).translate(-1.5, 0.2, 0.5).paint(om.Material(0.6, roughness=0.2)),
    om.capsule((-0.2, 0, 0), (0.1, 0.3, 0.2), 0.1).repeat((1, 0, 1.25), (None, None, 4)).translate(0, -0.75, 0),
    om.plane(point=(0, -1, 0)),
)
"""Every kind of operator; what rays meet there takes from one step to all of them."""

rng = np.random.default_rng(23)
ORIGINS = rng.normal(size=(300, 3)) * 0.5 + [0, 2.5, 4]
DIRECTIONS = rng.normal(size=(300, 3)) * 0.7 - ORIGINS
MARCH = om.March(max_steps=40, max_distance=30)

Arrays = Mapping[str, NDArray]


def bits(values: NDArray) -> NDArray:
    return values.view({4: np.uint32, 8: np.uint64, 1: np.uint8}[values.dtype.itemsize])


def assert_same_bits(found: NDArray, expected: NDArray, name: str = "") -> None:
    assert found.dtype == expected.dtype
    assert found.shape == expected.shape
    different = np.flatnonzero(bits(found) != bits(expected))
    assert different.size == 0, f"{name}: {different.size} of {found.size} differ, first {different[:5]}"


def cast(origins: NDArray, directions: NDArray, **options) -> Arrays:
    hits = SCENE.raycast(origins, directions, march=MARCH, **options)
    return {plane: getattr(hits, plane) for plane in HIT_PLANES}


def assert_same_hits(found: Arrays, expected: Arrays, rows=slice(None)) -> None:
    for plane in HIT_PLANES:
        assert_same_bits(found[plane], np.ascontiguousarray(expected[plane][rows]), plane)


@pytest.fixture(params=["float32", "float64"], scope="module")
def precision(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def alone(precision: str) -> Arrays:
    """Every ray cast by itself, one lane wide: what all others must equal."""
    parts = [
        cast(o[None], d[None], precision=precision, isa="scalar") for o, d in zip(ORIGINS, DIRECTIONS, strict=True)
    ]
    return {plane: np.concatenate([part[plane] for part in parts]) for plane in HIT_PLANES}


def test_the_rays_of_these_tests_end_in_every_way(alone: Arrays):
    assert set(alone["status"]) == {om.Status.HIT, om.Status.MISS, om.Status.STEP_LIMIT}
    assert len(set(alone["object_id"])) >= 5
    assert len(set(alone["steps"])) > 20


@pytest.mark.parametrize("count", COUNTS)
def test_any_number_of_rays(count: int, alone: Arrays, isa: str, precision: str):
    found = cast(ORIGINS[:count], DIRECTIONS[:count], precision=precision, isa=isa)
    assert_same_hits(found, alone, slice(count))


@pytest.mark.parametrize("seed", range(3))
def test_any_order_of_rays(seed: int, alone: Arrays, isa: str, precision: str):
    order = np.random.default_rng(seed).permutation(len(ORIGINS))
    assert_same_hits(cast(ORIGINS[order], DIRECTIONS[order], precision=precision, isa=isa), alone, order)


@pytest.mark.parametrize("first", [1, 3, 8, 60])
def test_any_split_of_rays(first: int, alone: Arrays, isa: str, precision: str):
    for part in (slice(first), slice(first, None)):
        assert_same_hits(cast(ORIGINS[part], DIRECTIONS[part], precision=precision, isa=isa), alone, part)


def test_slots_are_refilled_without_a_trace(alone: Arrays, isa: str, precision: str):
    """Rays that end at once and rays that take all steps, so that packets come and go at different times."""
    order = np.tile(np.argsort(alone["steps"], kind="stable"), 20)
    order = order.reshape(-1, 8)[np.random.default_rng(1).permutation(len(order) // 8)].ravel()
    assert_same_hits(cast(ORIGINS[order], DIRECTIONS[order], precision=precision, isa=isa), alone, order)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_any_number_of_threads(threads: int, alone: Arrays, isa: str, precision: str):
    order = np.tile(np.arange(len(ORIGINS)), 60)  # more than one task of 4096 rays
    found = cast(ORIGINS[order], DIRECTIONS[order], precision=precision, isa=isa, threads=threads)
    assert_same_hits(found, alone, order)


BAD_RAYS = {
    "origin NaN": ((np.nan, 0, 0), (0, 0, -1)),
    "origin infinite": ((0, np.inf, 0), (0, 0, -1)),
    "direction NaN": ((0, 0, 4), (0, np.nan, -1)),
    "direction infinite": ((0, 0, 4), (0, 0, -np.inf)),
    "direction zero": ((0, 0, 4), (0, 0, 0)),
}


@pytest.mark.parametrize("bad", BAD_RAYS)
@pytest.mark.parametrize("lane", [0, 3, 7, 8, 63, 64, 127])
def test_one_bad_ray_among_good_ones(bad: str, lane: int, alone: Arrays, isa: str, precision: str):
    origins, directions = ORIGINS[:129].copy(), DIRECTIONS[:129].copy()
    origins[lane], directions[lane] = BAD_RAYS[bad]
    found = cast(origins, directions, precision=precision, isa=isa)
    assert found["status"][lane] == om.Status.INVALID
    assert found["t"][lane] == np.inf
    assert found["steps"][lane] == 0
    others = np.delete(np.arange(129), lane)
    assert_same_hits({plane: values[others] for plane, values in found.items()}, alone, others)


@pytest.mark.parametrize("good", [0, 5, 7])
def test_one_good_ray_among_bad_ones(good: int, alone: Arrays, isa: str, precision: str):
    origins = np.full((65, 3), np.nan)
    origins[good::8] = ORIGINS[good]
    found = cast(origins, DIRECTIONS[good], precision=precision, isa=isa)
    rows = np.arange(good, 65, 8)
    assert_same_hits({plane: values[rows] for plane, values in found.items()}, alone, np.full(len(rows), good))


def test_planes_do_not_depend_on_which_others_are_asked_for(alone: Arrays, isa: str, precision: str):
    for plane in HIT_PLANES:
        hits = SCENE.raycast(ORIGINS, DIRECTIONS, march=MARCH, planes=plane, precision=precision, isa=isa)
        assert_same_bits(getattr(hits, plane), alone[plane], plane)


# Instruction sets ----------------------------------------------------------------------------------------------------


def assert_same_on_all_isas(compute: Callable[[str], NDArray]) -> None:
    expected = compute("scalar")
    for isa in om.isas():
        assert_same_bits(compute(isa), expected, isa)


@given(sample=nested())
def test_fields_have_equal_bits_on_all_isas(precision: str, sample: Sample):
    assert_same_on_all_isas(lambda isa: sample.shape.distance(POINTS, precision=precision, isa=isa))
    assert_same_on_all_isas(lambda isa: sample.shape.gradient(POINTS, precision=precision, isa=isa))


@given(sample=nested())
def test_hits_have_equal_bits_on_all_isas(precision: str, sample: Sample):
    march = om.March(max_steps=50, max_distance=30)

    def compute(isa: str) -> list[NDArray]:
        hits = sample.shape.raycast(POINTS * 2, -POINTS, march=march, precision=precision, isa=isa)
        return [getattr(hits, plane) for plane in HIT_PLANES]

    expected = compute("scalar")
    for isa in om.isas():
        for name, found, values in zip(HIT_PLANES, compute(isa), expected, strict=True):
            assert_same_bits(found, values, f"{name} on {isa}")


@given(values=st.lists(st.floats(width=32, allow_nan=False, allow_infinity=False), min_size=3, max_size=195))
def test_fields_at_odd_numbers_have_equal_bits_on_all_isas(precision: str, values: list[float]):
    """Denormals, negative zeros, huge ones: floor and comparisons must agree there too."""
    points = np.array(values[: len(values) // 3 * 3]).reshape(-1, 3)
    assert_same_on_all_isas(lambda isa: SCENE.distance(points, precision=precision, isa=isa))
    assert_same_on_all_isas(lambda isa: SCENE.gradient(points, precision=precision, isa=isa))


GLASSY = om.Material(om.stripes(0.3, 0.7, width=0.3), roughness=0.2, reflectivity=om.clamp(om.coordinates()[1], 0, 0.9))
LIT = om.Scene(
    om.union(SCENE.paint(GLASSY), om.sphere(0.4, center=(1.8, 0, 1)).paint(om.Material(0.5, reflectivity=0.5))),
    sky=om.GradientSky([(-10, 0.1), (20, (0.3, 0.5, 0.9))]),
    ambient=(0.2, 0.25, 0.3),
    lights=[
        om.DirectionalLight((-1, -2, -1), color=(0.7, 0.6, 0.5)),
        om.PointLight((2, 3, 2), color=(5, 6, 7)),
        om.PointLight((-2, 1, 1), color=0.5, decay=1),
        om.PointLight((0, 2, 3), color=0.125, decay=0),
        om.SpotLight((1, 4, 1), target=(0, 0, 0), color=4, angle=35, softness=0.7),
    ],
)
VIEWS = {
    "perspective": om.Camera((3, 2, 4), (0, 0, 0)),
    "orthographic": om.OrthographicCamera((3, 2, 4), (0, 0, 0), height=5),
}
SHADINGS = {
    "soft": om.Shading(shadows="soft", shadow_k=8, occlusion=5),
    "hard": om.Shading(shadows="hard", occlusion=3),
    "central": om.Shading(normals="central", shadows="none", occlusion=0),
    "tetrahedron": om.Shading(normals="tetrahedron", shadows="none", occlusion=0, bounces=2),
}


@pytest.fixture(params=[(view, shading) for view in VIEWS for shading in SHADINGS], ids="-".join, scope="module")
def picture(request: pytest.FixtureRequest, precision: str) -> Callable[..., om.Image]:
    view, shading = request.param

    def render(**options) -> om.Image:
        options = {"planes": tuple(PLANES), "size": (67, 35), **options}
        return om.render(LIT, VIEWS[view], march=om.March(max_steps=60), shading=SHADINGS[shading],
                         precision=precision, **options)  # fmt: skip

    return render


def test_pictures_have_equal_bits_on_all_isas_and_threads(picture: Callable[..., om.Image]):
    expected = picture(isa="scalar", threads=1)
    assert len(np.unique(expected.color)) > 1000
    for isa in om.isas():
        for threads in (1, 2, 3):
            found = picture(isa=isa, threads=threads)
            for plane in PLANES:
                assert_same_bits(getattr(found, plane), getattr(expected, plane), f"{plane} on {isa} by {threads}")


def test_pixels_do_not_depend_on_which_planes_are_asked_for(picture: Callable[..., om.Image]):
    whole = picture()
    for plane in PLANES:
        assert_same_bits(getattr(picture(planes=plane), plane), getattr(whole, plane), plane)
