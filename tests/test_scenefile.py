"""Scenes as files, and pickles that go the same way: what is loaded is what was saved, bit for bit."""

import copy
import dataclasses
import gc
import json
import multiprocessing
import pickle
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import octomarch as om
from every_node import everything, materials, shapes
from expression_strategies import expression
from octomarch import _core, _document
from octomarch.scenefile import parsed, text
from strategies import POINTS, nested

GOLDEN = Path(__file__).parent / "data" / "scene-v1.json"
PICTURE = np.linspace(0, 1, 24, dtype=np.float32).reshape(2, 4, 3)
X, Y, Z = om.coordinates()

VALUES: list[Any] = [
    om.sphere(0.1),
    X + 1,
    (X < 1) & (Y < 1),
    om.checker(0, (1, 0.5, 0.25)),
    *materials(),
    om.DirectionalLight((0, -1, -0.0)),
    om.PointLight((1, 2, 3), decay=0),
    om.SpotLight((1, 2, 3), target=(0, 0.5, 0), softness=0.5),
    om.Sky(clamped=False),
    om.ConstantSky((0.5, 0.25, 1)),
    om.GradientSky([(-10, 0.1), (0, (0.5, 0.4, 0.3)), (90, 0)], axis=(0, 0, 1)),
    om.EnvironmentMap(PICTURE, rotation=20, intensity=0.5),
    om.CustomSky((X, 0.5, Z)),
    om.Camera((0, 0, 3), (0, 0.1, 0)),
    om.OrthographicCamera((0, 0, 3), (0, 0, 0), height=1e-300),
    om.PanoramicCamera((0, 0, 3), (0, 0, 0), fov=(300, 0.1)),
    om.March(),
    om.March(max_steps=7, epsilon=5e-324, max_distance=1e308, finish=None),
    om.Shading(normals="tetrahedron", bounces=3),
    om.Scene(om.box(1.0), om.EnvironmentMap(PICTURE), 0.3, [om.PointLight((0.1, 0.2, 0.3))]),
    everything(),
]


def through_a_file(value: Any) -> Any:
    return parsed(text(_document.document(value)).encode())


def same_bits(a: Any, b: Any) -> bool:
    """Tell whether values are equal in all digits, types and signs of zeros."""
    return a == b and repr(a) == repr(b) and _document.document(a) == _document.document(b)


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_come_back(value: Any):
    for again in (through_a_file(value), pickle.loads(pickle.dumps(value)), copy.deepcopy(value), copy.copy(value)):
        assert type(again) is type(value)
        assert same_bits(again, value)
        assert hash(again) == hash(value)


def test_all_there_is_comes_back():
    """Nothing that a file can hold is missing in this module."""
    kinds = {node["kind"] for node in _document.document(everything())["nodes"]}
    assert kinds == set(_core.node_kinds())
    assert {type(value).__name__ for value in VALUES} >= set(_document.CLASSES)


def test_parameters_do_not_hide_each_other():
    for kind, parameters in _core.node_kinds().items():
        names = ["kind", "children", "texels", "values", *(name for name, _, _ in parameters)]
        assert len(set(names)) == len(names), kind


@given(nested())
def test_shapes_come_back(sample: Any):
    again = through_a_file(sample.shape)
    assert again == sample.shape
    assert pickle.loads(pickle.dumps(sample.shape)) == sample.shape


@given(expression())
def test_expressions_come_back(sample: Any):
    assert through_a_file(sample.expression) == sample.expression


@given(st.floats(allow_nan=False))
def test_numbers_come_back(number: float):
    assert through_a_file(X * number) == X * number
    light = om.PointLight((number if np.isfinite(number) else 0, 0, -0.0))
    assert np.signbit(through_a_file(light).position[2])
    assert same_bits(through_a_file(light), light)


def test_truth_values_come_back_as_such():
    a, b = X < 1, (X < 1) + 0
    assert through_a_file(a) & a == a & a
    assert through_a_file(b) & b == b & b != a & a


def test_nodes_are_made_anew():
    """Not only found again: nothing that was saved is alive when it is loaded."""
    shape = shapes()[0].translate(0.123, 0, 0)
    data, distances = text(_document.document(shape)), shape.distance(POINTS)
    del shape
    assert np.array_equal(parsed(data).distance(POINTS), distances)


def test_pictures_are_the_same(tmp_path: Path):
    shot = everything()
    shot.save(tmp_path / "shot.json")
    before, after = shot.render(), om.Shot.load(tmp_path / "shot.json").render()
    assert before.size == (40, 30)
    for plane in before.planes:
        assert np.array_equal(getattr(before, plane), getattr(after, plane))


def test_shared_nodes_are_stored_once():
    shape = om.sphere(1.0)
    for _ in range(200):
        shape = shape | shape.translate(1, 0, 0)  # 2²⁰⁰ spheres, were they not shared
    document = _document.document(shape)
    assert len(document["nodes"]) == shape._node.node_count
    assert through_a_file(shape) == shape
    assert copy.deepcopy(shape) is shape


def test_graphs_of_any_depth_and_width(tmp_path: Path):
    deep = om.sphere(1.0)
    for i in range(70_000):
        deep = deep.translate(i + 1, 0, 0) if i % 2 else deep | om.sphere(i)
    wide = om.union(*(om.sphere(i) for i in range(50_000)))
    assert deep._node.node_count > 100_000
    for shape in (deep, wide):
        om.Scene(shape).save(tmp_path / "large.json")
        assert om.load(tmp_path / "large.json").shape == shape


def test_garbage_is_collected_again_after_saving_and_loading(tmp_path: Path):
    scene, path = om.Scene(om.sphere(1.0)), tmp_path / "scene.json"
    for was_enabled in (True, False):
        (gc.enable if was_enabled else gc.disable)()
        try:
            scene.save(path)
            om.load(path)
            with pytest.raises(ValueError, match="no JSON"):
                parsed("no")
            assert gc.isenabled() is was_enabled
        finally:
            gc.enable()


def test_scene_alone_and_with_settings(tmp_path: Path):
    scene, path = everything().scene, tmp_path / "scene.json"
    scene.save(path)
    assert om.load(path) == scene
    assert om.Shot.load(path) == om.Shot(scene)
    everything().save(path)
    assert om.load(path) == scene
    assert om.Shot.load(path) == everything()


def test_files_are_readable(tmp_path: Path):
    om.Scene(om.sphere(1.0) | om.box((1, 2, 3)), lights=[om.PointLight((1, 2, 3))]).save(tmp_path / "scene.json")
    lines = (tmp_path / "scene.json").read_text(encoding="utf-8").splitlines()
    assert '    {"kind": "sphere", "radius": 1.0},' in lines
    assert '    {"kind": "box", "half": [0.5, 1.0, 1.5]},' in lines
    assert '    {"kind": "union", "k": 0.0, "children": [0, 1]}' in lines
    light = '{"type": "PointLight", "position": [1.0, 2.0, 3.0], "color": [1.0, 1.0, 1.0], "decay": 2}'
    assert f'    "lights": [{light}]' in lines


def test_settings_left_out_have_their_defaults(tmp_path: Path):
    path = tmp_path / "short.json"
    content = {
        "type": "Scene",
        "shape": {"type": "Shape", "node": 0},
        "lights": [{"type": "PointLight", "position": [1, 2, 3]}],
    }
    document = {
        "format": "octomarch scene",
        "version": 1,
        "nodes": [{"kind": "sphere", "radius": 1}],
        "content": content,
    }
    path.write_text(json.dumps(document))
    assert om.load(path) == om.Scene(om.sphere(1.0), lights=[om.PointLight((1, 2, 3))])


def holds(after: Any, before: Any) -> bool:
    """Tell whether all that was there is there; later versions may know of more settings."""
    if isinstance(before, dict):
        return all(key in after and holds(after[key], value) for key, value in before.items())
    if isinstance(before, list):
        return len(after) == len(before) and all(map(holds, after, before))
    return bool(after == before)


def test_golden_file_keeps_loading():
    """Written by the first version of the format; a change of the format must not touch it."""
    before = json.loads(GOLDEN.read_text(encoding="utf-8"))
    shot = om.Shot.load(GOLDEN)
    after = _document.document(shot)
    assert json.loads(json.dumps(after["nodes"])) == before["nodes"]
    assert holds(after["content"], before["content"])
    assert shot.scene.shape.distance([3, 0, 0]) < shot.scene.shape.distance([3, 2, 0])


# Files ----------------------------------------------------------------------------------------------------------------


def test_saving_is_atomic_and_checked(tmp_path: Path):
    scene, path = om.Scene(om.sphere(1.0)), tmp_path / "scene.json"
    scene.save(str(path))
    path.chmod(0o640)
    scene.save(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(ValueError, match=r"path must end in \.json, got '.*\.png'"):
        scene.save(tmp_path / "scene.png")
    with pytest.raises(FileNotFoundError, match="nowhere"):
        scene.save(tmp_path / "nowhere" / "scene.json")
    with pytest.raises(FileNotFoundError, match=r"other\.json"):
        om.load(tmp_path / "other.json")
    with pytest.raises(IsADirectoryError):
        om.load(tmp_path)


def test_what_no_file_can_hold_is_named():
    class Mine(om.Camera):
        pass

    shot = om.Shot(om.Scene(om.sphere(1.0)), Mine((0, 0, 3), (0, 0, 0)))
    with pytest.raises(TypeError, match=r"content\.camera cannot be kept in a scene file, got .*Mine"):
        _document.document(shot)


def test_shots_check_their_fields():
    scene = om.Scene(om.sphere(1.0))
    with pytest.raises(TypeError, match=r"scene must be om\.Scene, got <Shape"):
        om.Shot(scene.shape)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"camera must be om\.Camera or om\.OrthographicCamera or .*, got 3"):
        om.Shot(scene, 3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="samples must lie in"):
        om.Shot(scene, samples=65)
    with pytest.raises(ValueError, match="crop must lie within"):
        om.Shot(scene, size=(8, 8), crop=(4, 4, 5, 4))
    with pytest.raises(TypeError, match="colour"):
        om.Shot(scene).render(colour=3)


# Pictures -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".exr", ".png"])
def test_pictures_tell_how_to_make_them_again(tmp_path: Path, suffix: str):
    shot, path = everything(), tmp_path / f"picture{suffix}"
    image = shot.render()
    image.save(path)
    again = om.Shot.load(path)
    assert om.load(path) == shot.scene
    assert (again.size, again.crop, again.samples) == (shot.size, shot.crop, shot.samples)
    assert np.array_equal(again.render().color, image.color)


@pytest.mark.parametrize("suffix", [".exr", ".png"])
def test_pictures_of_large_scenes_do_not(tmp_path: Path, suffix: str):
    noise = np.random.default_rng(3).random((64, 64, 3), dtype=np.float32)
    scene = om.Scene(om.sphere(1.0).paint(om.Material(om.image_texture(noise))))
    path = tmp_path / f"picture{suffix}"
    om.render(scene, size=(8, 8)).save(path)
    assert path.stat().st_size < 10_000
    with pytest.raises(ValueError, match=r"picture.* the picture does not hold its scene"):
        om.load(path)


@pytest.mark.parametrize("suffix", [".exr", ".png"])
def test_damaged_pictures_are_os_errors(tmp_path: Path, suffix: str):
    path = tmp_path / f"picture{suffix}"
    om.render(om.sphere(1.0), size=(8, 8)).save(path)
    data = path.read_bytes()
    for length in (4, 8, 20, 60):
        path.write_bytes(data[:length])
        with pytest.raises(OSError, match="damaged"):
            om.load(path)


# Processes ------------------------------------------------------------------------------------------------------------


def _rendered(shot: om.Shot) -> np.ndarray[Any, Any]:
    return shot.render(threads=1, planes=("depth",)).depth


def test_processes_of_their_own_give_the_same_bits():
    shots = [dataclasses.replace(everything(), crop=(0, y, 64, 12)) for y in (0, 12, 24)]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        rows = np.concatenate(pool.map(_rendered, shots))
    assert np.array_equal(rows, everything().render(crop=None, planes=("depth",)).depth)


def test_pickles_load_in_a_fresh_process(tmp_path: Path):
    (tmp_path / "shot").write_bytes(pickle.dumps(everything()))
    script = "import pickle, sys; print(pickle.load(open(sys.argv[1], 'rb')).size)"
    done = subprocess.run([sys.executable, "-c", script, tmp_path / "shot"], capture_output=True, text=True, check=True)
    assert done.stdout == "(64, 36)\n"
