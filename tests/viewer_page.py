"""A viewer on a page of the browser, and what a hand does to it."""

from __future__ import annotations

import io
import math
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

import jupyter_lab


class ViewerPage:
    """A page with one viewer on it."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.canvas = page.locator(".octomarch-viewer canvas")
        self.panel = page.locator(".octomarch-viewer .panel")

    def number(self, name: str) -> str:
        return str(self.panel.locator(f"output[data-name={name}]").inner_text())

    def wait_for_last(self, after: int = 0) -> int:
        """Wait for a picture that is as fine as there is, after that many pictures; return how many there were."""
        self.page.wait_for_function(
            """after => {
                const seen = document.querySelector(".octomarch-viewer canvas")?.dataset;
                return seen && seen.last === "true" && Number(seen.frames) > after;
            }""",
            arg=after,
        )
        return self.frames()

    def box(self) -> dict[str, float]:
        """Return where the canvas is, once all of it is to be seen."""
        self.canvas.scroll_into_view_if_needed()
        return dict(self.canvas.bounding_box())

    def frames(self) -> int:
        return int(self.canvas.get_attribute("data-frames"))

    def shown(self) -> np.ndarray:
        """Return the pixels of the canvas."""
        box = self.box()
        return np.asarray(PIL.Image.open(io.BytesIO(self.page.screenshot(clip=box))).convert("RGB")).astype(int)

    def slide(self, name: str, share: float) -> None:
        """Move a slider to a share of its way, by the hand."""
        box = self.panel.locator(f"input[data-name={name}]").bounding_box()
        self.page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)

    def middle(self) -> tuple[float, float]:
        box = self.box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def drag(self, seconds: float = 0.0, key: str = "") -> float:
        """Move the hand over the picture and back, for that long or once; return pictures a second."""
        x, y = self.middle()
        if key:
            self.page.keyboard.down(key)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        begin, before, step = time.monotonic(), self.frames(), 0
        while step < 20 or time.monotonic() - begin < seconds:
            step += 1
            self.page.mouse.move(x + 90 * math.sin(step / 12), y + 30 * math.sin(step / 19))
        rate = (self.frames() - before) / (time.monotonic() - begin)
        self.page.mouse.up()
        if key:
            self.page.keyboard.up(key)
        return rate


@contextmanager
def in_jupyter_lab(cells: Sequence[str], complaints: list[str]) -> Iterator[ViewerPage]:
    """Open a notebook of these cells in JupyterLab, the first of which shows a viewer, and run that."""
    with tempfile.TemporaryDirectory() as folder, jupyter_lab.jupyter_lab(Path(folder)) as address:
        jupyter_lab.write_notebook(Path(folder, "viewer.ipynb"), *cells)
        with jupyter_lab.browser_page(complaints) as page:
            jupyter_lab.open_notebook(page, address, "viewer.ipynb")
            jupyter_lab.run_cell(page, 0)
            found = ViewerPage(page)
            found.wait_for_last()
            yield found
