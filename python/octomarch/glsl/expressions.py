"""Expressions as GLSL: one line of text for small ones, a line of their own for what is used more than once.

`library` comes before it; `writer` asks for fields and materials, `shader` for skies.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from octomarch import _core
from octomarch.glsl.library import number, vector

MOST_TEXELS = 4096
"""Of all images of a shader together: as many as graphics cards keep constants for."""
_LONGEST = 72  # characters of an expression that stands within another
_OPERATORS = {"add": ("+", 3), "subtract": ("-", 3), "multiply": ("*", 2), "divide": ("/", 2)}
_FUNCTIONS = {
    **{name: name for name in ("abs", "sqrt", "floor", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan")},
    "minimum": "min",
    "maximum": "max",
    "mod": "mod",
    "pow": "power",
    "atan2": "angle_of",
}
_COMPARISONS = {"less": "<", "less_equal": "<="}


@dataclass
class Names:
    """Gives names that are told apart by numbers: ``box1``, ``box2``."""

    counts: Counter[str] = field(default_factory=Counter)

    def fresh(self, kind: str) -> str:
        """Return a name that was not there before.

        Examples
        --------
        >>> names = Names()
        >>> names.fresh("box"), names.fresh("box"), names.fresh("ball")
        ('box1', 'box2', 'ball1')
        """
        self.counts[kind] += 1
        return f"{kind}{self.counts[kind]}"


@dataclass
class Images:
    """The pictures of a shader: each a function that looks texels up."""

    names: Names
    functions: dict[_core.Node, str] = field(default_factory=dict)
    sources: list[str] = field(default_factory=list)
    texels: int = 0

    def function(self, image: _core.Node) -> str:
        """Return the name of the function that gives the colour of an image at u, v.

        Raises
        ------
        SceneError
            If the images have more texels than a shader should hold.

        Examples
        --------
        >>> import numpy as np
        >>> Images(Names()).function(_core.image(np.zeros((2, 2, 3), np.float32)))
        'image1'
        """
        if image not in self.functions:
            self._count(image)
            name = self.names.fresh("image")
            self.sources.append(_lookup(name, image))
            self.functions[image] = name
        return self.functions[image]

    def _count(self, image: _core.Node) -> None:
        width, height = map(int, image.parameters)
        self.texels += width * height
        if self.texels > MOST_TEXELS:
            others = "" if self.texels == width * height else f" beside others of {self.texels - width * height}"
            raise _core.SceneError(
                f"an image of {width} × {height} texels{others} cannot be part of a shader: {MOST_TEXELS} are the most"
            )


def _lookup(name: str, image: _core.Node) -> str:
    width, height = map(int, image.parameters)
    assert image.texels is not None
    texels = ",\n  ".join(vector(texel) for texel in image.texels.reshape(-1, 3).tolist())
    return "\n".join(
        [
            f"// {width} × {height} texels, the upper row first",
            f"const vec3 {name}_texels[{width * height}] = vec3[](\n  {texels});",
            "",
            f"vec3 {name}_texel(ivec2 at) {{",
            f"  return {name}_texels[at.y * {width} + at.x];",
            "}",
            "",
            f"vec3 {name}(float u, float v, int wrap) {{",
            f"  vec2 size = {vector((width, height))};",
            "  vec2 at = vec2(u, 1.0 - v) * size - 0.5;",
            "  vec2 corner = floor(at);",
            "  ivec2 low = wrapped(corner, size, wrap);",
            "  ivec2 high = wrapped(corner + 1.0, size, wrap);",
            "  at -= corner;",
            f"  vec3 upper = mix({name}_texel(low), {name}_texel(ivec2(high.x, low.y)), at.x);",
            f"  vec3 lower = mix({name}_texel(ivec2(low.x, high.y)), {name}_texel(high), at.x);",
            "  return mix(upper, lower, at.y);",
            "}",
        ]
    )


def expressions(
    roots: Sequence[_core.Node], point: str, normal: str | None, lines: list[str], names: Names, images: Images
) -> list[str]:
    """Return expressions at a point as GLSL; `lines` gets those before them that they build on.

    Parameters
    ----------
    roots : sequence of nodes
        Of expressions.
    point, normal : str
        Names of vectors. A normal that is None may not be asked for.
    lines : list of str
        Of the function that is written.
    names, images
        Of the shader.

    Raises
    ------
    SceneError
        If an image is too large, or an operation is not known here.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> lines, names = [], Names()
    >>> expressions([om.length(x, y)._node], "p", None, lines, names, Images(names))
    ['sqrt(p.x * p.x + p.y * p.y)']
    """
    order = _core.children_first(list(roots))
    uses = Counter(child for node in order for child in node.children)
    uses.update(roots)
    written: dict[_core.Node, Text] = {}
    lookups: dict[tuple[object, ...], str] = {}
    for node in order:
        if node.kind == "image":
            continue
        if node.kind == "texel":
            text = _texel(node, written, lookups, lines, names, images)
        else:
            text = _text(node, [written[child] for child in node.children], point, normal)
        if node.children and (uses[node] > 1 or len(text.text) > _LONGEST) and node not in roots:
            name = names.fresh("e")
            lines.append(f"float {name} = {text.text};")
            text = Text(name)
        written[node] = text
    return [written[root].text for root in roots]


class Text(NamedTuple):
    """A piece of GLSL, and how loosely it holds together."""

    text: str
    looseness: int = 0
    """0: a name, a literal or a call; then signs, products, sums, and conditions."""

    def within(self, looseness: int) -> str:
        """Return the text, in brackets unless it holds together at least as well."""
        return self.text if self.looseness <= looseness else f"({self.text})"


def _text(node: _core.Node, operands: list[Text], point: str, normal: str | None) -> Text:
    kind = node.kind
    if kind == "constant":
        text = number(node.parameters[0])
        return Text(text, 1 if text.startswith("-") else 0)
    if kind == "coordinate":
        return Text(_coordinate(int(node.parameters[0]), point, normal))
    if kind == "negate":
        return Text(f"-{operands[0].within(0)}", 1)
    if kind in _OPERATORS:
        sign, looseness = _OPERATORS[kind]
        return Text(f"{operands[0].within(looseness)} {sign} {operands[1].within(looseness - 1)}", looseness)
    arguments = ", ".join(operand.text for operand in operands)
    if kind in _FUNCTIONS:
        return Text(f"{_FUNCTIONS[kind]}({arguments})")
    if kind in _COMPARISONS:
        return Text(f"float({operands[0].within(3)} {_COMPARISONS[kind]} {operands[1].within(3)})")
    if kind == "where":
        condition, first, second = (operand.within(3) for operand in operands)
        return Text(f"{condition} != 0.0 ? {first} : {second}", 4)
    if kind == "noise":
        return Text(f"gradient_noise({arguments}, {number(node.parameters[0])})")
    raise _core.SceneError(f"an expression of the kind {kind!r} cannot be part of a shader")


def _coordinate(index: int, point: str, normal: str | None) -> str:
    if index < 3:
        return f"{point}.{'xyz'[index]}"
    if normal is None:
        raise _core.SceneError("normals are asked for where there is no surface")
    return f"{normal}.{'xyz'[index - 3]}"


def _texel(
    node: _core.Node,
    written: dict[_core.Node, Text],
    lookups: dict[tuple[object, ...], str],
    lines: list[str],
    names: Names,
    images: Images,
) -> Text:
    """Return a channel of a lookup; the three channels share one."""
    channel, wrap = map(int, node.parameters)
    image, u, v = node.children
    key = (image, u, v, wrap)
    if key not in lookups:
        lookups[key] = names.fresh("texel")
        lines.append(f"vec3 {lookups[key]} = {images.function(image)}({written[u].text}, {written[v].text}, {wrap});")
    return Text(f"{lookups[key]}.{'rgb'[channel]}")
