"""``octomarch animate``: turntables and scripts, as files and movies."""

import re
from pathlib import Path

import pytest

import octomarch as om
from octomarch.cli import main

SCRIPT = """
import octomarch as om

ball = om.sphere(1.0)
frames = [ball, om.Scene(ball), om.Shot(om.Scene(ball), om.Camera((0, 0, 5), (0, 0, 0)))]
nothing = []
number = 5


def growing(t):
    return om.sphere(0.5 + t)


def largest():
    return growing(0.75)


def listed(count=3):
    return (om.sphere(0.5 + i) for i in range(count))


def failing():
    yield om.sphere(1.0)
    yield om.sphere(1.0 / 0)


def late(t):
    return om.sphere(0.5 - t)
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "scene.py").write_text(SCRIPT)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def animate(scene: str, out: str, *options: str) -> int:
    return main(["animate", scene, "-o", out, "--size", "32x24", "-q", *options])


def radius(path: Path) -> float:
    shape = om.load(path).shape
    return shape.bounds()[1][0]


def test_functions_get_the_time(folder: Path):
    assert animate("scene.py:growing", "f_{:02d}.exr", "--frames", "4") == 0
    assert [radius(folder / f"f_{i:02d}.exr") for i in range(4)] == [0.5, 0.75, 1.0, 1.25]


def test_iterables_give_frames(folder: Path):
    assert animate("scene.py:listed", "f_{}.png") == 0
    assert [radius(folder / f"f_{i}.png") for i in range(3)] == [0.5, 1.5, 2.5]
    assert animate("scene.py", "g_{}.png", "--set", "march.max_steps=32") == 0
    shots = [om.Shot.load(folder / f"g_{i}.png") for i in range(3)]
    assert [shot.march.max_steps for shot in shots] == [32, 32, 32]
    assert shots[2].camera == om.Camera((0, 0, 5), (0, 0, 0))
    assert shots[0].camera == shots[1].camera
    assert len(shots[0].scene.lights) == 1, "a shape alone is lit"


def test_frames_share_a_camera_that_sees_all_of_them(folder: Path):
    assert animate("scene.py:growing", "f_{}.png", "--frames", "4") == 0
    cameras = {om.Shot.load(folder / f"f_{i}.png").camera for i in range(4)}
    assert cameras == {om.Shot.load(folder / "f_3.png").camera}
    assert main(["render", "scene.py:largest", "-o", "g.png", "--size", "32x24", "-q"]) == 0
    assert cameras == {om.Shot.load(folder / "g.png").camera}


def test_what_does_not_move_is_turned(folder: Path):
    assert animate("scene.py:ball", "f_{}.exr", "--frames", "4", "--degrees", "180") == 0
    cameras = [om.Shot.load(folder / f"f_{i}.exr").camera for i in range(4)]
    assert cameras == om.turntable(om.sphere(1.0), 4, camera=cameras[0], degrees=180)


def test_frames_that_are_there_stay(folder: Path):
    assert animate("scene.py:growing", "f_{}.png", "--frames", "2") == 0
    before = (folder / "f_0.png").stat().st_mtime_ns
    (folder / "f_1.png").unlink()
    assert animate("scene.py:growing", "f_{}.png", "--frames", "2") == 0
    assert (folder / "f_0.png").stat().st_mtime_ns == before
    assert (folder / "f_1.png").exists()


@pytest.mark.parametrize("suffix", ["gif", "webp", "mp4"])
def test_movies_keep_frames_that_are_asked_for(folder: Path, suffix: str):
    iio = pytest.importorskip("imageio.v3")
    assert animate("scene.py:growing", f"m.{suffix}", "--frames", "5", "--fps", "10") == 0
    if suffix != "mp4":  # to read one leaves imageio's pipes open
        assert len(iio.imread(folder / f"m.{suffix}", index=...)) == 5
    assert sorted(path.name for path in folder.iterdir()) == [f"m.{suffix}", "scene.py"]
    assert animate("scene.py:growing", f"m.{suffix}", "--frames", "5", "--keep", "f_{}.exr") == 0
    assert len(list(folder.glob("f_*.exr"))) == 5


def test_interrupted_movies_go_on(folder: Path, monkeypatch: pytest.MonkeyPatch):
    pytest.importorskip("imageio.v3")

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(om, "write_movie", interrupted)
        assert animate("scene.py:growing", "m.gif", "--frames", "3") == 130
    assert len(list((folder / ".m.gif.frames").iterdir())) == 3
    monkeypatch.setattr(om.Shot, "render", interrupted)
    assert animate("scene.py:growing", "m.gif", "--frames", "3") == 0
    assert not (folder / ".m.gif.frames").exists()


def test_frames_that_fail_are_reported_alone(folder: Path, capsys: pytest.CaptureFixture[str]):
    (folder / "f_1.png").mkdir()
    assert animate("scene.py:growing", "f_{}.png", "--frames", "3", "--retries", "0") == 3
    assert "1 of 3 frames failed" in capsys.readouterr().err
    assert (folder / "f_2.png").exists()


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("scene", "out", "options", "message"),
    [
        ("scene.py:nothing", "f_{}.png", (), "scene.py:nothing must hold at least one frame, got none"),
        ("scene.py:number", "f_{}.png", (), "scene.py:number must be a shape, a scene, a shot or several"),
        ("scene.py:failing", "f_{}.png", (), r"scene.py:\d+: ZeroDivisionError: float division by zero"),
        ("scene.py:late", "f_{}.png", (), r"scene.py:\d+: ValueError: radius must be .*, got -"),
        ("scene.py:ball", "f.png", (), "out must have a place for the frame's number"),
        ("scene.py:ball", "f_{}.jpg", (), r"OUT must end in \.gif or \.webp or \.mp4 or \.exr or \.png"),
        ("scene.py:ball", "no/f_{}.png", (), "no directory no"),
        ("scene.py:ball", "f_{}.png", ("--frames", "0"), r"--frames must lie in \[1, "),
        ("scene.py:ball", "f_{}.png", ("--degrees", "nan"), "degrees must be finite"),
        ("scene.py:ball", "f_{}.png", ("--keep", "g_{}.png"), "--keep is for movies"),
        ("scene.py:ball", "f_{}.png", ("--retries", "-1"), "retries must lie in"),
        ("scene.py:ball", "f_{}.png", ("--planes", "depth"), "planes must have 'color' for frames in PNG"),
    ],
)
def test_errors_are_one_line(
    capsys: pytest.CaptureFixture[str], scene: str, out: str, options: tuple[str, ...], message: str
):
    assert animate(scene, out, *options) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert re.search(message, error), error
