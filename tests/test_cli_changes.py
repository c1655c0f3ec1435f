"""``--set`` reaches every field of a scene's settings, by the classes' own checks, and says what is wrong."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import octomarch as om
from octomarch.cli.changes import assignment, changed

SCENE = om.Scene(om.sphere(1.0), lights=[om.DirectionalLight((-1, -2, -1)), om.PointLight((2, 5, 2))])
SHOT = {"scene": SCENE, "camera": om.Camera((0, 0, 4), (0, 0, 0)), "size": (64, 48)}


def after(*texts: str, request: dict[str, Any] = SHOT) -> dict[str, Any]:
    return changed(request, [assignment(text) for text in texts])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("samples=64", 64),
        ("samples=1e-4", 1e-4),
        ("samples=true", True),
        ("samples=null", None),
        ("samples=None", None),
        ("samples=False", False),
        ("samples=soft", "soft"),
        ("samples=1,2,3", [1, 2, 3]),
        ("samples=[1, 2]", [1, 2]),
        ("samples=color,depth", ["color", "depth"]),
        ("samples=1,None,x", [1, None, "x"]),
        ("samples=a file, of course", "a file, of course"),
        ('samples="64"', "64"),
        ("samples=", ""),
        ("samples=a=b", "a=b"),
    ],
)
def test_values_are_json_or_words(text: str, value: object):
    assert assignment(text).value == value


OTHERS = {
    om.March: {
        "method": "plain",
        "max_steps": 64,
        "epsilon": 1e-3,
        "pixel_tolerance": 0.5,
        "max_distance": 50.0,
        "min_distance": 0.25,
        "finish": None,
        "bias": 0.125,
        "prune": False,
    },
    om.Shading: {
        "normals": "central",
        "normal_step": 0.5,
        "shadows": "hard",
        "shadow_k": 8.0,
        "occlusion": 3,
        "occlusion_distance": 0.5,
        "bounces": 2,
        "reflection_cutoff": 0.25,
        "reflection_offset": 0.125,
    },
}


@pytest.mark.parametrize("kind", OTHERS)
def test_every_setting_is_reached(kind: type):
    name = kind.__name__.lower()
    fields = {field.name for field in dataclasses.fields(kind)} - {"step"}
    assert set(OTHERS[kind]) == fields
    for field, value in OTHERS[kind].items():
        assert after(f"{name}.{field}={value}")[name] == kind(**{field: value})


def test_what_goes_together_may_come_in_any_order():
    for texts in (("march.step=0.5", "march.method=fixed"), ("march.method=fixed", "march.step=0.5")):
        assert after(*texts)["march"] == om.March("fixed", step=0.5)
    assert after("samples=4", "samples=2")["samples"] == 2


def test_camera_sky_ambient_and_lights():
    request = after(
        "camera.eye=1,2,3", "sky.base=0.25", "ambient=0.5", "lights.1.decay=0", "scene.lights.0.color=1,0.5,0"
    )
    assert request["camera"] == om.Camera((1, 2, 3), (0, 0, 0))
    scene = request["scene"]
    assert scene.sky == om.Sky(base=0.25)
    assert scene.ambient == (0.5, 0.5, 0.5)
    assert scene.lights == (om.DirectionalLight((-1, -2, -1), (1, 0.5, 0)), om.PointLight((2, 5, 2), decay=0))
    assert scene.shape is SCENE.shape
    assert request["size"] == (64, 48)


def test_other_kinds_keep_what_both_have():
    request = after("camera.type=OrthographicCamera", "camera.height=3", "sky.type=ConstantSky", "sky.color=0.5")
    assert request["camera"] == om.OrthographicCamera((0, 0, 4), (0, 0, 0), height=3)
    assert request["scene"].sky == om.ConstantSky(0.5)


def test_whole_objects_are_written_as_in_scene_files():
    lamp = '{"type": "SpotLight", "position": [0, 3, 0], "direction": [0, -1, 0]}'
    request = after(f"lights=[{lamp}]", 'sky={"type": "ConstantSky", "color": 0.5}')
    assert request["scene"].lights == (om.SpotLight((0, 3, 0), direction=(0, -1, 0)),)
    assert request["scene"].sky == om.ConstantSky(0.5)
    assert after("lights=[]")["scene"].lights == ()


def test_skies_take_pictures(tmp_path):
    om.write_png(tmp_path / "sky.png", np.full((2, 4, 3), 0.5))
    sky = after("sky.type=EnvironmentMap", f"sky.image={tmp_path}/sky.png", "sky.rotation=90")["scene"].sky
    assert (sky.image.shape, sky.rotation) == ((2, 4, 3), 90)
    assert after("sky.rotation=0", request={**SHOT, "scene": om.Scene(SCENE.shape, sky=sky)})["scene"].sky.rotation == 0


def test_shapes_alone_are_lit_and_framed_first():
    bare = {"scene": om.sphere(1.0)}
    assert after("camera.fov=20", request=bare)["camera"].fov == 20
    assert isinstance(after("camera.fov=20", request=bare)["scene"], om.Shape)
    scene = after("ambient=0", request=bare)["scene"]
    assert (scene.ambient, len(scene.lights)) == ((0, 0, 0), 1)


@pytest.mark.parametrize("text", ["march", "march.=3", "=3", "march.max-steps=3", ""])
def test_malformed_changes_are_refused(text: str):
    with pytest.raises(Exception, match=r"must look like march\.max_steps=64"):
        assignment(text)


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["march.max_step=64"], "march.max_step is no setting; did you mean 'max_steps'"),
        (["march.max_steps=many"], r"march\.max_steps must be an integer, got 'many'"),
        (["march.max_steps=0"], r"march\.max_steps must lie in \[1, .*\], got 0"),
        (["march.max_steps.x=1"], "march.max_steps.x is no setting: march.max_steps has no parts"),
        (["march.method=planar"], "march.method must be one of .*; did you mean 'plain'"),
        (["march=fast"], "march must be an om.March, got 'fast'"),
        (["march=fast", "march.bias=1"], "march.bias cannot be set beside the whole"),
        (["march.bias=1", "march=fast"], "march must be an om.March, got 'fast'"),
        (["march.type=Shading"], "march.type must be one of 'March'"),
        (["shading.shadow=none"], "shading.shadow is no setting; did you mean 'shadows'"),
        (["camera.fov=180"], r"camera\.fov must lie inside \(0, 180\) degrees, got 180"),
        (["camera.eye=1,2"], r"camera\.eye must be three numbers, got \(1, 2\)"),
        (["camera.eye=NaN,0,0"], r"camera\.eye must be finite, got \(nan, 0, 0\)"),
        (["camera.height=2"], "camera.height is no setting; there are eye, target, up, fov"),
        (["camera.type=Panoramic"], "camera.type must be one of .*; did you mean 'PanoramicCamera'"),
        (["camera.eye=1,2,x"], r"camera\.eye\[2\] must be a number, got 'x'"),
        (["planes=color,dept"], "planes must be one of .*, got 'dept'; did you mean 'depth'"),
        (["camera=1"], "camera must be an om.Camera, .* got 1"),
        (["sky.type=ConstantSky"], "sky.color is missing, which ConstantSky needs"),
        (["sky=blue"], "sky must be a sky such as om.Sky, got 'blue'"),
        (["ambient=-1"], "ambient must be ≥ 0, got -1"),
        (["ambient.r=1"], "ambient.r is no setting"),
        (["lights.2.color=1"], "lights.2 is no setting: of lights there are 0 to 1"),
        (["lights.x.color=1"], "lights.x is no setting"),
        (["lights=1"], "lights must be a sequence of lights, got 1"),
        (['lights=[{"type": "Lamp"}]'], r"lights\.0\.type must be one of"),
        (['lights=[{"type": "PointLight"}]'], r"lights\.0\.position is missing, which PointLight needs"),
        (["size.width=1"], "size.width is no setting: size has no parts"),
        (["samples=0", "ambient=1"], "samples"),
    ],
)
def test_wrong_changes_name_the_place_and_the_value(texts: list[str], message: str):
    with pytest.raises((TypeError, ValueError), match=f"^{message}"):
        om.render(**after(*texts))


def test_unknown_heads_suggest():
    with pytest.raises(Exception, match=r"mach\.bias is no setting; did you mean 'march'"):
        assignment("mach.bias=1")
