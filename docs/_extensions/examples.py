"""Two directives for pages, so that code and picture never disagree.

``example`` runs a block of code and shows below it what it printed and the picture it ends with; ``cards`` shows a
picture of each line's expression, side by side. `blocks.py` runs the code. Large pictures are shown at half
their size, which smooths their edges.
"""

import contextlib
import os
import shutil
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import blocks
import octomarch as om

_HALVED_FROM = 400  # pixels of width: what is smaller is shown as large as it is


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_directive("example", Example)
    app.add_directive("cards", Cards)
    return {"parallel_read_safe": True}


class Block(SphinxDirective):
    """What both directives share: the names of the page, and pictures as files."""

    has_content = True

    @property
    def names(self) -> dict[str, Any]:
        """The names that earlier blocks of the page have defined."""
        return cast(dict[str, Any], self.env.temp_data.setdefault("octomarch_names", blocks.names_of_page()))

    @contextlib.contextmanager
    def running(self) -> Iterator[tuple[str, int]]:
        """Run the block in a folder of its page, for files it saves; gives the page and the line before the code."""
        files = Path(self.env.doctreedir) / "files" / self.env.docname
        if "octomarch_names" not in self.env.temp_data:  # the page begins, as if it had never been made
            shutil.rmtree(files, ignore_errors=True)
        files.mkdir(parents=True, exist_ok=True)
        try:
            with contextlib.chdir(files):
                yield str(self.env.doc2path(self.env.docname)), self.content_offset
        except Exception:
            raise self.error(f"the block does not run:\n{traceback.format_exc(limit=-3)}") from None

    def image(self, image: om.Image, alt: str) -> nodes.image:
        """Return the node that shows a picture; its file lies among the doctrees, where it is as old as they are."""
        folder = Path(self.env.doctreedir) / "pictures"
        folder.mkdir(parents=True, exist_ok=True)
        number = self.env.new_serialno("octomarch_picture")
        path = folder / f"{self.env.docname.replace('/', '-')}-{number}.png"
        path.write_bytes(image.to_png_bytes())
        uri = "/" + Path(os.path.relpath(path, self.env.srcdir)).as_posix()
        width = image.size[0]
        return nodes.image(uri=uri, alt=alt, width=f"{width // 2 if width >= _HALVED_FROM else width}px")


class Example(Block):
    """Code, what it printed, and its picture."""

    option_spec = {"alt": directives.unchanged, "hide-code": directives.flag}  # noqa: RUF012

    def run(self) -> list[nodes.Node]:
        """Run the block and return what to show."""
        code = "\n".join(self.content)
        with self.running() as where:
            result = blocks.run(code, self.names, *where)
        shown = nodes.container(classes=["example"])
        if "hide-code" not in self.options:
            shown += self.literal(code, "python")
        if result.printed:
            shown += self.literal(result.printed.rstrip(), "text", ["printed"])
        if len(result.pictures) == 1:
            shown += self.image(result.pictures[0][1], self.options.get("alt", ""))
        elif result.pictures:
            grid = grid_of([picture for _, picture in result.pictures])
            for caption, picture in result.pictures:
                grid += card(self.image(picture, caption), nodes.paragraph("", caption, classes=["caption"]))
            shown += grid
        return [shown]

    def literal(self, text: str, language: str, classes: list[str] | None = None) -> nodes.literal_block:
        """Return a literal block."""
        block = nodes.literal_block(text, text, language=language, classes=classes or [])
        self.set_source_info(block)
        return block


class Cards(Block):
    """A grid of pictures, each with the expression that it shows; the argument names the look if not a portrait."""

    optional_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Run all lines and return the grid."""
        look = self.arguments[0] if self.arguments else "portrait"
        with self.running() as where:
            found = list(blocks.cards("\n".join(self.content), self.names, look, *where))
        grid = grid_of([each.image for each in found])
        for each in found:
            code = nodes.literal_block(each.code, each.code, language="python")
            text, _ = self.state.inline_text(each.caption, self.lineno)
            caption = nodes.paragraph("", "", *text, classes=["caption"])
            grid += card(self.image(each.image, each.code), code, caption)
        return [grid]


def grid_of(images: list[om.Image]) -> nodes.container:
    """Return an empty grid for cards with these pictures: in threes, or in pairs where they are wide, two or four."""
    wide = any(image.size[0] > 1.6 * image.size[1] for image in images)
    return nodes.container(classes=["cards", "pairs"] if wide or len(images) in (2, 4) else ["cards"])


def card(*children: nodes.Node) -> nodes.container:
    """Return one card of a grid."""
    return nodes.container("", *children, classes=["card"])
