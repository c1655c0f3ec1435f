"""Files from anybody: whatever they hold, they load to something valid or are refused by place, and soon."""

import base64
import copy
import json
import re
import subprocess
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import octomarch as om
from every_node import everything
from octomarch import _document
from octomarch.scenefile import parsed, text
from strategies import POINTS

PICTURE = np.linspace(0, 1, 24, dtype=np.float32).reshape(2, 4, 3)
WHOLE = json.loads(text(_document.document(everything())))
SMALL = json.loads(
    text(
        _document.document(
            om.Scene(
                om.rectangle((1, 2)).extrude(0.5).repeat((3, 0, 0)).rotate(30).paint(om.Material(om.checker(0, 1)))
                | om.sphere(0.5).displace(0.1 * om.sin(om.coordinates()[0]), lipschitz=0.1),
                sky=om.EnvironmentMap(PICTURE),
                lights=[om.SpotLight((1, 2, 3), target=(0, 0, 0))],
            )
        )
    )
)


def node(document: Any, kind: str) -> dict[str, Any]:
    return next(item for item in document["nodes"] if item["kind"] == kind)


def refusal(document: Any) -> str:
    """Return the message by which a document is refused."""
    with pytest.raises(ValueError) as error:  # noqa: PT011  callers look at the message
        parsed(document if isinstance(document, (str, bytes)) else json.dumps(document))
    return str(error.value)


def edited(edit: Any, document: Any = WHOLE) -> Any:
    changed = copy.deepcopy(document)
    edit(changed)
    return changed


def setter(kind: str, key: str, value: Any) -> Any:
    """Return a document in which a node of that kind is another."""
    return edited(lambda document: node(document, kind).update({key: value}))


NODES = [
    ("sphere", "radius", -1, r"radius must be finite and >= 0, got -1"),
    ("sphere", "radius", "inf", r"radius must be finite and >= 0, got inf"),
    ("sphere", "radius", "1", r"radius must be a number, got '1'"),
    ("sphere", "radius", True, r"radius must be a number, got True"),
    ("sphere", "radius", [1], r"radius must be a number, got \[1\]"),
    ("sphere", "radius", 10**400, r"radius must fit a float, got 1000"),
    ("sphere", "colour", 1, r"colour is unknown"),
    ("sphere", "kind", "ball", r"kind must be a kind of node that this version knows, got 'ball'"),
    ("sphere", "kind", ["sphere"], r"kind must be a kind of node"),
    ("sphere", "children", [0], r"children\[0\] must be the place of a node before this one, got 0"),
    ("sphere", "children", 0, r"children must be a list, got 0"),
    ("sphere", "texels", "", r"texels must be absent where there is no image"),
    ("box", "half", [1, 2, -3], r"half\[2\] must be finite and >= 0, got -3"),
    ("box", "half", [1, 2], r"half must be a list of 3 numbers, got \[1, 2\]"),
    ("box", "half", [1, 2, None], r"half\[2\] must be a number, got None"),
    ("plane", "normal", [1, 1, 0], r"normal must be a unit vector, got \(1, 1, 0\)"),
    ("plane", "normal", [1e200, 0, 0], r"normal must be a unit vector"),
    ("torus", "axis", 3, r"axis must be 0, 1 or 2, got 3"),
    ("polygon", "corners", [0, 0, 1, 1], r"corners must be three points or more, got 4 numbers"),
    ("polygon", "corners", [0, 0, 1, 1, 2, 2, 3], r"corners must be three points or more, got 7 numbers"),
    ("polygon", "corners", [0, 0, 1, 1, 2, "inf"], r"corners\[5\] must be finite, got inf"),
    ("field", "lipschitz", -1, r"lipschitz must be >= 0, got -1"),
    ("field", "lo", ["inf", 0, 0], r"bounds must be two corners, .*, got \(inf, 0, 0\) and .*"),
    ("displace", "amplitude", 0.01, r"amplitude must be at least 0\.05\d*, as much as .*, got 0\.01"),
    ("metaballs", "k", 0, r"k must be > 0, got 0"),
    ("metaballs", "children", [], r"children must be at least 1 nodes, got 0"),
    ("union", "children", [-1], r"children\[0\] must be the place of a node before this one, got -1"),
    ("union", "children", [0, 10**6], r"children\[1\] must be the place of a node before this one, got 1000000"),
    ("union", "children", [0.0], r"children\[0\] must be the place of a node before this one, got 0\.0"),
    ("rotate", "rotation", [1, 0, 0, 0, 1, 0, 0, 0, 1.1], r"rotation must be orthonormal"),
    ("rotate", "rotation", [1, 0, 0, 0, 1, 0, 0, 0, -1], r"rotation must be right-handed, got a reflection"),
    ("scale", "factor", 0, r"factor must be finite and > 0, got 0"),
    ("stretch", "factors", [1, 0, 1], r"factors\[1\] must be finite and > 0, got 0"),
    ("repeat", "period", [0, 0, 0], r"period must be > 0 on an axis at least"),
    ("repeat", "count", [1, 0, 0], r"count must be 0 or >= 2"),
    ("repeat", "count", [2**31, 0, 0], r"count\[0\] must be a whole number from 0 to 2147483647, got 2147483648"),
    ("repeat", "count", [2.5, 0, 0], r"count\[0\] must be a whole number"),
    ("coordinate", "index", 6, r"index must be 0 to 5, got 6"),
    ("noise", "seed", -1, r"seed must be a whole number"),
    ("texel", "wrap", 3, r"wrap must be 0, 1 or 2, got 3"),
    ("grid", "values", "AAAA", r"values (cannot be unpacked|must be at least)"),
    ("grid", "values", 5, r"values must be base64, got 5"),
    ("grid", "texels", "", r"texels is unknown"),
    ("grid", "size", [5, 6, 8], r"values must be 960 bytes once unpacked, got"),
    ("grid", "size", [1, 30, 7], r"values must be an array with 2 or more along each axis, got \(1, 30, 7\)"),
    ("grid", "size", [1e9, 1e9, 1e9], r"values must be at least .* packed bytes for the grid's size"),
    ("grid", "interpolation", 2, r"interpolation must be 0 or 1, got 2"),
    ("grid", "lipschitz", 0.25, r"lipschitz must be >= 1\.\d+, the values' slope, got 0\.25"),
    ("grid", "steepness", 0, r"steepness must be finite and > 0, got 0"),
    ("grid", "lo", [0, 0, "inf"], r"lo\[2\] must be finite"),
    ("grid", "lo", [0, 9, 0], r"bounds must be two finite corners"),
    ("image", "width", 0, r"width must be >= 1, got 0|texels must be at least"),
    ("image", "width", 1e9, r"texels must be at least .* packed bytes for the image's size, got \d+"),
    ("image", "width", 3, r"texels must be 72 bytes once unpacked, got"),
    ("image", "texels", "no base64!", r"texels must be base64, got 'no base64!'"),
    ("image", "texels", 5, r"texels must be base64, got 5"),
    ("image", "texels", "AAAA", r"texels (cannot be unpacked|must be at least)"),
]


@pytest.mark.parametrize(("kind", "key", "value", "message"), NODES)
def test_nodes_are_refused_by_place_and_value(kind: str, key: str, value: Any, message: str):
    place = WHOLE["nodes"].index(node(WHOLE, kind))
    assert re.match(rf"nodes\[{place}\]\.({message})", refusal(setter(kind, key, value)))


@pytest.mark.parametrize("kind", sorted({item["kind"] for item in WHOLE["nodes"]}))
def test_every_part_of_a_node_must_be_there(kind: str):
    place = WHOLE["nodes"].index(node(WHOLE, kind))
    for key in node(WHOLE, kind):
        without = edited(lambda document, key=key: node(document, kind).pop(key))
        assert re.match(rf"nodes\[{place}\]\.(children|texels|values|{key} is missing)", refusal(without))


def test_children_are_of_the_right_sort():
    place, expression = (WHOLE["nodes"].index(node(WHOLE, kind)) for kind in ("union", "coordinate"))
    message = refusal(setter("union", "children", [expression]))
    if expression > place:
        assert re.match(rf"nodes\[{place}\]\.children\[0\] must be the place", message)
    document = copy.deepcopy(WHOLE)
    document["nodes"].append({"kind": "complement", "children": [expression]})
    assert refusal(document).endswith("children[0] must be shape, got expression")


def test_what_builders_refuse_is_refused():
    nodes: list[Any] = [
        {"kind": "sphere", "radius": 1},
        {"kind": "coordinate", "index": 3},
        *({"kind": "constant", "value": value} for value in (0.5, 2, -1, "inf")),
    ]
    for extra, message in [
        ({"kind": "extrude", "half_height": 1, "children": [0]}, "shape must be flat, got sphere"),
        ({"kind": "revolve", "offset": 0, "children": [0]}, "shape must be flat, got sphere"),
        ({"kind": "solid", "children": [1]}, "expression must be without the normal"),
        (
            {"kind": "displace", "lipschitz": 1, "amplitude": 9, "children": [0, 1]},
            "expression must be without the normal",
        ),
        ({"kind": "displace", "lipschitz": 1, "amplitude": 9, "children": [0, 5]}, "amplitude must be at least inf"),
        ({"kind": "paint", "children": [0, 2, 2, 2, 2, 2, 2]}, "children must be "),
        ({"kind": "paint", "children": [0, 2, 2, 2, 3, 2, 2, 2]}, r"children[4] must be from 0 to 1, got 2"),
        ({"kind": "paint", "children": [0, 2, 4, 2, 2, 2, 2, 2]}, r"children[2] must be finite and >= 0, got -1"),
        ({"kind": "paint", "children": [0, 5, 2, 2, 2, 2, 2, 2]}, r"children[1] must be finite and >= 0, got inf"),
    ]:
        document = {"format": "octomarch scene", "version": 1, "nodes": [*nodes, extra], "content": None}
        assert refusal(document).startswith(f"nodes[{len(nodes)}].{message}")


VALUES = [
    (("camera", "fov"), 180, r"content\.camera\.fov must lie inside \(0, 180\) degrees, got 180"),
    (("camera", "eye"), [1, 2, "inf"], r"content\.camera\.eye must be finite, got \(1, 2, inf\)"),
    (
        ("camera", "eye"),
        {"type": "Shape", "node": 0},
        r"content\.camera\.eye must be three numbers, got <Shape",
    ),
    (("camera", "zoom"), 2, r"content\.camera\.zoom is unknown"),
    (("camera", "type"), "Camcorder", r"content\.camera\.type must be a type that this version knows, got 'Camcorder'"),
    (("camera", "type"), "PointLight", r"content\.camera\.(eye|target|up|fov) is unknown"),
    (("march",), {"type": "Shading"}, r"content\.march must be om\.March, got Shading"),
    (("march", "method"), "magic", r"content\.march\.method must be one of .*'plain'.*, got 'magic'"),
    (("march", "max_steps"), 1.5, r"content\.march\.max_steps must be an integer, got 1\.5"),
    (("scene", "lights", 0), 3, r"content\.scene\.lights must be lights"),
    (("scene", "lights", 1, "decay"), 3, r"content\.scene\.lights\[1\]\.decay must lie in \[0, 2\], got 3"),
    (("scene", "ambient"), [0.1, 0.1, -1], r"content\.scene\.ambient must have components ≥ 0"),
    (("scene", "shape"), None, r"content\.scene\.shape must be an om\.Shape, got None"),
    (
        ("scene", "shape", "node"),
        10**9,
        r"content\.scene\.shape\.node must be the place of a node that is a sort of shape",
    ),
    (("scene", "shape", "node"), [0], r"content\.scene\.shape\.node must be the place of a node"),
    (("scene", "shape", "extra"), 0, r"content\.scene\.shape\.extra is unknown"),
    (("scene", "sky", "stops"), [], r"content\.scene\.sky\.stops must hold at least one"),
    (("size",), [1 << 20, 1 << 20], r"content\.size must hold at most 2\*\*28 pixels"),
    (("planes",), ["colour"], r"content\.planes\[0\] must be one of .*'color'.*, got 'colour'"),
]


@pytest.mark.parametrize(("path", "value", "message"), VALUES)
def test_values_are_refused_by_place_and_value(path: tuple[Any, ...], value: Any, message: str):
    document = copy.deepcopy(WHOLE)
    inner = document["content"]
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    assert re.match(message, refusal(document))


def test_narrow_twists_cut_their_content():
    """A file may give a twist a smaller radius than its content's: that is a cut like any other."""
    for kind in ("twist", "bend"):
        shape = parsed(json.dumps(setter(kind, "radius", 0.3))).scene.shape
        moved = POINTS + np.array([33.0, 0.0, 0.0])
        distances = shape.distance(moved, precision="float64")
        assert np.allclose(distances, om.reference.distance(shape, moved), rtol=0, atol=1e-12)


def test_missing_fields_are_named():
    del (document := copy.deepcopy(WHOLE))["content"]["camera"]["eye"]
    assert refusal(document) == "content.camera.eye is missing"
    del (document := copy.deepcopy(WHOLE))["content"]["scene"]
    assert refusal(document) == "content.scene is missing"


def test_versions_and_formats_are_told_apart():
    later = {**WHOLE, "version": 2, "octomarch": "9.9"}
    assert re.match(rf"version must be 1, got 2: written by octomarch '9\.9', this is {om.__version__}", refusal(later))
    for version in (None, "1", True, 1.0, 0):
        assert refusal({**WHOLE, "version": version}).startswith("version must be 1, got ")
    assert refusal({**WHOLE, "format": "gltf"}) == "format must be 'octomarch scene', got 'gltf'"
    assert refusal({}).startswith("format must be 'octomarch scene', got None")
    assert refusal([]).startswith("a scene must be an object")
    assert refusal({**WHOLE, "extras": 1}) == "extras is unknown"
    assert refusal({key: value for key, value in WHOLE.items() if key != "nodes"}) == "nodes is missing"


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "no JSON: Expecting value: line 1 column 1"),
        (b'{"format": "octomarch scene",\n', "no JSON: .*line 2"),
        (b"\xff\xfe{}", "no JSON, which is UTF-8: byte 0 is not"),
        (b'{"format": NaN}', "NaN is no number in JSON"),
        (b'{"format": 1, "format": 2}', "'format' stands twice in one object"),
        (b'{"version": ' + b"9" * 10_000 + b"}", ""),
        (b"[" * 1_000_000, "it is nested too deeply"),
        (b'{"a":' * 100_000, "it is nested too deeply"),
    ],
)
def test_what_is_no_document_is_refused(data: bytes, message: str, tmp_path: Path):
    assert re.match(message, refusal(data))
    (tmp_path / "bad.json").write_bytes(data)
    with pytest.raises(ValueError, match=r"bad\.json: "):
        om.load(tmp_path / "bad.json")


def test_content_must_be_a_scene(tmp_path: Path):
    (tmp_path / "light.json").write_text(text(_document.document(om.PointLight((1, 2, 3)))))
    with pytest.raises(ValueError, match=r"light\.json: content must be a Scene or a Shot, got PointLight"):
        om.load(tmp_path / "light.json")


def test_loading_opens_no_other_file(tmp_path: Path):
    """An environment map can be made of a path, but not in a file from anybody."""
    secret = tmp_path / "secret.png"
    om.render(om.sphere(1.0), size=(8, 8)).save(secret)
    om.EnvironmentMap(secret)
    document = edited(lambda document: document["content"]["sky"].update({"image": str(secret)}), SMALL)
    assert re.match(r"content\.sky\.image must be no text, got '.*secret\.png'", refusal(document))
    for image in ([str(secret)], {"type": "Path", "name": str(secret)}):
        refusal(edited(lambda document, image=image: document["content"]["sky"].update({"image": image}), SMALL))


def test_images_do_not_swell():
    """A few bytes cannot unpack to gigabytes; black pictures are stored as they are."""
    bomb = base64.b64encode(zlib.compress(bytes(12 * 4096 * 4096))).decode()
    document = setter("image", "texels", bomb)
    node(document, "image").update(width=4096, height=4096)
    assert re.search(r"texels must be at least \d+ packed bytes", refusal(document))
    black = om.Scene(om.sphere(1.0), sky=om.EnvironmentMap(np.zeros((64, 128, 3), np.float32)))
    assert parsed(text(_document.document(black))) == black


@pytest.mark.parametrize("kind", ["extrude", "solid", "displace", "texel", "twist", "repeat"])
def test_checks_are_linear_however_nodes_are_shared(kind: str):
    """Each of many nodes asks for all that lies below it: what is known of a node is not found out again."""
    count = 20_000
    nodes: list[dict[str, Any]] = [{"kind": "rectangle", "half": [1, 1]}, {"kind": "coordinate", "index": 0}]
    texels = base64.b64encode(zlib.compress(np.random.default_rng(1).random(3 * 256 * 256, np.float32).tobytes()))
    nodes.append({"kind": "image", "width": 256, "height": 256, "texels": texels.decode()})
    nodes.append({"kind": "sphere", "radius": 1})
    shape, expression = 3 if kind != "extrude" else 0, 1
    for i in range(count):
        if kind == "texel":
            nodes.append({"kind": "texel", "channel": 0, "wrap": 0, "children": [2, expression, 1]})
        elif kind in ("solid", "displace"):
            nodes.append({"kind": "sin", "children": [expression]})
        else:
            nodes.append({"kind": "scale", "factor": 2 if i % 2 else 0.5, "children": [shape]})
            shape = len(nodes) - 1
        expression = len(nodes) - 1 if kind in ("solid", "displace", "texel") else expression
        nodes += {
            "extrude": [{"kind": "extrude", "half_height": 1, "children": [shape]}],
            "solid": [{"kind": "solid", "children": [expression]}],
            "displace": [{"kind": "displace", "lipschitz": 1, "amplitude": 1, "children": [shape, expression]}],
            "texel": [{"kind": "displace", "lipschitz": 1, "amplitude": 1, "children": [shape, expression]}],
            "twist": [{"kind": "twist", "rate": 1, "radius": 1, "axis": 1, "children": [shape]}],
            "repeat": [{"kind": "repeat", "period": [1, 0, 0], "count": [0, 0, 0], "children": [shape]}],
        }[kind]
    content = {"type": "Shape", "node": 3}
    assert parsed(json.dumps({**WHOLE, "nodes": nodes, "content": content})) == om.sphere(1.0)


def test_memory_stays_in_proportion(tmp_path: Path):
    path = tmp_path / "deep.json"
    path.write_bytes(b"[" * 20_000_000)
    script = (
        "import resource, sys, octomarch as om\n"
        "resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))\n"
        "try:\n    om.load(sys.argv[1])\n"
        "except ValueError as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", script, path], capture_output=True, text=True, check=True)
    assert "nested too deeply" in done.stdout


# Mutations ------------------------------------------------------------------------------------------------------------

ODD: st.SearchStrategy[Any] = st.one_of(
    st.sampled_from(
        [0, 1, 2, -1, 0.5, 1e308, -1e308, 5e-324, 2**31, 2**63, "inf", "-inf", "", "nan", None, True, [], {}]
    ),
    st.integers(-3, 80),
    st.floats(allow_nan=False, allow_infinity=False),
    st.lists(st.floats(-2, 2), max_size=9),
    st.sampled_from(["Shape", "Texture", "Material", "EnvironmentMap", "sphere", "union", "paint", "texel", "twist"]),
    st.just({"type": "Shape", "node": 1}),
    st.just({"type": "Image", "node": 0}),
)


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the ways to all that stands in a document."""
    items: Any = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [*([path] if path else []), *(place for key, item in items for place in places(item, (*path, key)))]


PLACES = {id(document): places(document) for document in (WHOLE, SMALL)}


@st.composite
def mutants(draw: st.DrawFn) -> Any:
    """Return a document in which a few things are others, gone, doubled or in each other's place."""
    original = draw(st.sampled_from([WHOLE, SMALL]))
    document = copy.deepcopy(original)
    for _ in range(draw(st.integers(1, 3))):
        path, other = (draw(st.sampled_from(PLACES[id(original)])) for _ in range(2))
        action = draw(st.sampled_from(["replace", "replace", "remove", "rename", "double", "copy"]))
        try:
            inner, source = document, original
            for key in path[:-1]:
                inner = inner[key]
            for key in other:
                source = source[key]
            if action == "replace":
                inner[path[-1]] = draw(ODD)
            elif action == "remove":
                del inner[path[-1]]
            elif action == "copy":
                inner[path[-1]] = copy.deepcopy(source)
            elif isinstance(inner, list):
                inner.insert(path[-1], copy.deepcopy(inner[path[-1]]))
            else:
                inner[draw(st.sampled_from(["kind", "k", "radius", "color", "x"]))] = inner.pop(path[-1])
        except (AttributeError, KeyError, IndexError, TypeError):
            continue  # what an earlier mutation took away
    return document


ACCEPTED = "accepted"


def outcome(data: str | bytes) -> str:
    """Return why data is refused; what is not can be used: it is saved, compiled and evaluated."""
    try:
        value = parsed(data)
    except ValueError as error:
        return str(error)
    assert parsed(text(_document.document(value))) == value
    if isinstance(value, om.Shot):
        value = value.scene
    if isinstance(value, om.Scene):
        try:
            program = om.compile(value)
        except om.SceneError:
            return ACCEPTED
        assert program.lipschitz >= 0
        value.shape.distance(POINTS, threads=1)
    return ACCEPTED


PLACE = re.compile(
    r"(nodes|content|version|format|octomarch)\b.* (must|is|cannot|lie)\b|\w* is (unknown|missing)|a scene must be|"
    r"content.*: |accepted"
)


REASON = re.compile(r"^no JSON: | (must|is|cannot|lie)\b")
"""In any refusal, also of what has keys of all characters."""


@given(mutants())
@settings(deadline=None)
def test_mutants_load_or_are_refused_by_place(document: Any):
    message = outcome(json.dumps(document))
    assert PLACE.match(message), message


@given(st.data())
@settings(deadline=None)
def test_damaged_bytes_load_or_are_refused(data: st.DataObject):
    original = text(SMALL).encode()
    damaged = bytearray(original)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(damaged) - 1))
        what = data.draw(st.sampled_from(["set", "cut", "insert"]))
        byte = data.draw(st.one_of(st.integers(0, 255), st.sampled_from(b'0123456789"[]{},:.-e ')))
        if what == "set":
            damaged[at] = byte
        elif what == "insert":
            damaged.insert(at, byte)
        else:
            del damaged[at : at + data.draw(st.integers(1, 30))]
        if not damaged:
            return
    message = outcome(bytes(damaged))
    assert message == ACCEPTED or REASON.search(message), message
