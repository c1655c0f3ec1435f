"""Cameras: what they refuse, and where a panorama looks."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import unit_roundoff

SHELL = om.sphere(3.0)
"""Seen from its centre, inside out: every ray meets it at 3, at three times its direction."""


def directions(size: tuple[int, int], fov: tuple[float, float], basis: np.ndarray) -> np.ndarray:
    """Return unit vectors through pixel centres by the formula of PanoramicCamera; basis: right, up and along."""
    longitude = np.radians(fov[0]) * ((np.arange(size[0]) + 0.5) / size[0] - 0.5)
    latitude = np.radians(fov[1]) * (0.5 - (np.arange(size[1]) + 0.5) / size[1])
    across, up = np.meshgrid(longitude, latitude)
    return np.stack([np.cos(up) * np.sin(across), np.sin(up), np.cos(up) * np.cos(across)], -1) @ basis


@pytest.mark.parametrize("size", [(64, 32), (33, 17), (1, 1), (7, 70)], ids=str)
@pytest.mark.parametrize("fov", [(360, 180), (90, 45), (0.001, 180)], ids=str)
def test_a_panorama_looks_where_its_formula_says(size: tuple[int, int], fov: tuple, isa: str, precision: str):
    eye, target, up = (1.0, 2.0, 3.0), (1.0, 2.0, 7.0), (0.0, 5.0, 1.0)
    basis = np.array([[-1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    camera = om.PanoramicCamera(eye, target, up, fov)
    image = om.render(~SHELL.translate(eye), camera, size, planes=("position", "depth"), precision=precision, isa=isa)
    tolerance = 64 * unit_roundoff(precision)  # a dozen roundings of coordinates up to 6
    expected = np.array(eye) + 3 * directions(size, fov, basis)
    assert_allclose(image.position, expected, rtol=0, atol=tolerance)
    assert_allclose(image.depth, 3, rtol=0, atol=tolerance)


def test_a_panorama_has_the_target_in_the_middle_right_to_the_right_and_up_above(isa: str):
    balls = om.union(*(om.sphere(0.5, center=c) for c in ((0, 0, -3), (3, 0, 0), (0, 3, 0), (-3, 0, 0), (0, -3, 0))))
    camera = om.PanoramicCamera((0, 0, 0), (0, 0, -1))
    seen = om.render(balls, camera, (80, 40), planes="object_id", isa=isa).object_id
    ahead, right, above, left, below = 0, 1, 2, 3, 4
    assert (seen[19:21, 39:41] == ahead).all()
    assert (seen[19:21, 59:61] == right).all()
    assert (seen[19:21, 19:21] == left).all()
    assert (seen[0] == above).all()
    assert (seen[-1] == below).all()


def test_a_panorama_agrees_with_the_reference(isa: str, precision: str):
    shape = (om.sphere(1.0, center=(0, 0, -3)) - om.box(1.5).translate(0.5, 0.5, -2)) | om.plane(point=(0, -1, 0))
    camera = om.PanoramicCamera((0.25, 0.5, 0), (1, 0, -1), up=(0.1, 1, 0), fov=(270, 120))
    march, planes = om.March(max_distance=50), ("color", "depth", "status")
    image = om.render(shape, camera, (48, 24), march=march, planes=planes, precision=precision, isa=isa)
    truth = om.reference.render(shape, camera, (48, 24), march=march, planes=planes)
    same = (image.status == truth.status) & (truth.status == om.Status.HIT)
    assert same.mean() > 0.4
    assert np.mean(image.status == truth.status) > 0.99  # a ray along a rim may fall either way
    assert np.quantile(np.abs(image.depth[same] - truth.depth[same]), 0.99) < 1e-3
    assert np.quantile(np.abs(image.color[same] - truth.color[same]), 0.95) < 1e-3


def test_the_footprint_of_a_panorama_is_half_the_angle_of_a_row(isa: str):
    """A ray along a plane ends where the tolerance, which grows with its pixel, has reached the plane's height."""
    height, rows, tolerance = 0.01, 18, 0.5
    camera = om.PanoramicCamera((0, height, 0), (1, height, 0), fov=(10, 20))
    march = om.March("plain", epsilon=0, pixel_tolerance=tolerance, max_distance=1e3, finish=None)
    settings = {"march": march, "planes": ("position", "depth", "status")}
    image = om.render(om.plane(), camera, (1, rows), isa=isa, **settings)
    pixel = np.radians(20) / rows / 2
    hit = image.status == om.Status.HIT
    assert hit.sum() == rows // 2
    assert (image.position[..., 1][hit] <= tolerance * pixel * image.depth[hit] * (1 + 1e-5)).all()
    assert image.position[..., 1][hit].max() > 0.4 * tolerance * pixel * image.depth[hit].max()
    truth = om.reference.render(om.plane(), camera, (1, rows), **settings)
    assert_array_equal(image.status, truth.status)
    assert_allclose(image.depth, truth.depth, rtol=1e-4)


def test_a_panorama_lights_a_shape_alone_and_says_what_it_is():
    image = om.render(om.sphere(1.0), om.PanoramicCamera((0, 0, 3), (0, 0, 0), fov=(90, 45)), (32, 16))
    assert image.color.max() > 0.3
    assert image.metadata["camera"] == {
        "type": "PanoramicCamera",
        "eye": (0, 0, 3),
        "target": (0, 0, 0),
        "up": (0, 1, 0),
        "fov": (90, 45),
    }


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"fov": 360}, TypeError, r"fov must be \(horizontal, vertical\) degrees, got 360"),
        ({"fov": (360,)}, ValueError, r"fov must be \(horizontal, vertical\) degrees, got \(360,\)"),
        ({"fov": (361, 180)}, ValueError, r"fov\[0\] must lie inside \(0, 360\] degrees, got 361"),
        ({"fov": (360, 180.5)}, ValueError, r"fov\[1\] must lie inside \(0, 180\] degrees, got 180.5"),
        ({"fov": (0, 180)}, ValueError, r"fov\[0\] must lie inside"),
        ({"fov": (90, np.nan)}, ValueError, r"fov\[1\] must be finite"),
        ({"fov": (90, "wide")}, TypeError, r"fov\[1\] must be a number"),
        ({"target": (0, 0, 3)}, ValueError, "target must differ from eye"),
        ({"up": (0, 0, 2)}, ValueError, "up must not be parallel"),
        ({"eye": (0, 0, np.inf)}, ValueError, "eye must be finite"),
    ],
)
def test_bad_panoramas_are_refused(arguments: dict, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.PanoramicCamera(**{"eye": (0, 0, 3), "target": (0, 0, 0), **arguments})
