"""Cameras follow the hand: orbits keep the distance, what is panned stays under the pointer, zooms have ends."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import octomarch as om
from octomarch.camera import AnyCamera, axes
from octomarch.viewer.navigation import orbit, pan, span, zoom

ROUNDING = 1e-9
"""Relative to the distance of eye and target: some operations in double."""

EYE, TARGET = (3.0, 2.0, 4.0), (0.5, -0.25, 1.0)
CAMERAS = {
    "perspective": om.Camera(EYE, TARGET),
    "orthographic": om.OrthographicCamera(EYE, TARGET, height=3.0),
    "panoramic": om.PanoramicCamera(EYE, TARGET),
}
ways = st.floats(-1.5, 1.5)


@pytest.fixture(params=CAMERAS)
def camera(request: pytest.FixtureRequest) -> AnyCamera:
    return CAMERAS[request.param]


def distance(camera: AnyCamera) -> float:
    return math.dist(camera.eye, camera.target)


def projected(camera: om.Camera | om.OrthographicCamera, point: np.ndarray) -> np.ndarray:
    """Return where a point is seen, in heights of the picture to the right of and below its middle."""
    right, above, along = axes(camera)
    offset = point - camera.eye
    reach = camera.height if isinstance(camera, om.OrthographicCamera) else span(camera) * (offset @ along)
    if isinstance(camera, om.Camera):
        reach /= distance(camera)
    return np.array([offset @ right, -(offset @ above)]) / reach


@given(right=ways, down=ways)
def test_orbit_keeps_target_distance_and_up(right: float, down: float):
    for camera in CAMERAS.values():
        turned = orbit(camera, right, down)
        fixed = "eye" if isinstance(camera, om.PanoramicCamera) else "target"
        assert getattr(turned, fixed) == getattr(camera, fixed)
        assert turned.up == camera.up
        assert distance(turned) == pytest.approx(distance(camera), rel=ROUNDING)


@given(right=ways)
def test_orbit_to_the_side_keeps_the_height(right: float):
    turned = orbit(CAMERAS["perspective"], right, 0.0)
    assert turned.eye[1] == pytest.approx(EYE[1], abs=ROUNDING)


def test_two_heights_of_drag_are_a_whole_turn(camera: AnyCamera):
    turns = 2.0
    turned = orbit(camera, turns, 0.0)
    for name in ("eye", "target"):
        assert getattr(turned, name) == pytest.approx(getattr(camera, name), abs=1e-8)


def test_orbit_follows_the_hand():
    camera = om.Camera((0, 0, 4), (0, 0, 0))
    front = np.array([0.0, 0.0, 1.0])
    for way in ((0.1, 0.0), (0.0, 0.1), (-0.2, 0.05)):
        seen = projected(orbit(camera, *way), front)
        assert np.sign(seen) == pytest.approx(np.sign(way))


def test_panoramic_views_follow_the_hand():
    camera = om.PanoramicCamera((0, 0, 0), (0, 0, -1))
    left = orbit(camera, 0.25, 0.0)  # a quarter of 180 degrees to the right: one looks to the left
    assert left.target == pytest.approx((-math.sin(math.pi / 4), 0, -math.cos(math.pi / 4)))


def test_orbit_never_goes_over_the_pole():
    for down in (0.7, 5.0, -5.0):
        turned = orbit(om.Camera((0, 0, 4), (0, 0, 0)), 0.3, down)
        elevation = math.degrees(math.asin(turned.eye[1] / 4))
        assert abs(elevation) == pytest.approx(89)
        assert math.copysign(1, elevation) == math.copysign(1, down)


def test_a_view_from_straight_above_may_stay_but_for_turns():
    above = om.Camera((0, 4, 1e-6), (0, 0, 0))
    turned = orbit(above, 0.5, 0.4)
    assert turned.eye[1] == pytest.approx(4)


@given(right=ways, down=ways)
def test_what_is_panned_stays_under_the_pointer(right: float, down: float):
    for kind in ("perspective", "orthographic"):
        camera = CAMERAS[kind]
        seen = projected(pan(camera, right, down), np.array(TARGET))
        assert seen == pytest.approx((right, down), abs=ROUNDING)


def test_pan_keeps_the_view(camera: AnyCamera):
    moved = pan(camera, 0.3, -0.2)
    assert np.subtract(moved.eye, moved.target) == pytest.approx(np.subtract(EYE, TARGET), rel=ROUNDING)
    assert np.array(axes(moved)) == pytest.approx(np.array(axes(camera)))


@given(factor=st.floats(0.2, 5))
def test_zoom_scales_what_is_seen(factor: float):
    for kind in ("perspective", "orthographic"):
        camera = CAMERAS[kind]
        zoomed = zoom(camera, factor)
        assert span(zoomed) == pytest.approx(factor * span(camera), rel=ROUNDING)
        assert zoomed.target == camera.target


def test_zoom_of_a_panorama_goes_ahead():
    camera = CAMERAS["panoramic"]
    zoomed = zoom(camera, 0.25)
    assert distance(zoomed) == pytest.approx(distance(camera))
    assert math.dist(zoomed.eye, camera.eye) == pytest.approx(0.75 * distance(camera))


@given(factor=st.floats(1e-12, 1e12), far=st.floats(1, 1e6))
def test_zoom_has_ends(factor: float, far: float):
    assume(factor != 1)
    for camera in (om.Camera((0, 0, far), (0, 0, 0)), om.OrthographicCamera((0, 0, 9), (0, 0, 0), height=far)):
        found = zoom(camera, factor, 2.0, 100.0)
        size = found.height if isinstance(found, om.OrthographicCamera) else distance(found)
        assert min(2.0, far) * (1 - ROUNDING) <= size <= max(100.0, far) * (1 + ROUNDING)


def test_cameras_keep_what_is_theirs():
    camera = om.Camera(EYE, TARGET, up=(0, 0, 1), fov=70)
    moved = zoom(pan(orbit(camera, 0.1, 0.1), 0.1, 0.1), 0.9)
    assert (moved.fov, moved.up) == (70, (0, 0, 1))
