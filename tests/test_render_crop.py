"""Crops are exactly those pixels of the whole picture, whatever else is asked for."""

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

import octomarch as om
from octomarch.planes import PLANES
from octomarch.reference import REFERENCE_PLANES

SIZE = WIDTH, HEIGHT = 77, 69  # more than one tile, and no whole number of packets
SCENE = om.Scene(
    (om.sphere(1.0).paint(om.Material((0.8, 0.2, 0.1))).union(om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25))
    | om.plane(point=(0, -1, 0)),
    ambient=0.2,
    lights=[om.DirectionalLight((-1, -2, -1)), om.PointLight((3, 3, 3), 5)],
)
CAMERAS = {
    "perspective": om.Camera((3, 2, 4), (0, 0, 0)),
    "orthographic": om.OrthographicCamera((3, 2, 4), (0, 0, 0), height=5),
    "panoramic": om.PanoramicCamera((3, 2, 4), (0, 0, 0), fov=(120, 90)),
}


@st.composite
def crops(draw: st.DrawFn) -> tuple[int, int, int, int]:
    x, y = draw(st.integers(0, WIDTH - 1)), draw(st.integers(0, HEIGHT - 1))
    most = st.integers(1, WIDTH - x), st.integers(1, HEIGHT - y)
    return x, y, draw(st.one_of(st.just(1), most[0])), draw(st.one_of(st.just(1), most[1]))


@functools.cache
def whole(camera: str, **options) -> om.Image:
    return om.render(SCENE, CAMERAS[camera], SIZE, planes=tuple(PLANES), **options)


def check_same(part: om.Image, all_of_it: om.Image, crop: tuple[int, int, int, int]) -> None:
    x, y, width, height = crop
    assert part.size == (width, height)
    for name in part.planes:
        expected = getattr(all_of_it, name)[y : y + height, x : x + width]
        assert getattr(part, name).tobytes() == np.ascontiguousarray(expected).tobytes(), name


@settings(max_examples=25)
@given(
    crop=crops(), camera=st.sampled_from(sorted(CAMERAS)), samples=st.sampled_from([1, 1, 3]), threads=st.integers(1, 3)
)
def test_crops_hold_the_bits_of_the_whole(
    isa: str, precision: str, crop: tuple[int, int, int, int], camera: str, samples: int, threads: int
):
    options = {"precision": precision, "isa": isa, "samples": samples}
    part = om.render(SCENE, CAMERAS[camera], SIZE, planes=tuple(PLANES), crop=crop, threads=threads, **options)
    check_same(part, whole(camera, **options), crop)
    assert part.stats["rays"] == crop[2] * crop[3] * (1 if samples == 1 else samples + 1)


@settings(max_examples=20)
@given(crop=crops(), camera=st.sampled_from(sorted(CAMERAS)), samples=st.sampled_from([1, 2]))
def test_crops_of_the_reference_hold_the_bits_of_the_whole(crop: tuple[int, int, int, int], camera: str, samples: int):
    crop = crop[0] // 6, crop[1] // 6, min(crop[2], 2), min(crop[3], 2)
    options = {"size": (14, 13), "planes": REFERENCE_PLANES, "samples": samples}
    part = om.reference.render(SCENE, CAMERAS[camera], crop=crop, **options)
    check_same(part, om.reference.render(SCENE, CAMERAS[camera], **options), crop)


def test_a_crop_of_all_is_all(isa: str):
    check_same(
        om.render(SCENE, CAMERAS["perspective"], SIZE, planes=tuple(PLANES), crop=(0, 0, *SIZE), isa=isa),
        whole("perspective", isa=isa),
        (0, 0, *SIZE),
    )


def test_a_crop_without_a_camera_is_framed_as_the_whole():
    all_of_it = om.render(om.sphere(1.0), size=SIZE)
    check_same(om.render(om.sphere(1.0), size=SIZE, crop=(30, 20, 9, 7)), all_of_it, (30, 20, 9, 7))


def test_far_corners_of_huge_pictures_are_rendered_alone():
    """One pixel of a picture of 2²⁸; floats hold its number, and the ray is the one of the formula."""
    camera = om.OrthographicCamera((0, 4, 0), (0, 0, 0), up=(0, 0, -1), height=2)
    image = om.render(om.plane(), camera, (2**14, 2**14), crop=(2**14 - 1, 0, 1, 1), planes="position")
    np.testing.assert_allclose(image.position[0, 0], [1, 0, -1], atol=2e-4)


def test_metadata_holds_the_crop():
    crop = np.array([1, 2, 3, 4])
    assert om.render(om.sphere(1.0), size=SIZE, crop=crop).metadata["render"]["crop"] == (1, 2, 3, 4)
    assert om.render(om.sphere(1.0), size=SIZE).metadata["render"]["crop"] is None
    assert om.reference.render(om.sphere(1.0), size=SIZE, crop=crop).metadata["render"]["crop"] == (1, 2, 3, 4)


@pytest.mark.parametrize(
    ("crop", "error", "message"),
    [
        ((0, 0, 0, 1), ValueError, r"crop\[2\] must lie in \[1, .*got 0"),
        ((0, 0, 1, -1), ValueError, r"crop\[3\] must lie in \[1, .*got -1"),
        ((-1, 0, 1, 1), ValueError, r"crop\[0\] must lie in \[0, .*got -1"),
        ((0, 68, 1, 2), ValueError, r"crop must lie within the size \(77, 69\), got \(0, 68, 1, 2\)"),
        ((77, 0, 1, 1), ValueError, "crop must lie within the size"),
        ((2**31 - 1, 0, 2**31 - 1, 1), ValueError, "crop must lie within the size"),
        ((0, 0, 10**10, 1), ValueError, r"crop\[2\] must lie in"),
        ((0, 0, 1), ValueError, r"crop must be \(x, y, width, height\), got \(0, 0, 1\)"),
        ((0, 0, 1, 1.0), TypeError, r"crop\[3\] must be an integer, got 1.0"),
        ((0, 0, 1, True), TypeError, r"crop\[3\] must be an integer, got True"),
        (5, TypeError, r"crop must be \(x, y, width, height\), got 5"),
        ("0 0 1 1", TypeError, "crop must be"),
    ],
)
def test_bad_crops_are_refused(crop: object, error: type[Exception], message: str):
    for render in (om.render, om.reference.render):
        with pytest.raises(error, match=message):
            render(om.sphere(1.0), size=SIZE, crop=crop)


def test_planes_of_a_crop_are_contiguous_and_of_its_shape():
    image = om.render(om.sphere(1.0), size=SIZE, crop=(3, 5, 11, 2), planes=tuple(PLANES))
    assert_array_equal([getattr(image, name).shape[:2] for name in PLANES], [(2, 11)] * len(PLANES))
