"""What ``--set march.max_steps=64`` does: one field of a scene or its settings gets another value.

The fields are those of the classes, and these check the values, so that whatever the Python API takes is reached.
"""

from __future__ import annotations

import argparse
import dataclasses
import inspect
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

from octomarch import _validate as check
from octomarch._document import CLASSES
from octomarch._spelling import nearest
from octomarch.camera import AnyCamera, or_framing
from octomarch.lights import Light
from octomarch.march import March
from octomarch.program import compile
from octomarch.render import lit_by_default
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.skies import AnySky

_KINDS: dict[str, tuple[type[Any], ...]] = {
    "march": (March,),
    "shading": (Shading,),
    "camera": get_args(AnyCamera),
    "sky": get_args(AnySky),
    "lights": get_args(Light),
}
"""Classes that may stand at a place."""

_SCENE = ("sky", "ambient", "lights")
_PICTURE = ("size", "samples", "precision", "planes", "crop")
_HEADS = ("march", "shading", "camera", *_SCENE, *_PICTURE)
_PYTHON = {"None": None, "True": True, "False": False}


@dataclass(frozen=True)
class Assignment:
    """One ``--set``: names on the way to a field, and its new value."""

    path: tuple[str, ...]
    value: Any


def assignment(text: str) -> Assignment:
    """Read PATH=VALUE.

    Examples
    --------
    >>> assignment("march.max_steps=64").value, assignment("camera.eye=1,2,3").value
    (64, [1, 2, 3])
    >>> assignment("march.method=plain")
    Assignment(path=('march', 'method'), value='plain')
    """
    path, equals, value = text.partition("=")
    if not (equals and re.fullmatch(r"\w+(\.\w+)*", path)):
        raise argparse.ArgumentTypeError(f"must look like march.max_steps=64, got {text!r}")
    names = tuple(path.split("."))
    names = names[1:] if names[0] == "scene" and len(names) > 1 else names
    if names[0] not in _HEADS:
        raise argparse.ArgumentTypeError(f"{path} is no setting{_hint(names[0], _HEADS)}")
    return Assignment(names, _value(value))


def changed(request: Mapping[str, Any], assignments: Sequence[Assignment]) -> dict[str, Any]:
    """Return arguments of `octomarch.render` with other values.

    Examples
    --------
    >>> import octomarch as om
    >>> changed({"scene": om.sphere(1.0)}, [assignment("march.max_steps=64"), assignment("samples=4")])["samples"]
    4
    >>> changed({"scene": om.sphere(1.0)}, [assignment("march.max_step=64")])
    Traceback (most recent call last):
    ValueError: march.max_step is no setting; did you mean 'max_steps'?
    """
    tree = _tree(assignments)
    result = {**request, **{name: tree.pop(name) for name in _PICTURE if name in tree}}
    scene = {name: tree.pop(name) for name in _SCENE if name in tree}
    if scene or "camera" in tree:
        whole = check.size(result.get("size", (640, 480)))
        camera = or_framing(result.get("camera"), compile(result["scene"]), whole)
        if "camera" in tree:
            result["camera"] = camera = _applied(camera, tree.pop("camera"), "camera")
        if scene:
            before = result["scene"]
            before = lit_by_default(before, camera) if isinstance(before, Shape) else before
            result["scene"] = _changed_scene(before, scene)
    for name, kind in {"march": March, "shading": Shading}.items():
        if name in tree:
            result[name] = _applied(result.get(name) or kind(), tree.pop(name), name)
    return result


def _value(text: str) -> Any:
    """Return what a text means: JSON, one of Python's three words, several of these with commas, or itself."""
    try:
        return json.loads(text)
    except ValueError:
        parts = text.split(",")
        if len(parts) > 1 and all(re.fullmatch(r"\s*[\w.+-]+\s*", part) for part in parts):
            return [_value(part.strip()) for part in parts]
        return _PYTHON.get(text, text)


@dataclass(frozen=True)
class _Leaf:
    value: Any


def _tree(assignments: Sequence[Assignment]) -> dict[str, Any]:
    """Return nested tables of changes, so that what belongs together changes at once; the last of two wins."""
    tree: dict[str, Any] = {}
    for each in assignments:
        at = tree
        for name in each.path[:-1]:
            at = at.setdefault(name, {})
            if isinstance(at, _Leaf):
                raise ValueError(f"{'.'.join(each.path)} cannot be set beside the whole of which it is part")
        at[each.path[-1]] = _Leaf(each.value)
    for name in _PICTURE:
        if name in tree:
            if not isinstance(tree[name], _Leaf):
                raise ValueError(f"{name}.{next(iter(tree[name]))} is no setting: {name} has no parts")
            tree[name] = _made(tree[name].value, name)
    return tree


def _changed_scene(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    fields: dict[str, Any] = {"sky": scene.sky, "ambient": scene.ambient, "lights": scene.lights}
    for name, change in changes.items():
        fields[name] = _applied(fields[name], change, name)
    return Scene(scene.shape, **fields)


def _applied(value: Any, change: Any, place: str) -> Any:
    """Return a value once it is changed: as a whole, or some of its parts."""
    if isinstance(change, _Leaf):
        return _made(change.value, place)
    if isinstance(value, tuple):
        return _changed_items(value, change, place)
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        raise ValueError(f"{place}.{next(iter(change))} is no setting: {place} has no parts")
    fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    kind = type(value)
    if "type" in change:
        kind = _kind(change["type"], place)
    names = [field.name for field in dataclasses.fields(kind) if not field.name.startswith("_")]
    arguments = {name: fields[name] for name in names if name in fields}
    for name, inner in change.items():
        if name != "type":
            if name not in names:
                raise ValueError(f"{place}.{name} is no setting{_hint(name, names)}")
            arguments[name] = _applied(arguments.get(name), inner, f"{place}.{name}")
    return _called(kind, arguments, place)


def _changed_items(items: tuple[Any, ...], change: Mapping[str, Any], place: str) -> tuple[Any, ...]:
    result = list(items)
    for name, inner in change.items():
        if not name.isdecimal() or int(name) >= len(items):
            there = f"0 to {len(items) - 1}" if items else "none"
            raise ValueError(f"{place}.{name} is no setting: of {place} there are {there}")
        result[int(name)] = _applied(items[int(name)], inner, f"{place}.{name}")
    return tuple(result)


def _made(plain: Any, place: str) -> Any:
    """Return the value of plain data, in which an object names its type."""
    if isinstance(plain, list):
        return tuple(_made(item, f"{place}.{i}") for i, item in enumerate(plain))
    if not isinstance(plain, dict):
        return plain
    kind = _kind(_Leaf(plain.get("type")), place)
    arguments = {name: _made(item, f"{place}.{name}") for name, item in plain.items() if name != "type"}
    return _called(kind, arguments, place)


def _kind(change: Any, place: str) -> type[Any]:
    """Return the class of that name, which has to be one for the place."""
    kinds = _KINDS.get(place.partition(".")[0], tuple(CLASSES.values()))
    name = change.value if isinstance(change, _Leaf) else change
    names = [kind.__name__ for kind in kinds]
    return kinds[names.index(check.choice(f"{place}.type", name, names))]


def _called(kind: type[Any], arguments: Mapping[str, Any], place: str) -> Any:
    """Return what a class makes of its fields; what it refuses is told by the place."""
    parameters = inspect.signature(kind).parameters
    for name, parameter in parameters.items():
        if parameter.default is parameter.empty and name not in arguments:
            raise ValueError(f"{place}.{name} is missing, which {kind.__name__} needs")
    for name in arguments:
        if name not in parameters:
            raise ValueError(f"{place}.{name} is no setting{_hint(name, list(parameters))}")
    try:
        return kind(**arguments)
    except (TypeError, ValueError) as error:
        begin = re.split(r"\W", str(error), maxsplit=1)[0]
        raise ValueError(f"{place}{'.' if begin in parameters else ': '}{error}") from None


def _hint(name: str, names: Sequence[str]) -> str:
    guess = nearest(name, names)
    return f"; did you mean {guess!r}?" if guess else f"; there are {', '.join(names)}"
