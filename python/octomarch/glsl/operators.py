"""How operators over distances are written, and what becomes of materials across them. `writer` comes before it."""

from __future__ import annotations

from dataclasses import replace

from octomarch import _core
from octomarch.glsl.library import number
from octomarch.glsl.writer import Place, Steps, Writer, Written, writes

_SMALLEST_BLEND = 1.1754944e-38  # as in program/lower.cpp: below, a blend is none

_HARD = {"union": "min({a}, {b})", "intersection": "max({a}, {b})", "difference": "max({a}, -{b})"}
_FIRST = {"union": "{a} < {b}", "intersection": "{a} > {b}", "difference": "{a} > -{b}"}
_GAP = {"union": "{a} - {b}", "intersection": "{a} - {b}", "difference": "{a} + {b}"}


@writes("union", "intersection", "difference", "metaballs")
def _combination(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    result = yield node.children[0], at, material
    total = ""
    for child in node.children[1:]:
        other = yield child, at, material
        result = joined(writer, node.kind, node.parameters[0], result, other, total)
        total = result.distance
    return result


def joined(writer: Writer, kind: str, k: float, a: Written, b: Written, total: str) -> Written:
    """Write how two operands become one; `total` is the variable of those so far, that goes on."""
    hard = "union" if kind == "metaballs" else kind
    blends = k >= _SMALLEST_BLEND
    operands = {"a": a.distance, "b": b.distance}
    material = a.material
    if a.material != b.material:
        material = writer.let("Material", "material", _joined_material(kind, hard, k if blends else 0, a, b))
    text = _HARD[hard].format(**operands)
    if blends:
        text = f"{kind if kind == 'metaballs' else f'smooth_{kind}'}({a.distance}, {b.distance}, {number(k)})"
    if total:
        writer.add(f"{total} = {text};")
        return Written(total, material)
    return Written(writer.let("float", kind, text), material)


def _joined_material(kind: str, hard: str, k: float, a: Written, b: Written) -> str:
    operands = {"a": a.distance, "b": b.distance}
    first = _FIRST[hard].format(**operands)
    if not k:
        return f"chosen({first}, {a.material}, {b.material})"
    if kind == "metaballs":
        return f"of_metaballs({a.distance}, {b.distance}, {number(k)}, {a.material}, {b.material})"
    return f"blended({first}, {_GAP[hard].format(**operands)}, {number(k)}, {a.material}, {b.material})"


@writes("complement", "round", "shell", "displace", "extrude")
def _reshaped(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    place = at
    if node.kind == "extrude":
        point = writer.point(at)
        place = replace(at, point=writer.let("vec3", "p", f"vec3({point}.xy, 0.0)"), offset=(0.0, 0.0, 0.0))
    inner = yield node.children[0], place, material
    d = inner.distance
    if node.kind == "complement":
        text = f"-{d}"
    elif node.kind == "round":
        text = f"{d} - {number(node.parameters[0])}"
    elif node.kind == "shell":
        text = f"abs({d}) - {number(node.parameters[0])}"
    elif node.kind == "displace":
        text = f"{d} + ({writer.numbers(node.children[1:], writer.point(at))[0]})"
    else:
        text = f"extrusion({d}, {point}.z, {number(node.parameters[0])})"
    return Written(writer.let("float", node.kind, text), inner.material)
