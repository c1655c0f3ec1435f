"""How primitives are written: most are a call of a function of library.glsl. `writer` comes before it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeAlias

from octomarch import _core
from octomarch.glsl.library import number, vector
from octomarch.glsl.writer import LARGE, PLANES, Place, Steps, Writer, Written, writes

Text: TypeAlias = Callable[[list[float], Place], str]
"""Returns the distance of a primitive of some parameters at a place."""

_ACROSS = ("yxz", "xyz", "xzy")  # across, along and across an axis


def _sphere(p: list[float], at: Place) -> str:
    return f"sphere({at.text}, {number(p[0])})"


def _box(name: str) -> Text:
    return lambda p, at: f"{name}({at.text}, {vector(p)})"


def _plane(p: list[float], at: Place) -> str:
    shift = p[3] - math.fsum(n * o for n, o in zip(p, at.offset, strict=False))
    distance = f"dot({at.point}, {vector(p[:3])})"
    return distance if shift == 0 else f"{distance} {'+' if shift > 0 else '-'} {number(abs(shift))}"


def _cylinder(p: list[float], at: Place) -> str:
    return f"length({at.component(PLANES[int(p[1])])}) - {number(p[0])}"


def _of_revolution(name: str) -> Text:
    def text(p: list[float], at: Place) -> str:
        along = at.text if p[2] == 1 else at.component(_ACROSS[int(p[2])])
        return f"{name}({along}, {number(p[0])}, {number(p[1])})"

    return text


def _capsule(p: list[float], at: Place) -> str:
    return f"capsule({at.text}, {vector(p[:3])}, {vector(p[3:6])}, {number(p[6])})"


def _own(name: str) -> Text:
    return lambda p, at: f"{name}({', '.join([at.text, *map(number, p)])})"


def _rectangle(p: list[float], at: Place) -> str:
    return f"rectangle({at.component('xy')}, {vector(p)})"


_PRIMITIVES: dict[str, Text] = {
    "sphere": _sphere,
    "box": _box("box"),
    "box_exterior": _box("box_exterior"),
    "box_maximum": _box("box_maximum"),
    "plane": _plane,
    "cylinder": _cylinder,
    "capped_cylinder": _of_revolution("capped_cylinder"),
    "torus": _of_revolution("torus"),
    "capsule": _capsule,
    "capped_cone": _own("capped_cone"),
    "octahedron": _own("octahedron"),
    "pyramid": _own("pyramid"),
    "rectangle": _rectangle,
}


@writes(*_PRIMITIVES)
def _primitive(writer: Writer, node: _core.Node, at: Place, _: str) -> Steps:
    yield from ()
    return Written(writer.let("float", node.kind, _PRIMITIVES[node.kind](node.parameters, at)))


@writes("polygon")
def _polygon(writer: Writer, node: _core.Node, at: Place, _: str) -> Steps:
    yield from ()
    return Written(writer.let("float", "polygon", f"{writer.polygon(node)}({at.component('xy')})"))


@writes("field")
def _field(writer: Writer, node: _core.Node, at: Place, _: str) -> Steps:
    yield from ()
    lipschitz, lo, hi = node.parameters[0], node.parameters[1:4], node.parameters[4:7]
    point = writer.point(at)
    if not any(map(math.isfinite, (*lo, *hi))):
        return Written(writer.let("float", "field", writer.numbers(node.children, point)[0]))
    ends = [(a, b) if math.isfinite(a) else (-LARGE, LARGE) for a, b in zip(lo, hi, strict=True)]
    held = writer.let("vec3", "p", f"clamp({point}, {vector([a for a, _ in ends])}, {vector([b for _, b in ends])})")
    value = writer.numbers(node.children, held)[0]
    middle = [(a + b) / 2 for a, b in ends]
    bounds = f"box({Place(point).moved(middle).text}, {vector([(b - a) / 2 for a, b in ends])})"
    steepness = max(lipschitz, 1.0)
    cut = bounds if steepness == 1 else f"{number(steepness)} * {bounds}"
    return Written(writer.let("float", "field", f"max({cut}, {value})"))


@writes("solid")
def _solid(writer: Writer, node: _core.Node, at: Place, _: str) -> Steps:
    yield from ()
    condition = writer.numbers(node.children, writer.point(at))[0]
    return Written(writer.let("float", "solid", f"solid({condition})"))
