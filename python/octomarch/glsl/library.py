"""The functions that shaders are put together from, and how numbers are written in GLSL. Comes before the others."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterable, Sequence
from importlib import resources

import numpy as np

_NAME = re.compile(r"[a-zA-Z_]\w*")
_DEFINED = re.compile(r"^(?:struct\s+(?P<struct>\w+)|\w+\s+(?P<function>\w+)\()", re.MULTILINE)
_LARGEST = float(np.finfo(np.float32).max)


def number(value: float) -> str:
    """Return a number as a GLSL literal: the nearest float32 in as few digits as tell it from others.

    Examples
    --------
    >>> number(0.1), number(2), number(-1e-9)
    ('0.1', '2.0', '-1e-09')
    >>> number(math.inf)
    'infinity()'
    """
    if math.isinf(value) or abs(value) > _LARGEST:
        return "infinity()" if value > 0 else "-infinity()"
    text = str(np.float32(value))
    return text if "." in text or "e" in text else f"{text}.0"


def vector(values: Sequence[float]) -> str:
    """Return two or three numbers as a GLSL vector.

    Examples
    --------
    >>> vector((1, 2.5, 0)), vector((2, 2))
    ('vec3(1.0, 2.5, 0.0)', 'vec2(2.0)')
    """
    numbers = [number(value) for value in values]
    if len(set(numbers)) == 1:
        numbers = numbers[:1]
    return f"vec{len(values)}({', '.join(numbers)})"


@functools.cache
def blocks(library: str) -> dict[str, str]:
    """Return functions and structures of a library by name, in their order.

    Examples
    --------
    >>> print(blocks("library")["sphere"])
    float sphere(vec3 p, float radius) {
      return length(p) - radius;
    }
    """
    text = resources.files("octomarch.glsl").joinpath(f"{library}.glsl").read_text(encoding="utf-8")
    found = {}
    for block in text.strip().split("\n\n"):
        defined = _DEFINED.search(block)
        if defined:
            found[defined["struct"] or defined["function"]] = block
    return found


def needed(library: str, sources: Iterable[str]) -> list[str]:
    """Return the blocks of a library that sources speak of, and those that these need, in its order.

    Examples
    --------
    >>> [block.split("(")[0] for block in needed("library", ["smooth_union(a, b, 0.1);"])]
    ['float overlap', 'float smooth_union']
    """
    known = blocks(library)
    wanted: set[str] = set()
    left = [name for source in sources for name in _NAME.findall(source)]
    while left:
        name = left.pop()
        if name in known and name not in wanted:
            wanted.add(name)
            left += _NAME.findall(known[name])
    return [block for name, block in known.items() if name in wanted]
