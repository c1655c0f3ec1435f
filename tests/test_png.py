"""PNG files hold the bytes of the colours, whole or not at all."""

from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from test_image import srgb


def bytes_of(path: Path) -> np.ndarray:
    with PIL.Image.open(path) as png:
        assert png.info["srgb"] == 0
        return np.asarray(png)


@pytest.mark.parametrize("shape", [(5, 7, 3), (5, 7), (1, 1)], ids=str)
def test_floats_are_linear_and_bytes_are_as_they_are(shape: tuple[int, ...], tmp_path: Path):
    levels = np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)
    om.write_png(tmp_path / "bytes.png", levels)
    assert_array_equal(bytes_of(tmp_path / "bytes.png"), levels)
    linear = np.where(levels <= 10, levels / 255 / 12.92, ((levels / 255 + 0.055) / 1.055) ** 2.4)
    for dtype in (np.float64, np.float32):
        om.write_png(tmp_path / "floats.png", linear.astype(dtype)[:, ::-1])  # not contiguous
        assert_array_equal(bytes_of(tmp_path / "floats.png"), levels[:, ::-1])


def test_extremes_are_clipped(tmp_path: Path):
    om.write_png(tmp_path / "a.png", np.array([[-np.inf, -1, np.nan, 0, 1, 1e300, np.inf]]))
    assert bytes_of(tmp_path / "a.png")[0].tolist() == [0, 0, 0, 0, 255, 255, 255]


def test_files_are_those_of_images(tmp_path: Path):
    color = np.random.default_rng(2).random((3, 4, 3))
    om.write_png(tmp_path / "array.png", color)
    om.Image({"color": color}).save(tmp_path / "image.png")
    assert (tmp_path / "array.png").read_bytes() == (tmp_path / "image.png").read_bytes()
    assert_array_equal(bytes_of(tmp_path / "array.png"), srgb(color))


@pytest.mark.parametrize(
    ("colors", "error", "message"),
    [
        ([[0.5]], TypeError, r"colors must be an array, got \[\[0.5\]\]"),
        (np.ones((2, 2), int), TypeError, r"colors must hold floats \(linear\) or uint8 \(sRGB\), got dtype int64"),
        (np.ones((2, 2, 4)), ValueError, r"colors must have shape .*got \(2, 2, 4\)"),
        (np.ones((0, 2)), ValueError, r"colors must have shape .*got \(0, 2\)"),
        (np.ones(3), ValueError, r"colors must have shape .*got \(3,\)"),
    ],
)
def test_bad_colours_are_refused(colors: object, error: type[Exception], message: str, tmp_path: Path):
    with pytest.raises(error, match=message):
        om.write_png(tmp_path / "a.png", colors)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_told(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match="nowhere"):
        om.write_png(tmp_path / "nowhere" / "a.png", np.ones((2, 2)))
