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
from pathlib import Path
from typing import Any

import numpy as np

import octomarch as om
from looks import contours, portrait

_BLOCK = re.compile(
    r"^(?P<fence>```+|:::+)\{(?P<kind>example|cards)\}(?P<argument>[^\n]*)\n"
    r"(?P<options>(?::[a-z-]+:[^\n]*\n)*)(?P<code>.*?)^(?P=fence)$",
    re.MULTILINE | re.DOTALL,
)


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
    return {"om": om, "np": np, "portrait": portrait, "contours": contours}


def run(code: str, names: dict[str, Any], page: str = "<block>", line: int = 0) -> Result:
    """Run a block: what stands in its last line is shown, as in a notebook.

    That may be an image, a shape or scene (rendered by default), a dictionary of these by caption, or any other value,
    which is printed. Errors point into `page`, where the block comes after `line`.
    """
    tree = ast.increment_lineno(ast.parse(code), line)
    last = tree.body[-1] if tree.body else None
    expression = ast.Expression(last.value) if isinstance(last, ast.Expr) else None
    statements = ast.Module(tree.body[:-1] if expression else tree.body, type_ignores=[])
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(statements, page, "exec"), names)
        value = eval(compile(expression, page, "eval"), names) if expression else None
    shown: dict[str, Any] = value if isinstance(value, dict) else {"": value}
    if all(isinstance(item, (om.Image, om.Shape, om.Scene)) for item in shown.values()):
        return Result(printed.getvalue(), [(caption, _image(item)) for caption, item in shown.items()])
    if value is not None:
        print(repr(value), file=printed)
    return Result(printed.getvalue(), [])


def cards(
    code: str, names: dict[str, Any], look: str = "portrait", page: str = "<block>", line: int = 0
) -> Iterator[Card]:
    """Run a block of cards: each line is an expression and, as a comment, its caption.

    `look` names the function that makes a picture of a shape, one of `looks.py` or of the page's own.
    """
    for number, text in enumerate(code.splitlines(), line):
        expression, _, caption = text.partition("  # ")
        if expression.strip():
            tree = ast.increment_lineno(ast.parse(expression, mode="eval"), number)
            value = eval(compile(tree, page, "eval"), names)
            image = names[look](value) if isinstance(value, om.Shape) else _image(value)
            yield Card(expression.strip(), caption.strip(), image)


def run_page(page: Path) -> int:
    """Run all blocks of a Markdown page and return how many there are."""
    text, names = page.read_text(), names_of_page()
    found = list(_BLOCK.finditer(text))
    for block in found:
        line = text.count("\n", 0, block.start("code"))
        if block["kind"] == "cards":
            list(cards(block["code"], names, block["argument"].strip() or "portrait", str(page), line))
        else:
            run(block["code"], names, str(page), line)
    return len(found)


def _image(value: om.Image | om.Shape | om.Scene) -> om.Image:
    return value if isinstance(value, om.Image) else om.render(value)
