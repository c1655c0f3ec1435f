"""How planes look: the same everywhere, and legends say what the colours mean."""

import io

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from octomarch.looks import SHOWN, default_plane, legend, look

SHAPE, CAMERA, SIZE = om.sphere(1.0) | om.box(1.5), om.Camera((0, 0, 4), (0, 0, 0)), (40, 30)
IMAGE = om.render(SHAPE, CAMERA, SIZE, planes=("color", "depth", "normal", "steps", "status"))
HIT = IMAGE.status == om.Status.HIT
NOTHING = (0x3A, 0x3F, 0x4A)


@pytest.mark.parametrize("plane", [plane for plane in SHOWN if plane != "error"])
def test_looks_are_bytes_of_srgb(plane):
    shown = look(IMAGE, plane)
    assert (shown.shape, shown.dtype) == ((30, 40, 3), np.uint8)
    if plane in ("depth", "normal", "status"):
        assert (shown[~HIT] == NOTHING).all()
        assert (shown[HIT] != NOTHING).any(axis=-1).all()


def test_colors_look_as_in_files():
    assert_array_equal(look(IMAGE, "color"), IMAGE.to_srgb())


def test_normals_look_as_in_normal_maps():
    shown = look(IMAGE, "normal")
    assert_array_equal(shown[15, 20], np.rint(127.5 + 127.5 * IMAGE.normal[15, 20]))


def test_depth_grows_lighter():
    shown = look(IMAGE, "depth").astype(int).sum(axis=-1)
    order = np.argsort(IMAGE.depth[HIT])
    lightness = shown[HIT][order]
    assert lightness[0] < lightness[-1]
    low, high = (float(label) for label in legend(IMAGE, "depth").labels)
    assert low == pytest.approx(IMAGE.depth[HIT].min(), rel=1e-2)
    assert high == pytest.approx(IMAGE.depth[HIT].max(), rel=1e-2)


def test_pictures_without_a_surface_look_like_nothing():
    empty = om.render(SHAPE, om.Camera((0, 0, 4), (0, 0, 9)), SIZE, planes=("depth", "steps", "normal"))
    assert (look(empty, "depth") == NOTHING).all()
    assert (look(empty, "normal") == NOTHING).all()
    assert legend(empty, "depth").labels == ("0", "0")
    look(empty, "steps")


def test_errors_grow_lighter_and_wrong_rays_stand_out():
    errors = np.array([[1e-7, 1e-5, 1e-3, 1.0, 0.0, np.inf, np.nan]])
    image = om.Image({"depth": np.ones((1, 7))})
    shown = look(image, "error", errors, extent=1.0)[0].astype(int)
    assert (np.diff(shown[:4].sum(axis=-1)) > 0).all()
    assert_array_equal(shown[4], look(image, "error", np.full((1, 7), 1e-9))[0, 0])
    assert tuple(shown[6]) == NOTHING
    assert legend(image, "error").colors[-1] == "#" + bytes(shown[5].tolist()).hex()


def test_legends_name_each_status():
    found = legend(IMAGE, "status")
    assert not found.is_ramp
    assert found.labels == ("hit", "miss", "step limit", "inside", "invalid")
    assert len(set(found.colors)) == 5
    assert found.colors[1] == "#" + bytes(NOTHING).hex()


@pytest.mark.parametrize("plane", ["depth", "steps", "status", "normal"])
def test_images_without_colours_show_what_they_have(plane):
    image = om.Image({plane: getattr(IMAGE, plane)})
    assert default_plane(image) == plane
    shown = np.asarray(PIL.Image.open(io.BytesIO(image._repr_png_())))
    assert_array_equal(shown, look(image, plane))


def test_scenes_show_themselves():
    scene = om.Scene(SHAPE, ambient=0.3, lights=[om.DirectionalLight((-1, -1, -1))])
    shown = np.asarray(PIL.Image.open(io.BytesIO(scene._repr_png_())))
    assert_array_equal(shown, om.render(scene, size=(480, 360)).to_srgb())
