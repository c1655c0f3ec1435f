"""Shapes as GLSL: a function of their distance, and one of what shows at a point of their surface.

Nodes are written one after the other, each as a variable named after its kind, children before their parents. What
stands in several places becomes a function, as does what a repeat looks at in more than one cell. Deep graphs need no
deep stack: methods that write a node are generators, which ask `Writer.run` for what stands below.

`expressions` comes before it; `shader` puts functions together.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

from octomarch import _core
from octomarch.glsl.expressions import Images, Names, expressions
from octomarch.glsl.library import number, vector

MOST_NODES = 2048
"""Of shapes: more make a shader that takes minutes to compile, if it is compiled at all."""

_LARGE = 3.0e38  # in the place of infinity, where something is added
_SMALLEST_BLEND = 1.1754944e-38  # as in program/lower.cpp: below, a blend is none
_ACROSS = ("yxz", "xyz", "xzy")  # across, along and across an axis
_PLANES = ("yz", "xz", "xy")  # across an axis
_DEFAULT_MATERIAL = "Material(vec3(0.8), 0.5, 0.3, 0.0, 0.0)"


_POLYGON = """float {name}(vec2 p) {{
  const vec2 corners[{count}] = vec2[]({corners});
  float d = segment_distance(p, corners[{count} - 1], corners[0]);
  bool inside = crosses(p, corners[{count} - 1], corners[0]);
  for (int i = 1; i < {count}; i++) {{
    d = min(d, segment_distance(p, corners[i - 1], corners[i]));
    inside = inside != crosses(p, corners[i - 1], corners[i]);
  }}
  return inside ? -d : d;
}}"""


@dataclass(frozen=True)
class Place:
    """Where a node is written: its coordinates are those of a variable less an offset, which translations add up in."""

    point: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    normal: str | None = None

    def moved(self, by: Sequence[float]) -> Place:
        """Return the place after a translation.

        Examples
        --------
        >>> Place("p").moved((1, 0, 0)).moved((2, 0, 0)).text
        'p - vec3(3.0, 0.0, 0.0)'
        """
        x, y, z = (a + b for a, b in zip(self.offset, by, strict=True))
        return replace(self, offset=(x, y, z))

    @property
    def text(self) -> str:
        """The coordinates, as an argument."""
        return self.point if not any(self.offset) else f"{self.point} - {vector(self.offset)}"

    def component(self, letters: str) -> str:
        """Return some of the coordinates."""
        return f"{self.point}.{letters}" if not any(self.offset) else f"({self.text}).{letters}"


@dataclass(frozen=True)
class Written:
    """What a node has become: texts of its distance and, where that is asked for, of its material."""

    distance: str
    material: str = ""


Steps: TypeAlias = Generator["tuple[_core.Node, Place, str]", Written, Written]
"""Writes a node; asks for a node below, at a place and within the material of that name (none for a distance)."""


@dataclass
class Writer:
    """Writes the functions of a graph of shapes."""

    root: _core.Node
    names: Names = field(default_factory=Names)
    constants: list[str] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    images: Images = field(init=False)

    def __post_init__(self) -> None:
        self.images = Images(self.names)
        self._order = [node for node in _core.children_first([self.root]) if node.sort == "shape"]
        if len(self._order) > MOST_NODES:
            raise _core.SceneError(
                f"a shape of {len(self._order)} nodes cannot be made a shader: {MOST_NODES} are the most"
            )
        self._painted: set[_core.Node] = set()
        uses: Counter[_core.Node] = Counter()
        for node in self._order:
            shapes = [child for child in node.children if child.sort == "shape"]
            uses.update(shapes * (len(_copies(node)) if node.kind == "repeat" else 1))
            if node.kind == "paint" or any(child in self._painted for child in shapes):
                self._painted.add(node)
        for node in reversed(self._order):
            if node.kind in _WRAPPERS and uses[node] > 1:
                uses[node.children[0]] += uses[node] - 1
        self._shared = [node for node in self._order if uses[node] > 1 and node.kind not in _SIMPLE]
        self._calls: dict[tuple[_core.Node, bool], str] = {}
        self._lines: list[str] = []
        self._polygons: dict[_core.Node, str] = {}
        self._materials: dict[tuple[_core.Node, ...], str] = {}
        self.uses_normals = any(
            _core.uses_normal(slot) for node in self._painted if node.kind == "paint" for slot in node.children[1:]
        )

    def field(self, anchor: Sequence[float]) -> None:
        """Write ``float field(vec3 p)``, in which p counts from `anchor`."""
        for node in self._shared:
            name = self.names.fresh(f"{node.kind}_shape")
            self._function(f"float {name}(vec3 p)", node, Place("p"), "")
            self._calls[node, False] = name
        self._function("float field(vec3 p)", self.root, Place("p").moved([-a for a in anchor]), "")

    def surface(self, anchor: Sequence[float]) -> None:
        """Write ``Material surface(vec3 p, vec3 n)``, after `field`."""
        for node in self._shared:
            if node in self._painted:
                name = self.names.fresh(f"{node.kind}_part")
                self._function(f"Part {name}(vec3 p, vec3 n, Material outer)", node, Place("p", normal="n"), "outer")
                self._calls[node, True] = name
        place = Place("p", normal="n").moved([-a for a in anchor])
        self._function("Material surface(vec3 p, vec3 n)", self.root, place, _DEFAULT_MATERIAL)

    def _function(self, head: str, node: _core.Node, place: Place, material: str) -> None:
        self._lines = []
        result = self.run(node, place, material)
        kind = head.split()[0]
        results = {
            "float": result.distance,
            "Part": f"Part({result.distance}, {result.material})",
            "Material": f"within_ranges({result.material})",
        }
        body = "".join(f"  {line}\n" for line in [*self._lines, f"return {results[kind]};"])
        self.functions.append(f"{head} {{\n{body}}}")

    def run(self, node: _core.Node, place: Place, material: str) -> Written:
        """Write a node and all below it, with a stack of its own."""
        stack = [self._steps(node, place, material, is_root=True)]
        answer: Written | None = None
        while stack:
            try:
                wanted = stack[-1].send(answer) if answer is not None else next(stack[-1])
                answer = None
                stack.append(self._steps(*wanted))
            except StopIteration as ended:
                answer = ended.value
                stack.pop()
        assert answer is not None
        return answer

    def _steps(self, node: _core.Node, place: Place, material: str, is_root: bool = False) -> Steps:
        """Return what writes a node: below the root of a function those that are functions themselves are called."""
        if material and node not in self._painted:
            return self._of_one_material(node, place, material, is_root)
        function = self._calls.get((node, bool(material)))
        if function is not None and not is_root:
            return self._called(node, function, place, material)
        if node.kind not in _WRITE:
            raise _core.SceneError(f"a shape of the kind {node.kind!r} cannot be part of a shader")
        return _WRITE[node.kind](self, node, place, material)

    def _of_one_material(self, node: _core.Node, place: Place, material: str, is_root: bool) -> Steps:
        below = self._steps(node, place, "", is_root)
        answer: Written | None = None
        while True:
            try:
                wanted = below.send(answer) if answer is not None else next(below)
            except StopIteration as ended:
                return Written(ended.value.distance, material)
            answer = yield wanted

    def _called(self, node: _core.Node, function: str, place: Place, material: str) -> Steps:
        yield from ()
        if not material:
            return Written(self.let("float", node.kind, f"{function}({place.text})"))
        part = self.let("Part", node.kind, f"{function}({place.text}, {place.normal}, {material})")
        return Written(f"{part}.distance", f"{part}.material")

    def let(self, type_: str, kind: str, text: str) -> str:
        """Write a variable, and return its name."""
        name = self.names.fresh(kind)
        self._lines.append(f"{type_} {name} = {text};")
        return name

    def add(self, line: str) -> None:
        """Write a line."""
        self._lines.append(line)

    def point(self, place: Place) -> str:
        """Return the name of a variable that holds the coordinates of a place."""
        return place.point if not any(place.offset) else self.let("vec3", "p", place.text)

    def numbers(self, roots: Sequence[_core.Node], point: str, normal: str | None = None) -> list[str]:
        """Return expressions at a point."""
        return expressions(roots, point, normal, self._lines, self.names, self.images)

    def polygon(self, node: _core.Node) -> str:
        """Return the name of the function that is a polygon's distance."""
        if node not in self._polygons:
            name = self._polygons[node] = self.names.fresh("polygon_of")
            numbers = node.parameters
            corners = [vector(corner) for corner in zip(numbers[::2], numbers[1::2], strict=True)]
            self.functions.append(_POLYGON.format(name=name, count=len(corners), corners=", ".join(corners)))
        return self._polygons[node]

    def material(self, slots: Sequence[_core.Node], place: Place) -> str:
        """Return the name of a material: a constant of the shader where it is the same everywhere."""
        constants = [_core.constant_value(slot) for slot in slots]
        if all(value is not None for value in constants):
            key = tuple(slots)
            if key not in self._materials:
                self._materials[key] = self.names.fresh("material")
                numbers = [number(value) for value in constants if value is not None]
                self.constants.append(f"const Material {self._materials[key]} = {_material(numbers)};")
            return self._materials[key]
        looks = any(map(_core.uses_normal, slots))
        return self.let(
            "Material", "material", _material(self.numbers(slots, self.point(place), place.normal if looks else None))
        )


def _material(slots: Sequence[str]) -> str:
    return f"Material(vec3({', '.join(slots[:3])}), {', '.join(slots[3:])})"


def _copies(repeat: _core.Node) -> list[tuple[bool, bool, bool]]:
    """Return, for each copy that a repeat looks at, on which axes it is the neighbour's."""
    symmetric = _core.mirror_symmetry(repeat.children[0])
    copies = [(False, False, False)]
    for axis in range(3):
        if repeat.parameters[axis] and not symmetric[axis]:
            copies += [(*copy[:axis], True, *copy[axis + 1 :]) for copy in copies]  # type: ignore[misc]
    return copies


Write: TypeAlias = Callable[[Writer, _core.Node, Place, str], Steps]
_WRITE: dict[str, Write] = {}


def _writes(*kinds: str) -> Callable[[Write], Write]:
    def enter(write: Write) -> Write:
        _WRITE.update(dict.fromkeys(kinds, write))
        return write

    return enter


# Primitives ----------------------------------------------------------------------------------------------------------


def _sphere(p: list[float], at: Place) -> str:
    return f"sphere({at.text}, {number(p[0])})"


def _box(name: str) -> Callable[[list[float], Place], str]:
    return lambda p, at: f"{name}({at.text}, {vector(p)})"


def _plane(p: list[float], at: Place) -> str:
    shift = p[3] - math.fsum(n * o for n, o in zip(p, at.offset, strict=False))
    distance = f"dot({at.point}, {vector(p[:3])})"
    return distance if shift == 0 else f"{distance} {'+' if shift > 0 else '-'} {number(abs(shift))}"


def _cylinder(p: list[float], at: Place) -> str:
    return f"length({at.component(_PLANES[int(p[1])])}) - {number(p[0])}"


def _of_revolution(name: str) -> Callable[[list[float], Place], str]:
    def text(p: list[float], at: Place) -> str:
        along = at.text if p[2] == 1 else at.component(_ACROSS[int(p[2])])
        return f"{name}({along}, {number(p[0])}, {number(p[1])})"

    return text


def _capsule(p: list[float], at: Place) -> str:
    return f"capsule({at.text}, {vector(p[:3])}, {vector(p[3:6])}, {number(p[6])})"


def _own(name: str) -> Callable[[list[float], Place], str]:
    return lambda p, at: f"{name}({', '.join([at.text, *map(number, p)])})"


def _rectangle(p: list[float], at: Place) -> str:
    return f"rectangle({at.component('xy')}, {vector(p)})"


_PRIMITIVES: dict[str, Callable[[list[float], Place], str]] = {
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
_WRAPPERS = ("translate", "paint")
_SIMPLE = {*_PRIMITIVES, *_WRAPPERS}
"""What is written again rather than called."""


@_writes(*_PRIMITIVES)
def _primitive(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    yield from ()
    return Written(writer.let("float", node.kind, _PRIMITIVES[node.kind](node.parameters, at)))


@_writes("polygon")
def _polygon(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    yield from ()
    return Written(writer.let("float", "polygon", f"{writer.polygon(node)}({at.component('xy')})"))


@_writes("field")
def _field(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    yield from ()
    lipschitz, lo, hi = node.parameters[0], node.parameters[1:4], node.parameters[4:7]
    point = writer.point(at)
    if not any(map(math.isfinite, (*lo, *hi))):
        return Written(writer.let("float", "field", writer.numbers(node.children, point)[0]))
    ends = [(a, b) if math.isfinite(a) else (-_LARGE, _LARGE) for a, b in zip(lo, hi, strict=True)]
    held = writer.let("vec3", "p", f"clamp({point}, {vector([a for a, _ in ends])}, {vector([b for _, b in ends])})")
    value = writer.numbers(node.children, held)[0]
    middle = [(a + b) / 2 for a, b in ends]
    bounds = f"box({Place(point).moved(middle).text}, {vector([(b - a) / 2 for a, b in ends])})"
    steepness = max(lipschitz, 1.0)
    cut = bounds if steepness == 1 else f"{number(steepness)} * {bounds}"
    return Written(writer.let("float", "field", f"max({cut}, {value})"))


@_writes("solid")
def _solid(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    yield from ()
    condition = writer.numbers(node.children, writer.point(at))[0]
    return Written(writer.let("float", "solid", f"solid({condition})"))


# Operators over distances --------------------------------------------------------------------------------------------

_HARD = {"union": "min({a}, {b})", "intersection": "max({a}, {b})", "difference": "max({a}, -{b})"}
_FIRST = {"union": "{a} < {b}", "intersection": "{a} > {b}", "difference": "{a} > -{b}"}
_GAP = {"union": "{a} - {b}", "intersection": "{a} - {b}", "difference": "{a} + {b}"}


@_writes("union", "intersection", "difference", "metaballs")
def _combination(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    result = yield node.children[0], at, material
    total = ""
    for child in node.children[1:]:
        other = yield child, at, material
        result = _joined(writer, node.kind, node.parameters[0], result, other, total)
        total = result.distance
    return result


def _joined(writer: Writer, kind: str, k: float, a: Written, b: Written, total: str) -> Written:
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


@_writes("complement", "round", "shell", "displace", "extrude")
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


# Operators over points -----------------------------------------------------------------------------------------------


@_writes("translate")
def _translate(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    return (yield node.children[0], at.moved(node.parameters), material)


@_writes("paint")
def _paint(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    shape, *slots = node.children
    return (yield shape, at, writer.material(slots, at) if material else "")


@_writes("rotate")
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


@_writes("scale", "stretch")
def _scale(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    factors = node.parameters
    divisor = number(factors[0]) if len(factors) == 1 else vector(factors)
    moved = at.point if not any(at.offset) else f"({at.text})"
    normal = f"{at.normal}" if len(factors) == 1 else f"normalize({at.normal} * {divisor})"
    inner = yield node.children[0], _turned_frame(writer, at, f"{moved} / {divisor}", normal), material
    return Written(writer.let("float", node.kind, f"{number(min(factors))} * {inner.distance}"), inner.material)


@_writes("mirror")
def _mirror(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point, letter = writer.point(at), "xyz"[int(node.parameters[0])]
    components = [f"abs({point}.{each})" if each == letter else f"{point}.{each}" for each in "xyz"]
    sides = ["-1.0" if each == letter else "1.0" for each in "xyz"]
    normal = f"{point}.{letter} < 0.0 ? {at.normal} * vec3({', '.join(sides)}) : {at.normal}"
    return (yield node.children[0], _turned_frame(writer, at, f"vec3({', '.join(components)})", normal), material)


@_writes("elongate")
def _elongate(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point, ends = writer.point(at), vector(node.parameters)
    place = _turned_frame(writer, at, f"{point} - clamp({point}, -{ends}, {ends})", str(at.normal))
    return (yield node.children[0], place, material)


@_writes("repeat")
def _repeat(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    point = writer.point(at)
    copies = _copies(node)
    result: Written | None = None
    total = ""
    for copy in copies:
        components = [_in_cell(node, point, axis, copy[axis]) for axis in range(3)]
        place = _turned_frame(writer, at, f"vec3({', '.join(components)})", str(at.normal))
        other = yield node.children[0], place, material
        if result is None:
            result = other
            continue
        result = _joined(writer, "union", 0.0, result, other, total)
        total = result.distance
    assert result is not None
    return result


def _in_cell(node: _core.Node, point: str, axis: int, is_neighbour: bool) -> str:
    period, count = node.parameters[axis], node.parameters[3 + axis]
    coordinate = f"{point}.{'xyz'[axis]}"
    if not period:
        return coordinate
    shift = 0.5 if count % 2 or not count else 0.0
    limit = (count - 1) / 2 if count else _LARGE
    function = "repeated_beside" if is_neighbour else "repeated"
    return f"{function}({coordinate}, {number(period)}, {number(shift)}, {number(limit)})"


@_writes("twist", "bend")
def _twist(writer: Writer, node: _core.Node, at: Place, material: str) -> Steps:
    rate, radius = node.parameters[:2]
    axis = int(node.parameters[2]) if node.kind == "twist" else 2
    plane, along = _PLANES[axis], "xyz"[axis]
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
    plane, along, speed = _PLANES[axis], "xyz"[axis], number(rate)
    name = writer.let("vec3", "n", normal)
    writer.add(f"{name}.{plane} = turned({normal}.{plane}, {speed} * {parent}.{along});")
    first, second = plane
    moment = f"({name}.{second} * {child}.{first} - {name}.{first} * {child}.{second})"
    writer.add(f"{name}.{along} -= {speed} * {moment};")
    writer.add(f"{name} = normalize({name});")
    return name


def _unbent(writer: Writer, rate: float, axis: int, normal: str, parent: str, child: str) -> str:
    speed = number(rate)
    name = writer.let("vec3", "n", normal)
    writer.add(f"{name}.xy = turned({normal}.xy, {speed} * {parent}.x) - {speed} * {normal}.y * {child}.xy;")
    writer.add(f"{name}.xy /= 1.0 - {speed} * {parent}.y;")
    writer.add(f"{name} = normalize({name});")
    return name


@_writes("revolve")
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


def kinds() -> frozenset[str]:
    """Return the kinds of shapes that can be written.

    Examples
    --------
    >>> sorted(set(_core.node_kinds()) - kinds())[:3]
    ['abs', 'acos', 'add']
    """
    return frozenset(_WRITE)


__all__: list[Any] = ["MOST_NODES", "Place", "Writer", "Written", "kinds"]
