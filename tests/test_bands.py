"""Pictures that go band by band into their file are those that go there at once, and go on where they ended."""

import signal
import subprocess
import sys
import threading
import time
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

import octomarch as om
from octomarch import _exr_chunks, bands
from octomarch.planes import PLANES

SCENE = om.Scene(
    om.sphere(1.0).paint(om.Material((0.8, 0.2, 0.1))).union(om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25)
    | om.plane(point=(0, -1, 0)),
    lights=[om.DirectionalLight((-1, -2, -1))],
)
CAMERA, SIZE = om.Camera((3, 2, 4), (0, 0, 0)), (90, 100)


@pytest.fixture(autouse=True)
def small_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seven bands, the last of four rows."""
    monkeypatch.setattr(bands, "_PIXELS", 90 * 20)


@pytest.fixture
def rendered(monkeypatch: pytest.MonkeyPatch) -> list[om.Shot]:
    """List of the shots that were rendered, not only found."""
    shots: list[om.Shot] = []
    render = om.Shot.render

    def noted(self: om.Shot, **options: Any) -> om.Image:
        shots.append(self)
        return render(self, **options)

    monkeypatch.setattr(om.Shot, "render", noted)
    return shots


def check_same(path: Path, image: om.Image) -> None:
    found = om.read_exr(path)
    assert found.planes == image.planes
    for plane in image.planes:
        assert getattr(found, plane).tobytes() == getattr(image, plane).tobytes(), plane


@pytest.mark.parametrize(
    "options",
    [
        {"planes": tuple(PLANES)},
        {"planes": "depth", "precision": "float64"},
        {"samples": 3, "march": om.March(max_steps=50), "shading": om.Shading(shadows="hard")},
        {"crop": (7, 5, 50, 43), "planes": ("color", "normal")},
        {"crop": (7, 5, 1, 1)},
    ],
    ids=str,
)
def test_files_are_those_of_render(options: dict[str, Any], tmp_path: Path):
    path = om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", **options)
    image = om.render(SCENE, CAMERA, SIZE, **options)
    image.save(tmp_path / "b.exr")
    check_same(path, om.read_exr(tmp_path / "b.exr"))
    once, again = om.read_exr(tmp_path / "b.exr"), om.read_exr(path)
    assert {key: value for key, value in again.metadata.items() if key != "digest"} == once.metadata
    for name in ("rays", "isa", "precision"):
        assert again.stats[name] == once.stats[name], name
    for name in ("primary", "shadow"):
        assert again.stats["stages"][name]["evaluations"] == once.stats["stages"][name]["evaluations"], name
    assert again.stats.keys() == once.stats.keys()
    assert {path.name for path in tmp_path.iterdir()} == {"a.exr", "b.exr"}


def test_headers_are_those_of_render(tmp_path: Path):
    OpenEXR = pytest.importorskip("OpenEXR")  # noqa: N806
    headers = []
    for crop in (None, (7, 5, 50, 43)):
        om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", crop=crop)
        om.render(SCENE, CAMERA, SIZE, crop=crop).save(tmp_path / "b.exr")
        for name in ("a", "b"):
            with OpenEXR.File(str(tmp_path / f"{name}.exr"), header_only=True) as file:
                header = {key: value for key, value in file.header().items() if key != "octomarch"}
                headers.append({key: str(value) for key, value in header.items()})
        assert headers[-1] == headers[-2]
        file = OpenEXR.InputFile(str(tmp_path / "a.exr"))
        assert file.isComplete()
        file.close()


def test_shapes_are_framed_and_lit(tmp_path: Path):
    path = om.render_file(om.sphere(1.0), size=SIZE, out=tmp_path / "a.exr")
    check_same(path, om.render(om.sphere(1.0), size=SIZE))
    assert_array_equal(om.Shot.load(path).render().color, om.read_exr(path).color)


def test_executors_render_the_same(tmp_path: Path):
    with ThreadPoolExecutor(2) as pool:
        path = om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", executor=pool, threads=1)
    check_same(path, om.render(SCENE, CAMERA, SIZE))


# Going on ------------------------------------------------------------------------------------------------------------


def test_an_interrupted_picture_goes_on(tmp_path: Path, rendered: list[om.Shot]):
    def stop(done: int, _: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    out = tmp_path / "a.exr"
    with pytest.raises(KeyboardInterrupt):
        om.render_file(SCENE, CAMERA, SIZE, out=out, progress=stop)
    assert not out.exists()
    assert len(rendered) == 3
    om.render_file(SCENE, CAMERA, SIZE, out=out)
    assert len(rendered) == 7
    check_same(out, om.render(SCENE, CAMERA, SIZE))
    om.render_file(SCENE, CAMERA, SIZE, out=out)
    assert len(rendered) == 7
    om.render_file(SCENE, om.Camera((3, 2, 5), (0, 0, 0)), SIZE, out=out)
    assert len(rendered) == 14


def test_bands_of_another_picture_are_rendered_again(tmp_path: Path, rendered: list[om.Shot]):
    def stop(done: int, total: int) -> None:
        if done == total - 1:
            raise KeyboardInterrupt

    for samples in (2, 3):
        with pytest.raises(KeyboardInterrupt):
            om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", samples=samples, progress=stop)
    assert len(rendered) == 12
    om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", samples=3)
    assert len(rendered) == 13
    check_same(tmp_path / "a.exr", om.render(SCENE, CAMERA, SIZE, samples=3))


def test_bands_that_fail_are_told_and_the_others_kept(
    tmp_path: Path, rendered: list[om.Shot], monkeypatch: pytest.MonkeyPatch
):
    save = om.Image.save

    def unreliable(self: om.Image, path: Path) -> None:
        if path.name == "00000032.exr":
            raise OSError("no space left")
        save(self, path)

    monkeypatch.setattr(om.Image, "save", unreliable)
    with pytest.raises(om.FramesError, match=r"1 of 7 .*no space left"):
        om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", retries=1)
    monkeypatch.setattr(om.Image, "save", save)
    rendered.clear()
    om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr")
    assert [shot.crop for shot in rendered] == [(0, 32, 90, 16)]


def test_a_band_that_is_damaged_before_it_is_joined_is_an_error(tmp_path: Path):
    def damage(done: int, total: int) -> None:
        if done == total:
            band = tmp_path / ".a.exr.bands" / "00000016.exr"
            data = bytearray(band.read_bytes())
            data[-9] ^= 1
            band.write_bytes(data)

    with pytest.raises(OSError, match=r"00000016.exr: .*damaged"):
        om.render_file(SCENE, CAMERA, SIZE, out=tmp_path / "a.exr", progress=damage)
    assert not (tmp_path / "a.exr").exists()


SCRIPT = """
import sys, octomarch as om
scene = om.gyroid(0.3, 0.05) & om.sphere(1.0)
om.render_file(scene, om.Camera((0, 0, 4), (0, 0, 0)), (16384, 16384), out=sys.argv[1], samples=4)
"""


def test_ctrl_c_and_kill_leave_whole_bands(tmp_path: Path):
    """Of a picture whose pixels alone are 3 GB."""
    folder = tmp_path / ".a.exr.bands"
    for number in (signal.SIGINT, signal.SIGKILL):
        before = len(list(folder.glob("[0-9]*.exr")))
        command = [sys.executable, "-c", SCRIPT, str(tmp_path / "a.exr")]
        with subprocess.Popen(command, stderr=subprocess.PIPE) as process:
            try:
                while len(list(folder.glob("[0-9]*.exr"))) <= before + 1:
                    assert process.poll() is None, process.stderr and process.stderr.read()
                    time.sleep(0.01)
                process.send_signal(number)
                _, error = process.communicate(timeout=30)
            finally:
                process.kill()
        if number == signal.SIGINT:
            assert b"KeyboardInterrupt" in error
    bands_done = sorted(folder.glob("[0-9]*.exr"))
    assert len(bands_done) >= 4
    for band in bands_done:
        assert om.read_exr(band).size == (16384, 16)


def test_cancelling_ends_a_band(tmp_path: Path):
    work = om.Progress()
    threading.Timer(0.2, work.cancel).start()
    with pytest.raises(om.CancelledError):
        om.render_file(SCENE, CAMERA, (16384, 16384), out=tmp_path / "a.exr", samples=64, progress=work)


# The parts -----------------------------------------------------------------------------------------------------------


@given(first=st.binary(max_size=50), second=st.binary(max_size=300), zeros=st.integers(0, 10_000))
def test_checksums_combine(first: bytes, second: bytes, zeros: int):
    second += bytes(zeros)
    found = _exr_chunks.crc32_of_both(zlib.crc32(first), zlib.crc32(second), len(second))
    assert found == zlib.crc32(first + second)


@given(rows=st.integers(1, 9).map(lambda n: 16 * n), height=st.integers(1, 500), y=st.integers(0, 40))
def test_bands_cover_a_window(rows: int, height: int, y: int):
    parts = list(_exr_chunks.parts_of((3, y, 20, height), rows))
    assert [part[1] for part in parts] == list(range(y, y + height, rows))
    assert sum(part[3] for part in parts) == height


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"out": "a.png"}, ValueError, "out must end in .exr, got 'a.png'"),
        ({"out": 3}, TypeError, "out must be a path, got 3"),
        ({"out": "nowhere/a.exr"}, FileNotFoundError, "there is no directory .*nowhere"),
        ({"scene": 3}, TypeError, "scene must be an om.Shape or om.Scene, got 3"),
        ({"camera": 3}, TypeError, "camera must be"),
        ({"executor": 3}, TypeError, "executor must have a method submit"),
        ({"retries": -1}, ValueError, "retries must lie in"),
        ({"size": (2**20, 2**20)}, ValueError, "size must hold at most"),
        ({"progress": 3}, TypeError, "progress must be"),
    ],
    ids=str,
)
def test_bad_arguments_are_refused(
    options: dict[str, Any], error: type[Exception], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message):
        om.render_file(**{"scene": SCENE, "camera": CAMERA, "size": SIZE, "out": "a.exr", **options})
    assert list(tmp_path.iterdir()) == []
