"""The command line, called as a function, and once as a program."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import trimesh

import octomarch as om
from octomarch.cli import main
from octomarch.demo import DEMOS
from octomarch.planes import PLANES


def test_demo_renders_both_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    folder = tmp_path / "new" / "folder"
    assert main(["demo", "-o", str(folder), "--size", "48x27", "--threads", "1", "--isa", om.isas()[-1]]) == 0
    output = capsys.readouterr().out
    assert sorted(path.name for path in folder.iterdir()) == sorted(f"{n}{s}" for n in DEMOS for s in (".exr", ".png"))
    for name in DEMOS:
        image = om.read_exr(folder / f"{name}.exr")
        assert image.size == (48, 27)
        assert image.planes == tuple(PLANES)
        assert str(folder / f"{name}.png") in output
    assert re.search(rf"48x27, {om.isas()[-1]}, 1 threads?, .* Mrays/s, [\d.]+ evaluations per primary ray", output)


def test_render_counts_all_that_evaluates_the_field(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    mirror = om.box(2.0).paint(om.Material(reflectivity=0.5)) | om.plane(point=(0, -1, 0))
    scene = om.Scene(mirror | om.sphere(0.5, center=(1, 0, 2.5)), lights=[om.DirectionalLight((-1, -2, -1))])
    shot = om.Shot(scene, om.Camera((2, 3, 4), (0, 0, 0)), (48, 36), samples=4, shading=om.Shading(bounces=1))
    shot.save(tmp_path / "shot.json")
    assert main(["render", str(tmp_path / "shot.json"), "-o", str(tmp_path / "shot.png")]) == 0
    output = capsys.readouterr().out
    stats = shot.render().stats
    stages = ("primary", "cones", "shadow", "reflection", "occlusion", "normals")
    counts = {name: stats["stages"][name]["evaluations"] for name in stages}
    assert all(counts.values())
    per_ray = (counts["primary"] + counts["cones"]) / stats["rays"]
    assert f"{per_ray:.1f} evaluations per primary ray" in output
    assert f"{sum(counts.values()) / (48 * 36):.1f} per pixel with shading" in output


def test_info_names_versions_and_instruction_sets(capsys: pytest.CaptureFixture[str]):
    assert main(["info"]) == 0
    output = capsys.readouterr().out
    assert om.__version__ in output
    assert ", ".join(om.isas()) in output
    assert all(value in output for value in om.build_info().values())


@pytest.mark.parametrize("name", DEMOS)
def test_listing_of_a_demo(name: str, capsys: pytest.CaptureFixture[str]):
    assert main(["listing", name]) == 0
    assert capsys.readouterr().out.strip() == str(om.compile(DEMOS[name]().scene)).strip()


def test_listing_of_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "mine.py"
    path.write_text("import octomarch as om\nshape = om.torus(2.0, 0.5)\nother = om.sphere(1.0)\n")
    assert main(["listing", str(path)]) == 0
    assert "torus" in capsys.readouterr().out
    assert main(["listing", f"{path}:other"]) == 0
    assert "sphere" in capsys.readouterr().out
    assert main(["listing", f"{path}:none"]) == 1
    assert "mine.py defines nothing named none" in capsys.readouterr().err


def test_render_takes_files_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    shot = om.Shot(om.Scene(om.sphere(1.0)), om.Camera((0, 0, 4), (0, 0, 0)), (32, 18), planes=("color", "depth"))
    shot.save(tmp_path / "shot.json")
    shot.scene.save(tmp_path / "scene.json")
    (tmp_path / "shot.py").write_text(f"import octomarch as om\nshot = om.Shot.load({str(tmp_path / 'shot.json')!r})\n")

    def rendered(source: str, *options: str) -> om.Image:
        assert main(["render", str(tmp_path / source), "-o", str(tmp_path / "out.exr"), *options]) == 0
        assert re.match(rf"{re.escape(str(tmp_path))}/out\.exr: \d+x\d+, ", capsys.readouterr().out)
        return om.read_exr(tmp_path / "out.exr")

    expected = shot.render()
    for source in ("shot.json", "shot.py", "out.exr"):
        image = rendered(source)
        assert (image.size, image.planes) == ((32, 18), ("color", "depth"))
        assert np.array_equal(image.color, expected.color)
    image = rendered("scene.json", "--size", "16x12", "--samples", "4", "--planes", "all", "--threads", "1")
    assert (image.size, image.planes) == ((16, 12), tuple(PLANES))
    assert image.metadata["render"]["samples"] == 4
    assert main(["listing", str(tmp_path / "out.exr")]) == main(["listing", str(tmp_path / "shot.json")]) == 0
    assert capsys.readouterr().out.count("sphere") == 2


def test_large_renders_go_band_by_band(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    shot = om.Shot(om.Scene(om.sphere(1.0)), om.Camera((0, 0, 4), (0, 0, 0)), (32, 18), planes=("color", "depth"))
    shot.save(tmp_path / "shot.json")
    arguments = ["render", str(tmp_path / "shot.json"), "-o", str(tmp_path / "out.exr"), "--size", "64x36"]
    assert main(arguments) == 0
    at_once, image = capsys.readouterr().out, om.read_exr(tmp_path / "out.exr")
    monkeypatch.setattr("octomarch.cli.render._LARGE", 2000)
    monkeypatch.setattr(om, "render", lambda *_, **__: pytest.fail("at once"))
    assert main(arguments) == 0
    assert capsys.readouterr().out.split(",")[0] == at_once.split(",")[0]
    again = om.read_exr(tmp_path / "out.exr")
    assert "digest" in again.metadata
    assert (again.depth == image.depth).all()


def test_render_of_a_demo_to_png(tmp_path: Path):
    assert main(["render", "blend", "-o", str(tmp_path / "blend.png"), "--size", "48x27"]) == 0
    assert om.Shot.load(tmp_path / "blend.png").size == (48, 27)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["render", "none.json", "-o", "out.png"], r"none\.json"),
        (["render", __file__ + ".json", "-o", "out.png"], r"\.json"),
        (["render", "blend", "-o", "out.gif", "--size", "8x8"], r"OUT must end in \.exr or \.png, got 'out\.gif'"),
        (["render", "blend", "-o", "nowhere/out.png"], "there is no directory nowhere"),
        (["render", "blend", "-o", "out.exr", "--planes", "colour"], r"planes must be one of .*'colour'"),
        (["render", "blend", "-o", "out.exr", "--samples", "0"], r"samples must lie in \[1, 64\], got 0"),
        (["listing", "cathedral"], r"SCENE must be blend, building, FILE\.json, .* or FILE\.py"),
        (["listing", "none.py"], "none.py"),
        (["demo", "--isa", "mmx"], "isa.*mmx"),
        (["demo", "--size", "0x5"], r"size\[0\]"),
        (["demo", "--threads", "0"], "threads"),
        (["demo", "-o", "/dev/null"], "/dev/null"),
    ],
)
def test_errors_are_one_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]):
    assert main(arguments) == 1
    error = capsys.readouterr().err
    assert re.fullmatch(f"octomarch: .*{message}.*\n", error)


@pytest.mark.parametrize("arguments", [[], ["paint"], ["demo", "--size", "big"]])
def test_wrong_usage_exits_with_two(arguments: list[str], capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as error:
        main(arguments)
    assert error.value.code == 2
    assert re.fullmatch(r"octomarch( \w+)?: .*; see octomarch( \w+)? --help\n", capsys.readouterr().err)


def test_interruption_is_told_quietly(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(om.Shot, "render", interrupted)
    assert main(["demo", "-o", str(tmp_path)]) == 130


@pytest.mark.skipif(sys.platform == "win32", reason="signals are of POSIX")
def test_ctrl_c_ends_the_demo_at_once_and_leaves_no_file(tmp_path: Path):
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "octomarch", "demo", "-o", str(folder), "--size", "4000x3000", "--isa", "scalar"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not folder.exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.5)  # the render has begun: its folder is made just before
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
        took = time.monotonic() - begin
    assert process.returncode == 130
    assert "octomarch: interrupted" in error
    assert took < 1.0  # most of it for the interpreter to end
    assert list(folder.iterdir()) == []


def test_module_runs_as_a_program(tmp_path: Path):
    command = [sys.executable, "-m", "octomarch", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path, env=os.environ)
    assert done.stdout == f"octomarch {om.__version__}\n"


def test_mesh_of_a_scene_is_cut_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "blend.ply"
    arguments = ["mesh", "blend", "-o", str(out), "--resolution", "24"]
    assert main(arguments) == 1
    assert "bounds must be given, since the shape has no end along x, y, z, such as bounds=" in capsys.readouterr().err
    assert main([*arguments, "--bounds=-2,-1.5,-2,2,1.5,2", "--threads", "1"]) == 0
    mesh = trimesh.load_mesh(out)
    assert mesh.is_watertight
    assert re.search(rf"{len(mesh.vertices)} vertices, {len(mesh.faces)} triangles, \d+ ev", capsys.readouterr().out)
    assert main(["mesh", "blend", "-o", str(tmp_path / "blend.xyz")]) == 1
    assert "OUT must end in .stl or .ply or .obj or .glb" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*arguments, "--bounds=1,2,3"])
    assert "bounds must look like -1,-1,-1,1,1,1, got '1,2,3'" in capsys.readouterr().err


def test_glsl_of_a_scene_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "blend.glsl"
    assert main(["glsl", "blend", "-o", str(out), "--set", "march.max_steps=99"]) == 0
    shot = DEMOS["blend"]()
    lines = out.read_text().splitlines()
    assert f"{len(lines)} lines" in capsys.readouterr().out
    assert "const int MAX_STEPS = 99;" in lines
    assert lines[-3:] == shot.scene.glsl(shot.camera).splitlines()[-3:]
    assert main(["glsl", "blend", "-o", str(tmp_path / "blend.txt")]) == 1
    assert "OUT must end in .glsl or .frag" in capsys.readouterr().err


def test_an_output_that_nobody_reads_ends_quietly(tmp_path: Path):
    shape = om.union(*(om.sphere(1.0, center=(3 * i, 0, 0)) for i in range(3000)))
    om.Scene(shape).save(tmp_path / "a.json")
    command = [sys.executable, "-m", "octomarch", "listing", str(tmp_path / "a.json")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 141


SCRIPT = """
import octomarch as om
from helper import radius

ball = om.sphere(radius)
number = 3


def make(radius=radius):
    return om.Scene(om.sphere(radius))


def broken():
    return om.sphere(-1)


def misspelt():
    return om.shpere(1)


def greedy(what):
    return what
"""


@pytest.fixture
def script(tmp_path: Path) -> Path:
    (tmp_path / "helper.py").write_text("radius = 2.0\n")
    (tmp_path / "scene.py").write_text(SCRIPT)
    (tmp_path / "wrong.py").write_text("import octomarch as om\nball = om.sphere(\n")
    return tmp_path


def test_names_of_scripts_are_shapes_scenes_and_functions(script: Path, capsys: pytest.CaptureFixture[str]):
    for name in ("ball", "make"):
        assert main(["listing", f"{script}/scene.py:{name}"]) == 0
        assert "sphere" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("scene.py:bal", r"scene\.py defines nothing named bal; did you mean .*/scene\.py:ball\?"),
        ("scene.py", r"scene\.py defines nothing named shot or scene or shape; it has .*/scene\.py:ball"),
        ("scene.py:number", r"scene\.py:number must be a shape, a scene or a shot, .*, got 3"),
        ("scene.py:broken", r"scene\.py:14: ValueError: radius must be .*, got -1"),
        ("scene.py:misspelt", r"scene\.py:18: AttributeError: .* no attribute 'shpere'; did you mean 'sphere'\?"),
        ("scene.py:greedy", r"scene\.py: TypeError: greedy\(\) missing 1 required .* 'what'"),
        ("wrong.py:ball", r"wrong\.py:2: SyntaxError: '\(' was never closed"),
        ("none.py:ball", r"there is no file .*/none\.py"),
    ],
)
def test_what_is_wrong_in_scripts_is_one_line(
    name: str, message: str, script: Path, capsys: pytest.CaptureFixture[str]
):
    assert main(["listing", f"{script}/{name}"]) == 1
    assert re.fullmatch(f"octomarch: .*{message}\n", capsys.readouterr().err)


def test_cameras_of_scripts_go_with_their_scenes(script: Path):
    (script / "scene.py").write_text(
        """
import sys

import octomarch as om

scene = om.Scene(om.sphere(1.0))
camera = om.Camera((0, 0, float(sys.argv[1]) if sys.argv[1:] else 5.0), (0, 0, 0))
shot = om.Shot(scene, size=(16, 12))
"""
    )
    for name in ("scene", "shot"):  # a shot has its own, or none
        out = str(script / f"{name}.png")
        assert main(["render", f"{script}/scene.py:{name}", "-o", out, "--size", "16x12", "-q"]) == 0
        assert (om.Shot.load(out).camera == om.Camera((0, 0, 5), (0, 0, 0))) is (name == "scene")


def test_tracebacks_are_shown_where_asked_for(script: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["listing", f"{script}/scene.py:broken", "--traceback"]) == 1
    error = capsys.readouterr().err
    assert "Traceback" in error
    assert error.splitlines()[-1].startswith("octomarch: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["rendr", "blend"], "invalid choice: 'rendr' .*; did you mean 'render'"),
        (
            ["render", "blend", "-o", "a.png", "--smaples", "4"],
            "unrecognized arguments: --smaples 4; did you mean '--samples'",
        ),
        (["render", "blend", "-o", "a.png", "--crop", "1,2"], "--crop: must look like 0,0,320,240, got '1,2'"),
        (["render", "blend", "-o", "a.png", "--jobs", "0"], "--jobs: must be a number of processes"),
        (["render", "blend", "-o", "a.png", "--set", "march"], "--set: must look like march.max_steps=64, got 'march'"),
        (["render", "blend", "-o", "a.png", "--jobs", "2", "--cluster", "x"], "not allowed with argument --jobs"),
        (["render", "blend"], "the following arguments are required: -o/--output"),
    ],
)
def test_usage_is_told_in_a_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert re.fullmatch(rf"octomarch( \w+)?: .*{message}.*; see octomarch( \w+)? --help\n", capsys.readouterr().err)


def test_info_of_a_scene_and_as_json(capsys: pytest.CaptureFixture[str]):
    assert main(["info", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["ISAs"] == om.isas()
    assert main(["info", "building", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["instructions"] == om.compile(DEMOS["building"]().scene).instructions
    assert main(["info", "blend"]) == 0
    assert "PointLight" in capsys.readouterr().out


def test_show_makes_a_picture_of_numbers(tmp_path: Path):
    out = tmp_path / "steps.png"
    assert (
        main(["render", "blend", "-o", str(out), "--size", "48x27", "--show", "steps", "--map", "iterations", "-q"])
        == 0
    )
    steps = DEMOS["blend"]().render(size=(48, 27), planes=("steps",)).steps
    expected = np.minimum(5 * steps, 255)
    assert (np.asarray(PIL.Image.open(out))[..., 0] == expected).all()
