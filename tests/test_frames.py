"""Frames: files that hold what `render` gives, each whole, once, and by whatever runs them."""

import pickle
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from octomarch import frames

SIZE = (40, 30)
SHAPE = om.box(1.0).union(om.sphere(0.6).translate(0.4, 0.5, 0), smooth=0.2)
SCENE = om.Scene(SHAPE, lights=[om.DirectionalLight((-1, -2, -1))])
CAMERAS = om.turntable(SHAPE, 5)


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


def check_frames(paths: list[Path], scene: om.Shape | om.Scene = SCENE) -> None:
    for path, camera in zip(paths, CAMERAS, strict=True):
        assert_array_equal(om.read_exr(path).color, om.render(scene, camera, SIZE).color)


class Later:
    """An executor of nobody's kind, whose futures are done when they have been asked a few times."""

    def submit(self, function, /, *args, **kwargs):
        class Answer:
            asked = 0

            def done(self):
                self.asked += 1
                return self.asked > 2

            def result(self):
                return function(*args, **kwargs)

            def cancel(self):
                raise NotImplementedError

        return Answer()


# What is written -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", [SHAPE, SCENE], ids=["shape", "scene"])
def test_frames_hold_the_bits_of_render(scene: om.Shape | om.Scene, tmp_path: Path):
    paths = om.render_frames(scene, CAMERAS, SIZE, out=tmp_path / "frame_{:04d}.exr")
    assert paths == [tmp_path / f"frame_000{i}.exr" for i in range(5)]
    check_frames(paths, scene)
    assert sorted(tmp_path.iterdir()) == paths


def test_settings_are_those_of_render(tmp_path: Path):
    options = {
        "march": om.March(max_steps=40),
        "shading": om.Shading(shadows="hard"),
        "planes": ("color", "steps"),
        "samples": 2,
        "crop": (3, 4, 20, 10),
    }
    [path] = om.render_frames(SCENE, CAMERAS[1], SIZE, out=f"{tmp_path}/{{}}.exr", **options, threads=1)
    assert_array_equal(om.read_exr(path).color, om.render(SCENE, CAMERAS[1], SIZE, **options).color)
    made = om.Shot.load(path)
    assert (made.scene, made.camera, made.march.max_steps, made.crop) == (SCENE, CAMERAS[1], 40, options["crop"])


def test_one_camera_serves_many_scenes_and_none_frames_each(tmp_path: Path):
    scenes = (om.sphere(r) for r in (0.5, 1.0))
    paths = om.render_frames(scenes, size=SIZE, planes="depth", out=f"{tmp_path}/{{}}.exr")
    for path, radius in zip(paths, (0.5, 1.0), strict=True):
        assert_array_equal(om.read_exr(path).depth, om.render(om.sphere(radius), size=SIZE, planes="depth").depth)
    paths = om.render_frames([SCENE, SHAPE], CAMERAS[0], SIZE, out=f"{tmp_path}/b{{}}.exr")
    assert_array_equal(om.read_exr(paths[1]).color, om.render(SHAPE, CAMERAS[0], SIZE).color)


def test_frames_in_png(tmp_path: Path, rendered: list[om.Shot]):
    paths = om.render_frames(SCENE, CAMERAS[:2], SIZE, out=tmp_path / "{:d}.png")
    assert om.Shot.load(paths[1]).camera == CAMERAS[1]
    om.render_frames(SCENE, CAMERAS[:2], SIZE, out=tmp_path / "{:d}.png")
    assert len(rendered) == 2


# Running again -------------------------------------------------------------------------------------------------------


def test_running_again_renders_only_what_is_missing(tmp_path: Path, rendered: list[om.Shot]):
    out = tmp_path / "{}.exr"
    paths = om.render_frames(SCENE, CAMERAS, SIZE, out=out)
    before = [path.stat().st_mtime_ns for path in paths]
    paths[3].unlink()
    rendered.clear()
    assert om.render_frames(SCENE, CAMERAS, SIZE, out=out) == paths
    assert [shot.camera for shot in rendered] == [CAMERAS[3]]
    assert [path.stat().st_mtime_ns == time for path, time in zip(paths, before, strict=True)] == [1, 1, 1, 0, 1]


@pytest.mark.parametrize("suffix", [".exr", ".png"])
def test_torn_and_foreign_files_are_rendered_again(suffix: str, tmp_path: Path, rendered: list[om.Shot]):
    out = f"{tmp_path}/{{}}{suffix}"
    paths = om.render_frames(SCENE, CAMERAS, SIZE, out=out)
    whole = [path.read_bytes() for path in paths]
    paths[0].write_bytes(b"")
    paths[1].write_bytes(whole[1][:-20])
    paths[2].write_bytes(b"something else")
    om.render(SCENE, CAMERAS[3], SIZE).save(paths[3])  # by someone who does not say of what it is
    rendered.clear()
    om.render_frames(SCENE, CAMERAS, SIZE, out=out)
    assert [shot.camera for shot in rendered] == CAMERAS[:4]
    if suffix == ".exr":
        check_frames(paths)


def test_frames_of_another_scene_camera_or_setting_are_rendered_again(tmp_path: Path, rendered: list[om.Shot]):
    out = f"{tmp_path}/{{}}.exr"
    large = om.spheres(np.random.default_rng(0).uniform(-1, 1, (5000, 3)), 0.1)  # not told in the file
    for scene, camera, options in (
        (large, CAMERAS[0], {}),
        (large.translate(0, 0, 1e-9), CAMERAS[0], {}),
        (large, CAMERAS[0], {}),
        (large, CAMERAS[1], {}),
        (large, CAMERAS[1], {"march": om.March(max_steps=99)}),
    ):
        count = len(rendered)
        for _ in range(2):
            om.render_frames(scene, camera, (16, 12), out=out, **options)
            assert len(rendered) == count + 1


def test_leftovers_of_killed_writers_are_removed(tmp_path: Path):
    left = tmp_path / ".1.0123456789ab.tmp.exr"
    others = [tmp_path / ".7.0123456789ab.tmp.exr", tmp_path / ".1.0123456789ab.tmp.png", tmp_path / "1.tmp.exr"]
    for path in (left, *others):
        path.write_bytes(b"half")
    om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr")
    assert not left.exists()
    assert all(path.exists() for path in others)


# Executors -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [lambda: ThreadPoolExecutor(2), Later], ids=["threads", "later"])
def test_executors_render_the_same(kind: Any, tmp_path: Path):
    check_frames(om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr", executor=kind()))


def test_processes_render_the_same(tmp_path: Path):
    calls: list[tuple[int, int]] = []
    with ProcessPoolExecutor(2, mp_context=get_context("forkserver")) as pool:
        paths = om.render_frames(
            SHAPE, CAMERAS, SIZE, out=tmp_path / "{}.exr", executor=pool, progress=lambda *call: calls.append(call)
        )
    check_frames(paths, SHAPE)
    assert calls[-1] == (5, 5)
    assert calls == sorted(calls)


@pytest.mark.parametrize("kind", [lambda: None, lambda: ThreadPoolExecutor(2), Later], ids=["here", "threads", "later"])
def test_a_frame_that_always_fails_is_reported_alone(kind: Any, tmp_path: Path, rendered: list[om.Shot]):
    paths = [tmp_path / f"{i}.exr" for i in range(5)]
    paths[2].mkdir()
    with pytest.raises(om.FramesError, match=r"1 of 5 frames failed.*frame 2 \(2.exr\): IsADirectoryError") as caught:
        om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr", executor=kind(), retries=2)
    assert list(caught.value.failures) == [2]
    assert caught.value.paths == paths
    assert [shot.camera for shot in rendered].count(CAMERAS[2]) == 3
    assert [shot.camera for shot in rendered].count(CAMERAS[3]) == 1
    paths[2].rmdir()
    check_frames(om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr"))


def test_a_frame_that_fails_at_first_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    save, failures = om.Image.save, iter(range(4))

    def unreliable(self: om.Image, path: Path) -> None:
        if path.name == "1.exr" and next(failures, None) is not None:
            raise OSError("the disk is away")
        save(self, path)

    monkeypatch.setattr(om.Image, "save", unreliable)
    out = tmp_path / "{}.exr"
    with pytest.raises(om.FramesError, match="the disk is away"):
        om.render_frames(SCENE, CAMERAS, SIZE, out=out, retries=0)
    check_frames(om.render_frames(SCENE, CAMERAS, SIZE, out=out, retries=3))


def test_a_broken_executor_is_told(tmp_path: Path):
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    with pytest.raises(om.FramesError, match=r"5 of 5 frames failed.*frame 0 .*RuntimeError: .*; and 2 more"):
        om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr", executor=pool)


def test_errors_of_frames_travel():
    error = om.FramesError({1: ValueError("no")}, [Path("a.exr"), Path("b.exr")])
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert again.paths == error.paths


# Ending early --------------------------------------------------------------------------------------------------------


def test_cancelling_ends_the_frame_that_is_being_rendered(tmp_path: Path):
    work = om.Progress()
    threading.Timer(0.1, work.cancel).start()
    with pytest.raises(om.CancelledError):
        om.render_frames(SCENE, CAMERAS, (16000, 16000), out=tmp_path / "{}.exr", progress=work)
    assert (work.done, work.total) == (0, 5)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_what_a_callback_raises_is_no_failure_of_a_frame(error: type[BaseException], tmp_path: Path):
    def stop(done: int, _: int) -> None:
        if done == 2:
            raise error("enough")

    with pytest.raises(error, match="enough"):
        om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr", progress=stop)
    assert len(list(tmp_path.iterdir())) == 2


def test_frames_that_have_not_begun_are_cancelled(tmp_path: Path):
    class Never:
        futures: list[Future[None]] = []  # noqa: RUF012

        def submit(self, *_, **__):
            self.futures.append(Future())
            return self.futures[-1]

    work = om.Progress()
    threading.Timer(0.1, work.cancel).start()
    begin = time.monotonic()
    with pytest.raises(om.CancelledError):
        om.render_frames(SCENE, CAMERAS, SIZE, out=tmp_path / "{}.exr", executor=Never(), progress=work)
    assert time.monotonic() - begin < 5
    assert [future.cancelled() for future in Never.futures] == [True] * 5


def test_a_bar_counts_rays(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    om.render_frames(SCENE, CAMERAS[:3], SIZE, out=tmp_path / "{}.exr", progress=True)
    assert "/3600 [" in capsys.readouterr().err


# Arguments -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"out": "frame.exr"}, ValueError, "out must have a place for the frame's number, .*got 'frame.exr'"),
        ({"out": "{}_{}.exr"}, ValueError, "out must have one place for a number"),
        ({"out": "{name}.exr"}, ValueError, "out must have one place for a number"),
        ({"out": "{:q}.exr"}, ValueError, "out must have one place for a number"),
        ({"out": "{}.gif"}, ValueError, r"out must end in .exr or .png, got '\{\}.gif'"),
        ({"out": 3}, TypeError, "out must be a path, got 3"),
        ({"out": "nowhere/{}.exr"}, FileNotFoundError, "there is no directory .*nowhere"),
        ({"scenes": []}, ValueError, "scenes must hold at least one, got none"),
        ({"scenes": 3}, TypeError, "scenes must be a shape, a scene or several, got 3"),
        ({"scenes": [SHAPE, 3]}, TypeError, r"scenes\[1\] must be an om.Shape or om.Scene, got 3"),
        ({"scenes": [SHAPE] * 3}, ValueError, "cameras must be one, or as many as scenes, 3, got 5"),
        ({"cameras": []}, ValueError, "cameras must hold at least one, got none"),
        (
            {"cameras": [CAMERAS[0], "front"]},
            TypeError,
            r"cameras\[1\] must be a camera such as om.Camera, got 'front'",
        ),
        ({"executor": 4}, TypeError, "executor must have a method submit.*got 4"),
        ({"executor": ThreadPoolExecutor}, TypeError, "executor must have a method submit"),
        ({"retries": -1}, ValueError, "retries must lie in"),
        ({"planes": "depth", "out": "{}.png"}, ValueError, r"planes must have 'color' .*got \('depth',\)"),
        ({"samples": 0}, ValueError, "samples must lie in"),
        ({"threads": 0}, ValueError, "threads must lie in"),
        ({"progress": 3}, TypeError, "progress must be True"),
    ],
    ids=str,
)
def test_bad_arguments_are_refused_before_anything_is_rendered(
    options: dict[str, Any], error: type[Exception], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message):
        om.render_frames(**{"scenes": SCENE, "cameras": CAMERAS, "size": SIZE, **options})
    assert list(tmp_path.iterdir()) == []


# Turntables ----------------------------------------------------------------------------------------------------------


def test_a_turntable_goes_round_the_target():
    first = om.OrthographicCamera((1, 2, 3), (1, 0, 0), up=(0, 0, -2), height=3)
    cameras = om.turntable(SHAPE, 8, camera=first)
    assert cameras[0] == first
    eyes = np.array([camera.eye for camera in cameras])
    assert_allclose(np.linalg.norm(eyes - first.target, axis=1), np.linalg.norm([0, 2, 3]))
    assert_allclose(eyes[:, 2], 3)
    assert_allclose(eyes[4], (1, -2, 3))
    assert {(type(camera), camera.target, camera.up, camera.height) for camera in cameras} == {
        (om.OrthographicCamera, first.target, first.up, first.height)
    }


def test_a_turntable_frames_the_scene():
    eye = om.render(SHAPE, size=SIZE).metadata["camera"]["eye"]
    assert om.turntable(om.Scene(SHAPE), 2)[0].eye == eye
    half = om.turntable(SCENE, 2, degrees=-90)
    assert_allclose(half[1].eye, om.turntable(SCENE, 8)[7].eye)


@pytest.mark.parametrize(
    ("arguments", "options", "error", "message"),
    [
        ((3,), {}, TypeError, "scene must be an om.Shape or om.Scene, got 3"),
        ((SHAPE, 0), {}, ValueError, "frames must lie in"),
        ((SHAPE, 2.0), {}, TypeError, "frames must be an integer"),
        ((SHAPE,), {"camera": 3}, TypeError, "camera must be an om.Camera"),
        ((SHAPE,), {"degrees": np.inf}, ValueError, "degrees must be finite"),
    ],
)
def test_bad_turntables_are_refused(arguments: Any, options: Any, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.turntable(*arguments, **options)


def test_frames_of_large_scenes_are_told_apart_by_a_digest():
    shots = [om.Shot(om.Scene(om.sphere(r))) for r in (1.0, 1.0, 1.5)]
    marks = [frames.digest(shot) for shot in shots]
    assert marks[0] == marks[1] != marks[2]
