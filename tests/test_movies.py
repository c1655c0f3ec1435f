"""Movies hold the pictures that they are made of, in order, as exactly as their format can."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_array_equal

import octomarch as om

iio = pytest.importorskip("imageio.v3")

# imageio leaves its pipes to ffmpeg to the collector of garbage
pytestmark = pytest.mark.filterwarnings(
    "ignore:unclosed file:ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)

CAMERA = om.Camera((0, 0, 4), (0, 0, 0))
IMAGES = [om.render(om.sphere(r), CAMERA, (64, 48)) for r in (0.4, 0.7, 1.0)]
LOSS = {"gif": 12, "webp": 8, "mp4": 8}
"""Levels of 255 by which a picture of few colours may differ in the mean."""


def read(path: Path) -> np.ndarray:
    plugin = "FFMPEG" if path.suffix == ".mp4" else "pillow"
    return np.stack([frame[..., :3] for frame in iio.imiter(path, plugin=plugin)])


@pytest.mark.parametrize("kind", LOSS)
def test_movies_hold_their_pictures(kind: str, tmp_path: Path):
    path = tmp_path / f"grow.{kind}"
    om.write_movie(path, iter(IMAGES), fps=10)
    found = read(path)
    assert found.shape == (3, 48, 64, 3)
    for frame, image in zip(found, IMAGES, strict=True):
        assert np.abs(frame.astype(int) - image.to_srgb()).mean() < LOSS[kind]
    assert list(tmp_path.iterdir()) == [path]


def test_webp_of_the_best_quality_loses_nothing(tmp_path: Path):
    path = tmp_path / "grow.WEBP"
    om.write_movie(path, IMAGES, quality=100)
    assert_array_equal(read(path), [image.to_srgb() for image in IMAGES])


@pytest.mark.parametrize(("kind", "milliseconds"), [("gif", 40), ("webp", 41)])
def test_animations_tell_time_and_go_on_for_ever(kind: str, milliseconds: int, tmp_path: Path):
    path = tmp_path / f"grow.{kind}"
    om.write_movie(path, IMAGES)
    with PIL.Image.open(path) as movie:
        assert (movie.n_frames, movie.info["loop"]) == (3, 0)
        movie.seek(1)
        movie.load()
        assert movie.info["duration"] in (milliseconds, milliseconds + 1)


def test_videos_tell_time(tmp_path: Path):
    om.write_movie(tmp_path / "a.mp4", IMAGES * 4, fps=12)
    about = iio.immeta(tmp_path / "a.mp4", plugin="FFMPEG")
    assert (about["fps"], about["duration"], about["codec"]) == (12, 1.0, "h264")


def test_videos_of_odd_sizes_repeat_the_last_row_and_column(tmp_path: Path):
    om.write_movie(tmp_path / "odd.mp4", [np.full((47, 33, 3), level, np.uint8) for level in (10, 200)])
    assert read(tmp_path / "odd.mp4").shape == (2, 48, 34, 3)


def test_files_and_arrays_are_pictures_too(tmp_path: Path):
    paths = [tmp_path / "a.exr", tmp_path / "b.png"]
    for path, image in zip(paths, IMAGES, strict=False):
        image.save(path)
    om.write_movie(tmp_path / "a.webp", [*paths, IMAGES[2].to_srgb(), IMAGES[2].color], quality=100)
    expected = [image.to_srgb() for image in (*IMAGES, IMAGES[2])]
    # the third and the fourth are the same, and stand in the file once
    assert_array_equal(read(tmp_path / "a.webp"), expected[: len(read(tmp_path / "a.webp"))])


@pytest.mark.parametrize("quality", [1, 100])
@pytest.mark.parametrize("kind", ["webp", "mp4"])
def test_any_quality_will_do(kind: str, quality: int, tmp_path: Path):
    om.write_movie(tmp_path / f"a.{kind}", IMAGES, quality=quality)
    assert len(read(tmp_path / f"a.{kind}")) == 3


def pictures_that_fail():
    yield IMAGES[0]
    raise RuntimeError("no more")


@pytest.mark.parametrize(
    ("arguments", "options", "error", "message"),
    [
        (("a.avi", IMAGES), {}, ValueError, "path must end in .gif, .webp or .mp4, got 'a.avi'"),
        (("a.gif", []), {}, ValueError, "pictures must hold at least one, got none"),
        (("a.gif", 3), {}, TypeError, "pictures must be several pictures, got 3"),
        (("a.gif", "b.png"), {}, TypeError, "pictures must be several pictures, got 'b.png'"),
        (("a.gif", IMAGES[0].color), {}, TypeError, "pictures must be several pictures"),
        (("a.gif", [IMAGES[0], 3]), {}, TypeError, r"pictures\[1\] must be a path or an array, got 3"),
        (("a.gif", [np.zeros((2, 2, 4))]), {}, ValueError, r"pictures\[0\] must have shape"),
        (("a.gif", [IMAGES[0], np.zeros((2, 3, 3))]), {}, ValueError, r"pictures\[1\] .*got 64×48 and 3×2"),
        (("a.mp4", [IMAGES[0], np.zeros((2, 3, 3))]), {}, ValueError, r"pictures\[1\] .*got 64×48 and 3×2"),
        (("a.mp4", []), {}, ValueError, "pictures must hold at least one"),
        (("a.mp4", pictures_that_fail()), {}, RuntimeError, "no more"),
        (("a.gif", ["nowhere.png"]), {}, FileNotFoundError, "nowhere.png"),
        (("a.gif", IMAGES, 0), {}, ValueError, "fps must be > 0, got 0"),
        (("a.gif", IMAGES), {"quality": 101}, ValueError, r"quality must lie in \[1, 100\], got 101"),
    ],
    ids=str,
)
def test_bad_arguments_are_refused(
    arguments: Any, options: Any, error: type[Exception], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message):
        om.write_movie(*arguments, **options)
    assert list(tmp_path.iterdir()) == []


def test_without_imageio_it_is_told_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "imageio", None)
    with pytest.raises(ImportError, match=r'movies need imageio: pip install "octomarch\[movie\]"'):
        om.write_movie(tmp_path / "a.gif", IMAGES)
