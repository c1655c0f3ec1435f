"""Writes graphs of shapes as GLSL: a function of their distance, and one of what shows at a point of their surface.

Nodes are written one after the other, each as a variable named after its kind, children before their parents. What
stands in several places becomes a function, as does what a repeat looks at in more than one cell. Deep graphs need no
deep stack: methods that write a node are generators, which ask `Writer.run` for what stands below.

`expressions` comes before it. `primitives`, `operators` and `domain` enter how each kind of node is written into the
table `WRITE`; `shader` puts functions together.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from octomarch import _core
from octomarch.glsl.expressions import Images, Names, expressions
from octomarch.glsl.library import number, vector

MOST_NODES = 2048
"""Of shapes: more make a shader that takes minutes to compile, if it is compiled at all."""

LARGE = 3.0e38
"""In the place of infinity, where something is added."""
PLANES = ("yz", "xz", "xy")
"""Across an axis."""

_WORD = re.compile(r"[a-zA-Z_]\w*")
_ASSIGNED = re.compile(r"(?:\w+ )?(?P<name>\w+)(?:\.\w+)? [-/]?= ")
_WRAPPERS = ("translate", "paint")  # written again where they stand in several places, rather than called
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
            uses.update(shapes * (len(copies(node)) if node.kind == "repeat" else 1))
            if node.kind == "paint" or any(child in self._painted for child in shapes):
                self._painted.add(node)
        for node in reversed(self._order):
            if node.kind in _WRAPPERS and uses[node] > 1:
                uses[node.children[0]] += uses[node] - 1
        self._shared = [node for node in self._order if uses[node] > 1 and not _is_simple(node)]
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
        body = "".join(f"  {line}\n" for line in _used(self._lines, f"return {results[kind]};"))
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
        if node.kind not in WRITE:
            raise _core.SceneError(f"a shape of the kind {node.kind!r} cannot be part of a shader")
        return WRITE[node.kind](self, node, place, material)

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


def _used(lines: Sequence[str], end: str) -> list[str]:
    """Return the lines that the last one builds on, and that: materials may need no distances."""
    kept = [end]
    needed = set(_WORD.findall(end))
    for line in reversed(lines):
        assigned = _ASSIGNED.match(line)
        assert assigned is not None
        if assigned["name"] in needed:
            kept.append(line)
            needed.update(_WORD.findall(line))
    return kept[::-1]


def _material(slots: Sequence[str]) -> str:
    return f"Material(vec3({', '.join(slots[:3])}), {', '.join(slots[3:])})"


def copies(repeat: _core.Node) -> list[tuple[bool, ...]]:
    """Return, for each copy that a repeat looks at, on which axes it is the neighbour's."""
    symmetric = _core.mirror_symmetry(repeat.children[0])
    choices = [(False, True) if repeat.parameters[i] and not symmetric[i] else (False,) for i in range(3)]
    return list(itertools.product(*choices))


def _is_simple(node: _core.Node) -> bool:
    """Tell whether a node is written again where it stands in several places, rather than called."""
    return node.kind in _WRAPPERS or (not node.children and node.kind != "polygon")


Write: TypeAlias = Callable[[Writer, _core.Node, Place, str], Steps]
WRITE: dict[str, Write] = {}


def writes(*kinds: str) -> Callable[[Write], Write]:
    """Enter a function that writes nodes of some kinds.

    Examples
    --------
    >>> from octomarch.glsl import primitives
    >>> WRITE["sphere"] is WRITE["box"]
    True
    """

    def enter(write: Write) -> Write:
        WRITE.update(dict.fromkeys(kinds, write))
        return write

    return enter
