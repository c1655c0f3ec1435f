"""Images check what they hold, say how to get what they lack, and show linear colours as sRGB."""

import io
import pickle
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_array_equal

import octomarch as om


def srgb(linear: np.ndarray) -> np.ndarray:
    """Return the 8-bit code of IEC 61966-2-1 by its formula, in double precision."""
    linear = np.clip(linear, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.floor(encoded * 255 + 0.5).astype(np.uint8)


def colors(values: np.ndarray) -> om.Image:
    return om.Image({"color": np.repeat(np.atleast_2d(values)[..., None], 3, axis=-1)})


def test_srgb_follows_the_formula():
    # Beside the steps themselves, where single precision may fall on either side.
    linear = np.linspace(-0.1, 1.1, 100_003, dtype=np.float32)
    codes = colors(linear).to_srgb()[0, :, 0]
    difference = codes.astype(int) - srgb(linear.astype(np.float64))
    assert np.count_nonzero(difference) <= 3
    assert np.abs(difference).max() <= 1


def test_srgb_of_every_code_is_the_code():
    code = np.arange(256)
    linear = np.where(code <= 10, code / 255 / 12.92, ((code / 255 + 0.055) / 1.055) ** 2.4)
    assert_array_equal(colors(linear).to_srgb()[0, :, 0], code)


def test_srgb_of_extremes():
    codes = colors(np.array([-np.inf, -1, np.nan, 0, 1, 1e30, np.inf])).to_srgb()[0, :, 0]
    assert codes.tolist() == [0, 0, 0, 0, 255, 255, 255]


def test_png_holds_the_srgb_values(tmp_path: Path):
    image = om.Image({"color": np.random.default_rng(1).random((5, 7, 3))})
    image.save(tmp_path / "a.PNG")
    with PIL.Image.open(tmp_path / "a.PNG") as png:
        assert png.mode == "RGB"
        assert png.info["srgb"] == 0
        assert_array_equal(np.asarray(png), image.to_srgb())
    assert image._repr_png_() == image.to_png_bytes() == (tmp_path / "a.PNG").read_bytes()


def test_png_row_zero_is_at_the_top():
    top = np.zeros((2, 1, 3))
    top[0] = 1
    with PIL.Image.open(io.BytesIO(om.Image({"color": top}).to_png_bytes())) as png:
        assert png.getpixel((0, 0)) == (255, 255, 255)
        assert png.getpixel((0, 1)) == (0, 0, 0)


def test_missing_plane_says_how_to_ask():
    image = om.Image({"depth": np.ones((2, 3))})
    with pytest.raises(AttributeError, match="color was not rendered: add 'color' to planes"):
        image.color  # noqa: B018
    with pytest.raises(AttributeError, match="color was not rendered"):
        image.save("depth.png")
    with pytest.raises(AttributeError, match="Image has no attribute 'colour'"):
        image.colour  # noqa: B018
    assert om.Image({"object_id": np.ones((2, 3), int)})._repr_png_() is None
    assert repr(image) == "<Image 3×2: depth>"


@pytest.mark.parametrize(
    ("planes", "error", "message"),
    [
        ({}, ValueError, "planes must name at least one plane"),
        ({"colour": np.ones((2, 2, 3))}, ValueError, "planes must be one of 'color', .*got 'colour'"),
        ({"color": np.ones((2, 2))}, ValueError, r"color must have shape \(height, width, 3\), got \(2, 2\)"),
        ({"color": np.ones((2, 2, 4))}, ValueError, r"got \(2, 2, 4\)"),
        ({"depth": np.ones((2, 2, 3))}, ValueError, r"depth must have shape \(height, width\)"),
        ({"depth": np.ones((0, 2))}, ValueError, r"depth must have shape .*got \(0, 2\)"),
        ({"depth": np.ones((2, 2), complex)}, TypeError, "depth must hold float numbers, got dtype complex128"),
        ({"depth": np.ones((2, 2), object)}, TypeError, "depth must hold float numbers, got dtype object"),
        ({"steps": np.ones((2, 2))}, TypeError, "steps must hold int32 numbers, got dtype float64"),
        ({"status": np.full((2, 2), 300)}, ValueError, r"status must lie in \[0, 255\]"),
        ({"object_id": np.full((2, 2), -2)}, ValueError, r"object_id must lie in \[-1, 2147483647\], got -2"),
        ({"depth": np.ones((2, 2)), "steps": np.ones((2, 3), int)}, ValueError, "planes must have one"),
    ],
)
def test_bad_planes_are_refused(planes: dict, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.Image(planes)


@pytest.mark.parametrize("path", ["picture.jpg", "picture", ".exr"])
def test_unknown_suffix_is_refused(path: str):
    with pytest.raises(ValueError, match=r"path must end in \.exr or \.png, got"):
        om.Image({"depth": np.ones((2, 2))}).save(path)


def test_rendered_images_can_be_pickled():
    image = om.render(om.sphere(1.0), size=(8, 6), planes=("depth",))
    copy = pickle.loads(pickle.dumps(image))
    np.testing.assert_array_equal(copy.depth, image.depth)
    assert copy.metadata == image.metadata
