"""Nodes of the graph as plain data, and back from plain data of unknown origin; `_document` keeps them in files.

A node is an object such as ``{"kind": "union", "k": 0.25, "children": [0, 1]}``: its kind and parameters by the names
of cpp/octomarch/graph/nodes.def, and the places of its children, which stand before it. Images and grids hold their
texels and samples as base64 of zlib-compressed little-endian 32-bit floats.
"""

from __future__ import annotations

import base64
import binascii
import math
import zlib
from collections.abc import Sequence
from typing import Any, Never

import numpy as np
from numpy.typing import NDArray

from octomarch import _core
from octomarch import _validate as check

_KINDS = _core.node_kinds()
_ARRAYS = {"image": "texels", "grid": "values"}
_FIELDS = {
    kind: {"kind", "children", _ARRAYS.get(kind, "texels"), *(name for name, _, _ in _KINDS[kind])} for kind in _KINDS
}
_WHOLE = ("axis", "whole")
_INFINITIES = {"inf": math.inf, "-inf": -math.inf}
_MOST_UNPACKED = (
    100  # bytes from one: what repeats itself more is stored as it is, so that files never swell beyond this
)


def refuse(place: str, requirement: str, value: object) -> Never:
    """Raise the `ValueError` that a place in a document must be something else."""
    raise ValueError(f"{place} must be {requirement}, got {check.shown(value)}")


def infinity(value: object) -> float | None:
    """Return the infinity that a text stands for, if it does: JSON has no number for it."""
    return _INFINITIES.get(value) if isinstance(value, str) else None


def plain_nodes(nodes: Sequence[_core.Node]) -> list[dict[str, Any]]:
    """Return nodes, each after its children, as plain data."""
    return [_plain(*content) for content in _core.contents(nodes)]


def restored_nodes(items: object) -> _core.NodeList:
    """Return the nodes that plain data describes.

    Raises
    ------
    ValueError
        Naming the place and the value of what is missing, unknown or outside its range.
    """
    if not isinstance(items, list):
        refuse("nodes", "a list", items)
    nodes = _core.NodeList()
    for i, item in enumerate(items):
        _append(nodes, item, f"nodes[{i}]")
    return nodes


def _plain(
    kind: str, parameters: list[float], children: list[int], texels: NDArray[np.float32] | None
) -> dict[str, Any]:
    result: dict[str, Any] = {"kind": kind}
    first = 0
    for name, type_, count in _KINDS[kind]:
        values: list[Any] = parameters[first : first + count] if count else parameters[first:]
        first += count
        if type_ in _WHOLE or not all(map(math.isfinite, values)):
            values = [_plain_number(type_, value) for value in values]
        result[name] = values[0] if count == 1 else values
    if children:
        result["children"] = children
    if texels is not None:
        result[_ARRAYS[kind]] = _packed(texels)
    return result


def _plain_number(type_: str, number: float) -> float | int | str:
    if math.isfinite(number):
        return int(number) if type_ in _WHOLE else number
    return "inf" if number > 0 else "-inf"


def _append(nodes: _core.NodeList, item: object, place: str) -> None:
    if not isinstance(item, dict):
        refuse(place, "an object", item)
    if "kind" not in item:
        raise ValueError(f"{place}.kind is missing")
    kind = item["kind"]
    described = _KINDS.get(kind) if isinstance(kind, str) else None
    if described is None:
        refuse(f"{place}.kind", "a kind of node that this version knows", kind)
    for key in item:
        if key not in _FIELDS[kind]:
            raise ValueError(f"{place}.{key} is unknown")
    parameters: list[float] = []
    for name, _, count in described:
        if name not in item:
            raise ValueError(f"{place}.{name} is missing")
        value = item[name]
        if count == 1:
            parameters.append(_number(place, name, value))
        elif not isinstance(value, list) or (count and len(value) != count):
            refuse(f"{place}.{name}", f"a list of {count or 'any number of'} numbers", value)
        else:
            parameters += [_number(place, f"{name}[{i}]", number) for i, number in enumerate(value)]
    children = _children(item, place, len(nodes))
    array = _ARRAYS.get(kind, "texels")
    texels = _unpacked(item, array, parameters, place) if array in item else None
    try:
        nodes.append(kind, parameters, children, texels)
    except ValueError as error:
        raise ValueError(f"{place}.{error}") from None


def _number(place: str, name: str, value: object) -> float:
    if type(value) is float:
        return value
    infinite = infinity(value)
    if infinite is not None:
        return infinite
    try:
        return check.number(f"{place}.{name}", value)
    except TypeError as error:
        raise ValueError(str(error)) from None


def _children(item: dict[str, Any], place: str, count: int) -> list[int]:
    children = item.get("children", [])
    if not isinstance(children, list):
        refuse(f"{place}.children", "a list", children)
    for i, child in enumerate(children):
        if type(child) is not int or not 0 <= child < count:
            refuse(f"{place}.children[{i}]", "the place of a node before this one", child)
    return children


def _packed(texels: NDArray[np.float32]) -> str:
    raw = np.ascontiguousarray(texels, dtype="<f4").tobytes()
    packed = zlib.compress(raw)
    if len(raw) > _MOST_UNPACKED * len(packed):
        packed = zlib.compress(raw, level=0)
    return base64.b64encode(packed).decode("ascii")


def _unpacked(item: dict[str, Any], array: str, size: list[float], place: str) -> NDArray[np.float32]:
    """Return the array of a node whose parameters begin with its `size`; no more memory is taken than they promise."""
    place = f"{place}.{array}"
    kind = item["kind"]
    if kind not in _ARRAYS:
        refuse(place, "absent where there is no image", item[array])
    try:
        packed = base64.b64decode(item[array], validate=True)
    except (TypeError, ValueError, binascii.Error):
        refuse(place, "base64", item[array])
    length = 4 * size[0] * size[1] * (3 if kind == "image" else size[2])
    if not 4 <= length <= _MOST_UNPACKED * len(packed):
        refuse(place, f"at least {length / _MOST_UNPACKED:.0f} packed bytes for the {kind}'s size", len(packed))
    unpacker = zlib.decompressobj()
    try:
        raw = unpacker.decompress(packed, int(length) + 1)
    except zlib.error as error:
        raise ValueError(f"{place} cannot be unpacked: {error}") from None
    if len(raw) != length or not unpacker.eof or unpacker.unused_data:
        refuse(place, f"{length:.0f} bytes once unpacked", f"{len(raw)} bytes or another end")
    return np.frombuffer(raw, dtype="<f4").astype(np.float32)
