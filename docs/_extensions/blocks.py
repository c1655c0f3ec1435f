"""Runs the code blocks of pages: code in, printed text and pictures out.

`examples.py` shows them in the site, `tests/test_docs.py` runs them without Sphinx. Blocks of one page share their
names, in the order of the page, as cells of a notebook do.
"""

import ast
import contextlib
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import octomarch as om

_BLOCK = re.compile(
    r"^(?P<fence>```+|:::+)\{(?P<kind>example|cards)\}(?P<argument>[^\n]*)\n"
    r"(?P<options>(?::[a-z-]+:[^\n]*\n)*)(?P<code>.*?)^(?P=fence)$",
    re.MULTILINE | re.DOTALL,
)
_CARD_SIZE = (440, 330)


@dataclass(frozen=True)
class Result:
    """What a block gave: what it printed, and pictures by caption."""

    printed: str
    pictures: list[tuple[str, om.Image]]


@dataclass(frozen=True)
class Card:
    """One line of a block of cards: an expression, its picture, and the comment behind it."""

    code: str
    caption: str
    image: om.Image


def names_of_page() -> dict[str, Any]:
    """Return the names that every page begins with."""
    return {"om": om, "np": np}


def run(code: str, names: dict[str, Any]) -> Result:
    """Run a block: what stands in its last line is shown, as in a notebook.

    That may be an image, a shape or scene (rendered by default), a dictionary of these by caption, or any other value,
    which is printed.
    """
    tree = ast.parse(code)
    last = tree.body[-1] if tree.body else None
    expression = ast.Expression(last.value) if isinstance(last, ast.Expr) else None
    statements = ast.Module(tree.body[:-1] if expression else tree.body, type_ignores=[])
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(statements, "<block>", "exec"), names)
        value = eval(compile(expression, "<block>", "eval"), names) if expression else None
    shown: dict[str, Any] = value if isinstance(value, dict) else {"": value}
    if all(isinstance(item, (om.Image, om.Shape, om.Scene)) for item in shown.values()):
        return Result(printed.getvalue(), [(caption, _image(item)) for caption, item in shown.items()])
    if value is not None:
        print(repr(value), file=printed)
    return Result(printed.getvalue(), [])


def cards(code: str, names: dict[str, Any], look: str = "") -> Iterator[Card]:
    """Run a block of cards: each line is an expression and, as a comment, its caption.

    `look` names a function of the page that makes a picture of a shape.
    """
    for line in filter(str.strip, code.splitlines()):
        expression, _, caption = line.partition("  # ")
        value = eval(expression, names)
        image = names[look](value) if look else _image(value, _CARD_SIZE)
        yield Card(expression.strip(), caption.strip(), image)


def run_page(text: str) -> int:
    """Run all blocks of a Markdown page and return how many there are."""
    names, found = names_of_page(), list(_BLOCK.finditer(text))
    for block in found:
        if block["kind"] == "cards":
            list(cards(block["code"], names, block["argument"].strip()))
        else:
            run(block["code"], names)
    return len(found)


def _image(value: om.Image | om.Shape | om.Scene, size: tuple[int, int] = (640, 480)) -> om.Image:
    return value if isinstance(value, om.Image) else om.render(value, size=size)
