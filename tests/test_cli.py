"""The command line, called as a function, and once as a program."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
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
    scene = om.Scene(mirror, lights=[om.DirectionalLight((-1, -2, -1))])
    shot = om.Shot(scene, om.Camera((2, 3, 4), (0, 0, 0)), (48, 36), samples=4, shading=om.Shading(bounces=1))
    shot.save(tmp_path / "shot.json")
    assert main(["render", str(tmp_path / "shot.json"), "-o", str(tmp_path / "shot.png")]) == 0
    output = capsys.readouterr().out
    stats = shot.render().stats
    kinds = ("primary", "cone", "shadow", "reflection", "occlusion", "gradient")
    counts = {kind: stats[f"{kind}_evaluations"] for kind in kinds}
    assert all(counts.values())
    per_ray = (counts["primary"] + counts["cone"]) / stats["rays"]
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
