"""Values such as scenes as plain data, and back from plain data of unknown origin; `scenefile` keeps them as JSON.

A document holds one value. Numbers, names and lists are what they are in JSON; an object such as
``{"type": "PointLight", "position": [2, 5, 2], …}`` is a value of the class of that name, with its public fields, and
``{"type": "Shape", "node": 7}`` one that is made of nodes, which the document lists (`_node_document`). The classes are
those of one table, and are called with what the document says, so that nothing else runs and every argument is checked.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, get_args, get_type_hints

import numpy as np

from octomarch import _core
from octomarch import _validate as check
from octomarch._node_document import infinity, plain_nodes, refuse, restored_nodes
from octomarch.camera import AnyCamera
from octomarch.expressions import Expression
from octomarch.lights import Light
from octomarch.march import March
from octomarch.materials import Material
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.shot import Shot
from octomarch.skies import AnySky
from octomarch.textures import Texture

FORMAT = "octomarch scene"
VERSION = 1

_KEYS = ("format", "version", "octomarch", "nodes", "content")
_CLASSES = (
    Scene,
    Shot,
    Material,
    March,
    Shading,
    *(kind for union in (Light, AnySky, AnyCamera) for kind in get_args(union)),
)
CLASSES: dict[str, type[Any]] = {kind.__name__: kind for kind in _CLASSES}
"""Classes whose values are their public fields."""


@dataclass(frozen=True)
class _Made:
    """A type that is made of nodes of one sort."""

    sort: str
    count: int
    make: Callable[..., Any]


_MADE = {
    "Shape": _Made("shape", 1, Shape),
    "Expression": _Made("expression", 1, Expression),
    "Truth": _Made("expression", 1, lambda node: Expression(node, _is_truth=True)),
    "Texture": _Made("expression", 3, lambda *nodes: Texture(*map(Expression, nodes))),
    "Image": _Made("image", 1, lambda node: node.texels),
}


def document(value: object) -> dict[str, Any]:
    """Return the document of a value.

    Raises
    ------
    TypeError, ValueError
        Naming the place, if something in it is of no type that documents hold, or NaN.
    """
    nodes = _nodes(value)
    places = {node: place for place, node in enumerate(nodes)}
    return {
        "format": FORMAT,
        "version": VERSION,
        "octomarch": _core.build_info()["version"],
        "nodes": plain_nodes(nodes),
        "content": _plain(value, "content", places.__getitem__),
    }


def weight(value: object) -> int:
    """Return how many nodes and numbers of texels the document of a value holds: most of its size."""
    nodes = _nodes(value)
    return len(nodes) + sum(texels.size for texels in (node.texels for node in nodes) if texels is not None)


def restored(plain: object) -> Any:
    """Return the value of a document.

    Raises
    ------
    ValueError
        Naming the place and the value of what is missing, unknown or outside its range.
    """
    if not isinstance(plain, dict):
        refuse("a scene", "an object", plain)
    if plain.get("format") != FORMAT:
        refuse("format", repr(FORMAT), plain.get("format"))
    if type(plain.get("version")) is not int or plain["version"] != VERSION:
        versions = f"octomarch {check.shown(plain.get('octomarch'))}, this is {_core.build_info()['version']}"
        raise ValueError(f"version must be {VERSION}, got {check.shown(plain.get('version'))}: written by {versions}")
    for key in plain:
        if key not in _KEYS:
            raise ValueError(f"{key} is unknown")
    for key in ("nodes", "content"):
        if key not in plain:
            raise ValueError(f"{key} is missing")
    return _restored(plain["content"], "content", restored_nodes(plain["nodes"]), frozenset())


def _nodes(value: object) -> list[_core.Node]:
    roots: list[_core.Node] = []
    _plain(value, "content", roots.append)
    return _core.children_first(roots)


def _plain(value: object, place: str, refer: Callable[[_core.Node], Any]) -> Any:
    """Return `value` as plain data, in which `refer` gives the places of nodes."""
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        if math.isnan(value):
            refuse(place, "a number", value)
        return value if math.isfinite(value) else str(value)
    if isinstance(value, (tuple, list)):
        return [_plain(item, f"{place}[{i}]", refer) for i, item in enumerate(value)]
    made = _made(value)
    if made is not None:
        name, nodes = made
        places = [refer(node) for node in nodes]
        return {"type": name, "node": places[0] if len(places) == 1 else places}
    kind = type(value)
    if CLASSES.get(kind.__name__) is not kind:
        raise TypeError(f"{place} cannot be kept in a scene file, got {check.shown(value)}")
    fields = {name: _plain(getattr(value, name), f"{place}.{name}", refer) for name in _words(kind.__name__)}
    return {"type": kind.__name__, **fields}


def _made(value: object) -> tuple[str, tuple[_core.Node, ...]] | None:
    """Return the type and the nodes of what is made of nodes."""
    if isinstance(value, Shape):
        return "Shape", (value._node,)
    if isinstance(value, Expression):
        return "Truth" if value._is_truth else "Expression", (value._node,)
    if isinstance(value, Texture):
        return "Texture", tuple(component._node for component in value.components)
    if isinstance(value, np.ndarray):
        return "Image", (_core.image(value),)
    return None


def _restored(plain: object, place: str, nodes: _core.NodeList, words: frozenset[str]) -> Any:
    """Return the value of plain data in which texts are among `words`."""
    if isinstance(plain, str):
        infinite = infinity(plain)
        if infinite is None and plain not in words:
            refuse(place, f"one of {', '.join(map(repr, sorted(words)))}" if words else "no text", plain)
        return plain if infinite is None else infinite
    if isinstance(plain, list):
        return tuple(_restored(item, f"{place}[{i}]", nodes, words) for i, item in enumerate(plain))
    if not isinstance(plain, dict):
        return plain
    name = plain.get("type")
    if isinstance(name, str) and name in _MADE:
        return _made_again(plain, _MADE[name], place, nodes)
    if isinstance(name, str) and name in CLASSES:
        return _called(plain, name, place, nodes)
    return refuse(f"{place}.type", "a type that this version knows", name)


def _made_again(plain: dict[str, Any], made: _Made, place: str, nodes: _core.NodeList) -> Any:
    for key in plain:
        if key not in ("type", "node"):
            raise ValueError(f"{place}.{key} is unknown")
    given = plain.get("node")
    places: list[Any] = given if isinstance(given, list) and made.count > 1 else [given]
    if len(places) != made.count:
        refuse(f"{place}.node", f"{made.count} places of nodes", given)
    for i in places:
        if type(i) is not int or not 0 <= i < len(nodes) or nodes[i].sort != made.sort:
            refuse(f"{place}.node", f"the place of a node that is a sort of {made.sort}", i)
    return made.make(*(nodes[i] for i in places))


def _called(plain: dict[str, Any], name: str, place: str, nodes: _core.NodeList) -> Any:
    """Return what the class makes of the fields; those that are left out have their defaults."""
    kind, words = CLASSES[name], _words(name)
    arguments = {}
    for key, item in plain.items():
        if key == "type":
            continue
        if key not in words:
            raise ValueError(f"{place}.{key} is unknown")
        arguments[key] = _restored(item, f"{place}.{key}", nodes, words[key])
    for argument, parameter in inspect.signature(kind).parameters.items():
        if parameter.default is parameter.empty and argument not in arguments:
            raise ValueError(f"{place}.{argument} is missing")
    try:
        return kind(**arguments)
    except (TypeError, ValueError) as error:
        begin = re.split(r"\W", str(error), maxsplit=1)[0]
        raise ValueError(f"{place}{'.' if begin in words else ': '}{error}") from None


@functools.cache
def _words(name: str) -> dict[str, frozenset[str]]:
    """Return the public fields of the class of that name, each with the texts that its type allows: never a path."""
    kind = CLASSES[name]
    hints = get_type_hints(kind)
    names = [field.name for field in dataclasses.fields(kind) if not field.name.startswith("_")]
    return {name: frozenset(_literals(hints[name])) for name in names}


def _literals(hint: Any) -> Iterator[str]:
    for argument in get_args(hint):
        if isinstance(argument, str):
            yield argument
        else:
            yield from _literals(argument)
