"""How operators over points are written: where they look at their child, and how a normal turns on the way.

What a normal becomes is what program/placed_normal.cpp makes of it. `writer` comes before it, and `operators`, which
has the union of a repeat's copies.
"""

from __future__ import annotations

from octomarch import _core
from octomarch.glsl.library import number, vector
from octomarch.glsl.operators import joined
from octomarch.glsl.writer import LARGE, PLANES, Place, Steps, Writer, Written, copies, writes


@writes("translate")
def _translate(_: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    return (yield node.children[0], at.moved(node.parameters), material)


@writes("paint")
def _paint(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    shape, *slots = node.children
    return (yield shape, at, writer.material(slots, at) if material else "")


@writes("rotate")
def _rotate(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    columns = [node.parameters[column + 3 * row] for column in range(3) for row in range(3)]
    matrix = f"mat3({', '.join(map(number, columns))})"
    moved = at.point if not any(at.offset) else f"({at.text})"
    place = _turned_frame(writer, at, f"{moved} * {matrix}", f"{at.normal} * {matrix}")
    return (yield node.children[0], place, material)


def _turned_frame(writer: Writer, at: Place, point: str, normal: str) -> Place:
    """Return the place whose coordinates and normal are written anew."""
    name = writer.let("vec3", "p", point)
    turns = at.normal is not None and writer.uses_normals and normal != at.normal
    return Place(name, normal=writer.let("vec3", "n", normal) if turns else at.normal)


@writes("scale", "stretch")
def _scale(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    factors = node.parameters
    divisor = number(factors[0]) if len(factors) == 1 else vector(factors)
    moved = at.point if not any(at.offset) else f"({at.text})"
    normal = f"{at.normal}" if len(factors) == 1 else f"normalize({at.normal} * {divisor})"
    inner = yield node.children[0], _turned_frame(writer, at, f"{moved} / {divisor}", normal), material
    return Written(writer.let("float", node.kind, f"{number(min(factors))} * {inner.distance}"), inner.material)


@writes("mirror")
def _mirror(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point, letter = writer.point(at), "xyz"[int(node.parameters[0])]
    components = [f"abs({point}.{each})" if each == letter else f"{point}.{each}" for each in "xyz"]
    sides = ["-1.0" if each == letter else "1.0" for each in "xyz"]
    normal = f"{point}.{letter} < 0.0 ? {at.normal} * vec3({', '.join(sides)}) : {at.normal}"
    return (yield node.children[0], _turned_frame(writer, at, f"vec3({', '.join(components)})", normal), material)


@writes("elongate")
def _elongate(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point, ends = writer.point(at), vector(node.parameters)
    place = _turned_frame(writer, at, f"{point} - clamp({point}, -{ends}, {ends})", str(at.normal))
    return (yield node.children[0], place, material)


@writes("repeat")
def _repeat(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point = writer.point(at)
    result: Written | None = None
    total = ""
    for copy in copies(node):
        components = [_in_cell(node, point, axis, copy[axis]) for axis in range(3)]
        place = _turned_frame(writer, at, f"vec3({', '.join(components)})", str(at.normal))
        other = yield node.children[0], place, material
        if result is None:
            result = other
            continue
        result = joined(writer, "union", 0.0, result, other, total)
        total = result.distance
    assert result is not None
    return result


def _in_cell(node: _core.Node, point: str, axis: int, is_neighbour: bool) -> str:
    period, count = node.parameters[axis], node.parameters[3 + axis]
    coordinate = f"{point}.{'xyz'[axis]}"
    if not period:
        return coordinate
    shift = 0.5 if count % 2 or not count else 0.0
    limit = (count - 1) / 2 if count else LARGE
    function = "repeated_beside" if is_neighbour else "repeated"
    return f"{function}({coordinate}, {number(period)}, {number(shift)}, {number(limit)})"


@writes("twist", "bend")
def _twist(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    rate, radius = node.parameters[:2]
    axis = int(node.parameters[2]) if node.kind == "twist" else 2
    plane, along = PLANES[axis], "xyz"[axis]
    point = writer.point(at)
    drawn = writer.let("vec2", "q", f"drawn_in({point}.{plane}, {number(radius)})")
    angle = f"{number(rate)} * " + (f"{point}.{along}" if node.kind == "twist" else f"{drawn}.x")
    name = writer.let("vec3", "p", point)
    writer.add(f"{name}.{plane} = turned({drawn}, {angle});")
    normal = at.normal
    if normal is not None and writer.uses_normals:
        bent = _untwisted if node.kind == "twist" else _unbent
        normal = bent(writer, rate, axis, normal, point, name)
    inner = yield node.children[0], Place(name, normal=normal), material
    cut = f"length({point}.{plane}) - {number(radius)}"
    return Written(writer.let("float", node.kind, f"max({cut}, {inner.distance})"), inner.material)


def _untwisted(writer: Writer, rate: float, axis: int, normal: str, parent: str, child: str) -> str:
    plane, along, speed = PLANES[axis], "xyz"[axis], number(rate)
    name = writer.let("vec3", "n", normal)
    writer.add(f"{name}.{plane} = turned({normal}.{plane}, {speed} * {parent}.{along});")
    first, second = plane[0], plane[1]
    moment = f"({name}.{second} * {child}.{first} - {name}.{first} * {child}.{second})"
    writer.add(f"{name}.{along} -= {speed} * {moment};")
    writer.add(f"{name} = normalize({name});")
    return name


def _unbent(writer: Writer, rate: float, _: int, normal: str, parent: str, child: str) -> str:
    speed = number(rate)
    name = writer.let("vec3", "n", normal)
    writer.add(f"{name}.xy = turned({normal}.xy, {speed} * {parent}.x) - {speed} * {normal}.y * {child}.xy;")
    writer.add(f"{name}.xy /= 1.0 - {speed} * {parent}.y;")
    writer.add(f"{name} = normalize({name});")
    return name


@writes("revolve")
def _revolve(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point = writer.point(at)
    radius = writer.let("float", "radius", f"length({point}.xz)")
    outward = f"{point}.xz / max({radius}, 1e-30)"
    normal = str(at.normal)
    if at.normal is not None and writer.uses_normals:
        q = writer.let("vec2", "q", outward)
        normal = f"vec3(dot({at.normal}.xz, {q}), {at.normal}.y, {at.normal}.z * {q}.x - {at.normal}.x * {q}.y)"
    place = _turned_frame(writer, at, f"vec3({radius} - {number(node.parameters[0])}, {point}.y, 0.0)", normal)
    return (yield node.children[0], place, material)
