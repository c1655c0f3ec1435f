"""The planes of a picture: what the march counts, where cameras look, what pixels without a surface hold."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from octomarch.planes import PLANES
from rounding import unit_roundoff
from strategies import Sample, nested

BALL = om.sphere(1.0)
FLOOR = om.plane(point=(0, -1, 0))
CAMERA = om.Camera((0, 1, 5), (0, 0, 0))
SUN = om.DirectionalLight((-1, -2, -1))
SIZE = (50, 38)
ALL = tuple(PLANES)

# Counts --------------------------------------------------------------------------------------------------------------


def test_counts_of_the_march_are_those_of_its_rays(isa: str):
    march = om.March("enhanced", finish=None)
    image = om.render(BALL, CAMERA, SIZE, planes="steps", march=march, isa=isa)
    assert image.stats["stages"]["primary"]["evaluations"] == image.steps.sum()
    blocks = -(-SIZE[0] // 8) * -(-SIZE[1] // 8)
    assert image.stats["packets"] == 8 * blocks
    assert 0 < image.stats["occupancy"] <= 1
    assert image.steps.min() >= 1
    finished = om.render(BALL, CAMERA, SIZE, planes=("steps", "status"), march=om.March("enhanced"), isa=isa)
    assert_array_equal(finished.steps, image.steps)
    more = finished.stats["stages"]["primary"]["evaluations"] - image.steps.sum()
    assert 0 < more <= (finished.status == om.Status.HIT).sum()


# Cameras -------------------------------------------------------------------------------------------------------------


def centre(mask: np.ndarray) -> tuple[float, float]:
    """Return the mean (column, row) of the pixels of a mask, from the middle of the picture."""
    rows, columns = np.nonzero(mask)
    return columns.mean() - (mask.shape[1] - 1) / 2, rows.mean() - (mask.shape[0] - 1) / 2


@pytest.mark.parametrize("kind", [om.Camera, om.OrthographicCamera])
def test_pictures_are_upright_and_right_handed(kind: type, isa: str):
    size = {"height": 4.0} if kind is om.OrthographicCamera else {}
    balls = om.union(*(om.sphere(0.25, center=c) for c in ((1, 0, 0), (0, 1, 0), (0, 0, 1))))
    front, left, above = (
        om.render(balls, kind(eye, (0, 0, 0), up, **size), (64, 64), planes="object_id", isa=isa).object_id
        for eye, up in (((0, 0, 6), (0, 1, 0)), ((-6, 0, 0), (0, 2, 0)), ((0, 6, 0), (0, 0, -1)))
    )
    x, y, z = 0, 1, 2

    def direction(mask) -> tuple[int, int]:
        return tuple(np.sign(np.round(np.array(centre(mask)) / 4)).astype(int).tolist())

    assert (direction(front == x), direction(front == y), direction(front == z)) == ((1, 0), (0, -1), (0, 0))
    assert (direction(left == x), direction(left == y), direction(left == z)) == ((0, 0), (0, -1), (1, 0))
    assert (direction(above == x), direction(above == y), direction(above == z)) == ((1, 0), (0, 0), (0, 1))


@pytest.mark.parametrize("size", [(60, 60), (80, 44), (45, 81)], ids=str)
def test_a_ball_in_the_middle_has_a_centred_silhouette(size: tuple[int, int], isa: str):
    fov = 40.0
    image = om.render(BALL, om.Camera((3, 0, 4), (0, 0, 0), fov=fov), size, planes="status", isa=isa)
    seen = image.status == om.Status.HIT
    assert np.mean(seen != seen[::-1]) < 0.005  # a pixel whose centre lies on the rim may fall either way
    assert np.mean(seen != seen[:, ::-1]) < 0.005
    radius = np.tan(np.arcsin(1 / 5)) / np.tan(np.radians(fov / 2)) * size[1] / 2
    assert seen.sum() == pytest.approx(np.pi * radius**2, rel=0.03)


def test_rays_run_through_pixel_centres(isa: str, precision: str):
    """Positions on a floor seen from straight above, by the formulas of Camera."""
    camera = om.Camera((0, 3, 0), (0, 0, 0), up=(0, 0, -1), fov=60)
    width, height = 22, 14
    image = om.render(FLOOR, camera, (width, height), planes=("position", "depth"), precision=precision, isa=isa)
    half = 4 * np.tan(np.radians(30))
    x = (2 * (np.arange(width) + 0.5) / width - 1) * width / height * half
    z = (2 * (np.arange(height) + 0.5) / height - 1) * half
    expected = np.stack([*np.meshgrid(x, z)], -1)
    tolerance = 64 * unit_roundoff(precision)  # a dozen roundings of coordinates up to 5
    assert_allclose(image.position[..., [0, 2]], expected, rtol=0, atol=tolerance)
    assert_allclose(image.position[..., 1], -1, rtol=0, atol=tolerance)
    assert_allclose(image.depth, np.sqrt((expected**2).sum(-1) + 16), rtol=tolerance)


def test_orthographic_depth_of_a_plane_is_exact(isa: str, precision: str):
    camera = om.OrthographicCamera((1, 3, 2), (1, 0, 2), up=(0, 0, -1), height=4)
    image = om.render(FLOOR, camera, (40, 20), planes=ALL, precision=precision, isa=isa)
    assert_array_equal(image.depth, 4)
    assert_array_equal(image.position[..., 1], -1)
    assert_array_equal(image.normal, np.broadcast_to([0, 1, 0], (20, 40, 3)))
    x = 1 + (np.arange(40) + 0.5) / 40 * 8 - 4
    assert_allclose(image.position[..., 0], np.broadcast_to(x, (20, 40)), atol=64 * unit_roundoff(precision))


# Pixels without a surface ---------------------------------------------------------------------------------------------


def check_unmet(image: om.Image) -> None:
    """Nothing is NaN; pixels that met no surface hold what the documentation says."""
    for name in ALL:
        assert not np.isnan(getattr(image, name).astype(np.float64)).any(), name
    status = image.status
    surface = np.isin(status, [om.Status.HIT, om.Status.STEP_LIMIT])
    assert_array_equal(np.isposinf(image.depth), np.isin(status, [om.Status.MISS, om.Status.INVALID]))
    assert_array_equal(image.depth[status == om.Status.INSIDE], 0)
    for name in ("position", "normal"):
        assert_array_equal(getattr(image, name)[~surface], 0)
    for name in ("object_id", "material_id"):
        assert_array_equal(getattr(image, name) == -1, ~surface)
    assert_array_equal(image.color[np.isin(status, [om.Status.INSIDE, om.Status.INVALID])], 0)
    assert (image.color >= 0).all()
    lengths = np.linalg.norm(image.normal[surface].astype(np.float64), axis=-1)
    assert_allclose(lengths, 1, atol=1e-6)


@settings(max_examples=25)
@given(sample=nested())
def test_no_picture_has_a_nan(isa: str, precision: str, sample: Sample):
    scene = om.Scene(sample.shape, ambient=0.25, lights=[SUN, om.PointLight((3, 3, 3), 5)])
    march = om.March(max_steps=30)
    for camera in (CAMERA, om.OrthographicCamera((0, 0.5, 2), (0, 0, 0), height=3)):
        check_unmet(om.render(scene, camera, (13, 9), march=march, planes=ALL, precision=precision, isa=isa))


def test_every_pixel_of_any_size_is_written(isa: str):
    march = om.March("enhanced", pixel_tolerance=0)
    for size in itertools.product((1, 3, 4, 5, 64, 65), (1, 2, 3, 63)):
        image = om.render(BALL | FLOOR, CAMERA, size, planes=ALL, march=march, isa=isa)
        check_unmet(image)
        assert (image.steps[image.status == om.Status.HIT] > 0).all()
        assert (image.color > 0).any(axis=-1).all()


def test_misses_beside_hits_are_clean_along_the_silhouette(isa: str, precision: str):
    """Packets that hold both: what was not met must not be shaded as if it were."""
    scene = om.Scene(BALL, ambient=1.0, sky=om.Sky(toward=0, away=0, base=(0, 0, 0.5)), lights=[SUN])
    image = om.render(scene, CAMERA, (64, 48), planes=ALL, precision=precision, isa=isa)
    check_unmet(image)
    missed = image.status == om.Status.MISS
    assert 0.2 < missed.mean() < 0.9
    assert_array_equal(image.color[missed], np.broadcast_to([0, 0, 0.5], (missed.sum(), 3)))


def test_a_camera_in_a_solid_sees_nothing(isa: str):
    image = om.render(~om.sphere(0.5), om.Camera((0, 0, 2), (0, 0, 0)), (9, 9), planes=ALL, isa=isa)
    assert_array_equal(image.status, om.Status.INSIDE)
    check_unmet(image)
