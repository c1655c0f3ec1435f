"""What `render` takes, what it gives back, and what it says about arguments that are wrong.

Whether the pictures are right is for other tests to say.
"""

import json
import re
import subprocess
import sys

import numpy as np
import pytest

import octomarch as om
from octomarch.planes import PLANES

BALL = om.sphere(1.0)
CAMERA = om.Camera((0, 0, 4), (0, 0, 0))
SMALL = (24, 16)


def test_default_picture_is_640_by_480_colours():
    image = om.render(BALL)
    assert image.size == (640, 480)
    assert image.planes == ("color",)
    assert image.color.shape == (480, 640, 3)
    assert image.color.dtype == np.float32


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_planes_have_documented_shapes_and_types(precision):
    image = om.render(BALL, CAMERA, SMALL, planes=tuple(PLANES), precision=precision)
    assert image.planes == tuple(PLANES)
    found = {name: (getattr(image, name).shape, getattr(image, name).dtype.name) for name in PLANES}
    assert found == {
        "color": ((16, 24, 3), precision),
        "depth": ((16, 24), precision),
        "position": ((16, 24, 3), precision),
        "normal": ((16, 24, 3), precision),
        "object_id": ((16, 24), "int32"),
        "material_id": ((16, 24), "int32"),
        "steps": ((16, 24), "int32"),
        "status": ((16, 24), "uint8"),
    }


def test_one_plane_may_be_a_string():
    assert om.render(BALL, CAMERA, SMALL, planes="depth").planes == ("depth",)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (65, 3)], ids=str)
def test_any_size_is_rendered(size):
    assert om.render(BALL, CAMERA, size).color.shape == (size[1], size[0], 3)


def test_row_zero_is_at_the_top():
    image = om.render(BALL | om.plane(point=(0, -1, 0)), CAMERA, SMALL, planes="status")
    assert (image.status[0] == om.Status.MISS).any()
    assert (image.status[-1] == om.Status.HIT).all()


def test_a_shape_alone_is_framed_and_lit():
    image = om.render(BALL, size=SMALL, planes=("color", "object_id"))
    seen = image.object_id == 0
    assert 0.1 < seen.mean() < 0.8
    assert seen[1:-1, 1:-1].sum() == seen.sum()
    lit = image.color[seen].mean(axis=1)
    assert lit.max() > 0.4
    assert lit.max() > 2 * lit.min()


def test_a_scene_without_lights_stays_as_it_is():
    scene = om.Scene(BALL, ambient=0.25)
    image = om.render(scene, CAMERA, SMALL, planes=("color", "object_id"), shading=om.Shading(occlusion=0))
    np.testing.assert_allclose(image.color[image.object_id == 0], 0.25 * 0.8, rtol=1e-6)


def test_orthographic_pictures_keep_sizes():
    camera = om.OrthographicCamera((0, 0, 10), (0, 0, 0), height=4)
    image = om.render(BALL, camera, (40, 40), planes="object_id")
    assert (image.object_id == 0).sum() == pytest.approx(np.pi * 100, rel=0.05)


def test_stats_count_rays():
    image = om.render(om.Scene(BALL), CAMERA, SMALL)
    assert image.stats["rays"] == 24 * 16
    assert image.stats["stages"]["shadow"]["count"] == 0
    assert image.stats["isa"] == om.isas()[0]


def test_metadata_tells_how_the_picture_was_made():
    march = om.March(max_steps=99)
    metadata = om.render(BALL, CAMERA, SMALL, march=march, planes=("color", "depth")).metadata
    assert metadata["camera"] == {"type": "Camera", "eye": (0, 0, 4), "target": (0, 0, 0), "up": (0, 1, 0), "fov": 45}
    assert metadata["march"]["max_steps"] == 99
    assert metadata["march"]["epsilon"] > 0
    settings = {"size": SMALL, "crop": None, "samples": 1, "planes": ["color", "depth"], "precision": "float32"}
    assert metadata["render"] == settings
    assert "sphere" in metadata["scene"]["listing"]
    json.dumps(metadata)


def test_metadata_describes_materials_lights_and_skies_as_plain_data():
    x, _, _ = om.coordinates()
    painted = BALL.paint(om.Material(om.checker(0, 1), roughness=0.2, reflectivity=om.clamp(x, 0, 1)))
    lights = [
        om.SpotLight((0, 3, 0), target=(0, 0, 0), angle=30),
        om.PointLight((1, 2, 3)),
        om.DirectionalLight((0, -1, 0)),
    ]
    sky = om.EnvironmentMap(np.ones((200, 400, 3), np.float32), rotation=90)
    scene = om.render(om.Scene(painted, sky=sky, lights=lights), CAMERA, SMALL).metadata["scene"]
    material = scene["materials"][0]
    assert material["roughness"] == 0.2
    assert material["color"].startswith("<Texture")
    assert material["reflectivity"].startswith("<Expression")
    assert [light["type"] for light in scene["lights"]] == ["SpotLight", "PointLight", "DirectionalLight"]
    assert scene["lights"][0]["direction"] == (0, -3, 0)
    assert scene["lights"][0]["angle"] == 30
    assert scene["sky"] == {"type": "EnvironmentMap", "image": "400 x 200 pixels", "rotation": 90, "intensity": 1}
    assert len(json.dumps(scene)) < 3000
    for other in (om.ConstantSky(1), om.GradientSky([(0, 1), (9, 2)]), om.CustomSky(om.checker(0, 1)), om.Sky()):
        found = om.render(om.Scene(BALL, sky=other), CAMERA, SMALL).metadata["scene"]["sky"]
        assert found["type"] == type(other).__name__
        json.dumps(found)


def test_metadata_of_large_scenes_stays_small():
    many = om.union(*(om.sphere(0.1, center=(i % 20, i // 20, 0)) for i in range(5000)))
    assert len(json.dumps(om.render(many, size=SMALL).metadata)) < 2000


def test_progress_is_told_from_none_to_all():
    calls = []
    om.render(BALL, CAMERA, (300, 200), progress=lambda done, total: calls.append((done, total)))
    done, totals = zip(*calls, strict=True)
    assert len(set(totals)) == 1
    assert done[-1] == totals[0]
    assert list(done) == sorted(done)


def test_progress_true_shows_a_bar(capsys):
    om.render(BALL, CAMERA, SMALL, progress=True)
    assert "render" in capsys.readouterr().err
    om.render(BALL, CAMERA, SMALL, progress=False)
    assert capsys.readouterr().err == ""


def test_an_exception_of_the_callback_stops_the_render():
    def stop(done, total):
        raise RuntimeError(f"enough after {done} of {total}")

    with pytest.raises(RuntimeError, match="enough after"):
        om.render(BALL, CAMERA, (300, 200), progress=stop)


def test_shapes_show_themselves_in_notebooks():
    assert (BALL - om.box(1.2))._repr_png_()[1:4] == b"PNG"


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"size": (0, 10)}, ValueError, r"size\[0\] must lie in \[1, .*got 0"),
        ({"size": (10, -1)}, ValueError, r"size\[1\] must lie in \[1, .*got -1"),
        (
            {"size": (10**9, 10**9)},
            ValueError,
            r"size must hold at most 2\*\*28 pixels, got \(1000000000, 1000000000\)",
        ),
        ({"size": (10**10, 1)}, ValueError, "size.*got 10000000000"),
        ({"size": (10, 10, 3)}, ValueError, r"size must be \(width, height\)"),
        ({"size": (10.0, 10)}, TypeError, r"size\[0\] must be an integer, got 10.0"),
        ({"size": 10}, TypeError, r"size must be \(width, height\), got 10"),
        ({"size": "10x10"}, TypeError, "size must be"),
        ({"camera": 3}, TypeError, r"camera must be an om\.Camera, .* or om\.PanoramicCamera, got 3"),
        ({"march": "plain"}, TypeError, r"march must be an om\.March, got 'plain'"),
        ({"shading": 3}, TypeError, r"shading must be an om\.Shading, got 3"),
        ({"planes": ("color", "albedo")}, ValueError, "planes must be one of 'color', .*got 'albedo'"),
        ({"planes": ()}, ValueError, "planes must name at least one plane"),
        ({"planes": None}, TypeError, "planes must be names of planes, got None"),
        ({"precision": "half"}, ValueError, "precision must be one of"),
        ({"threads": 0}, ValueError, "threads must lie in"),
        ({"threads": "all"}, TypeError, "threads must be an integer, got 'all'"),
        ({"isa": "mmx"}, ValueError, "isa.*mmx"),
        ({"progress": 3}, TypeError, "progress must be True, a callable or None, got 3"),
    ],
)
def test_bad_arguments_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        om.render(BALL, **{"size": SMALL, **arguments})


@pytest.mark.parametrize("scene", [3, None, "sphere", om.Material()], ids=repr)
def test_only_shapes_and_scenes_are_rendered(scene):
    with pytest.raises(TypeError, match=r"scene must be an om\.Shape or om\.Scene, got"):
        om.render(scene)
    with pytest.raises(TypeError, match=r"shape must be an om\.Shape or om\.Scene, got"):
        om.compile(scene)


def test_unknown_isa_in_the_environment_is_refused(monkeypatch):
    monkeypatch.setenv("OCTOMARCH_ISA", "mmx")
    with pytest.raises(ValueError, match="mmx"):
        om.render(BALL, CAMERA, SMALL)


@pytest.mark.parametrize("light", [om.DirectionalLight((0, -1, 0), 1e39), om.PointLight((0, 1e39, 0)), None], ids=repr)
@pytest.mark.parametrize("color", [0.5, (1e39, 0.0, 1.0)], ids=str)
def test_values_beyond_float32_give_no_nan(light, color):
    shape = BALL.paint(om.Material(color=color)) | om.plane(point=(0, -1, 0)).paint(om.Material(color=0.0))
    scene = om.Scene(shape, ambient=1e39, lights=[] if light is None else [light])
    assert not np.isnan(om.render(scene, CAMERA, SMALL).color).any()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of memory are of POSIX")
def test_pictures_without_memory_say_what_does_with_little():
    script = """
import resource, octomarch as om
resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31))
try:
    om.render(om.sphere(1.0), size=(16384, 16384), planes=("color", "depth"), threads=1)
except MemoryError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert re.match(
        "no memory for 16384×16384 pixels with the planes color, depth: octomarch.render_file needs little", done.stdout
    )
