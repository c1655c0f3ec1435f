"""The viewer in a real JupyterLab: it shows a picture, follows the hand, and its sliders change what rays cost.

One notebook serves all tests, in their order; what is measured is printed, and no test asks for a time.
`python tests/test_viewer_notebook.py docs/images/notebook.png` keeps a screenshot for the guide.
"""

import io
import math
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

pytest.importorskip("anywidget")
pytest.importorskip("jupyterlab")
pytest.importorskip("playwright")

import jupyter_lab

pytestmark = pytest.mark.skipif(jupyter_lab.BROWSER is None, reason="needs Debian's chromium")

SCENE = """import octomarch as om

blend = om.sphere(1.0).union(om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25)
blend = blend.paint(om.Material(color=(0.8, 0.1, 0.1), roughness=0.4))
scene = blend | om.cylinder(3.0, height=0.2).translate(0.4, -1.1, 0)
viewer = om.view(scene, om.Camera(eye=(3, 2, 4), target=(0, 0, 0)))
viewer"""
LOOK = "print('picked', viewer.picked.object, 'eye moved', viewer.camera.eye != (3, 2, 4), viewer.image.planes)"
CHANGE = "viewer.scene = om.gyroid(0.8, 0.1) & om.sphere(1.4); viewer.camera = None"
DRAGGED = 3.0
"""Seconds for which pictures are counted."""


class Notebook:
    """The notebook with the viewer on its page."""

    def __init__(self, page: Any, complaints: list[str]) -> None:
        self.page, self.complaints = page, complaints
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

    def frames(self) -> int:
        return int(self.canvas.get_attribute("data-frames"))

    def shown(self) -> np.ndarray:
        """Return the pixels of the canvas."""
        box = self.canvas.bounding_box()
        return np.asarray(PIL.Image.open(io.BytesIO(self.page.screenshot(clip=box))).convert("RGB")).astype(int)

    def slide(self, name: str, share: float) -> None:
        """Move a slider to a share of its way, by the hand."""
        box = self.panel.locator(f"input[data-name={name}]").bounding_box()
        self.page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)

    def middle(self) -> tuple[float, float]:
        box = self.canvas.bounding_box()
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
def opened() -> Iterator[Notebook]:
    """Open JupyterLab with the viewer, shown."""
    complaints: list[str] = []
    with tempfile.TemporaryDirectory() as folder, jupyter_lab.jupyter_lab(Path(folder)) as address:
        jupyter_lab.write_notebook(Path(folder, "viewer.ipynb"), SCENE, LOOK, CHANGE)
        with jupyter_lab.browser_page(complaints) as page:
            jupyter_lab.open_notebook(page, address, "viewer.ipynb")
            jupyter_lab.run_cell(page, 0)
            notebook = Notebook(page, complaints)
            notebook.wait_for_last()
            yield notebook


@pytest.fixture(scope="module")
def notebook() -> Iterator[Notebook]:
    with opened() as found:
        yield found


def test_a_picture_is_shown(notebook: Notebook):
    shown = notebook.shown()
    red = (shown[..., 0] > 1.5 * shown[..., 1]).mean()
    assert 0.05 < red < 0.6
    assert shown.std() > 20
    assert "16 rays a pixel" in notebook.number("picture")
    assert notebook.number("milliseconds") != "…"


def test_a_drag_turns_the_scene_many_times_a_second(notebook: Notebook):
    before, seen = notebook.shown(), notebook.frames()
    rate = notebook.drag(DRAGGED)
    print(f"\n{rate:.0f} pictures a second while the hand moves, {notebook.number('picture')}")
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 2


@pytest.mark.parametrize("way", ["pan", "zoom", "keys", "home"])
def test_the_hand_changes_the_view(notebook: Notebook, way: str):
    before, seen = notebook.shown(), notebook.frames()
    if way == "pan":
        notebook.drag(key="Shift")
    elif way == "zoom":
        notebook.page.mouse.move(*notebook.middle())
        notebook.page.mouse.wheel(0, -240)
    elif way == "keys":
        notebook.canvas.press("ArrowLeft")
    else:
        notebook.panel.get_by_text("home").click()
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 1


def test_a_double_click_picks(notebook: Notebook):
    notebook.page.mouse.dblclick(*notebook.middle())
    picked = notebook.page.locator(".octomarch-viewer .picked")
    picked.wait_for()
    text = picked.inner_text()
    for name in ("pixel", "status", "hit", "position", "normal", "object", "material", "steps"):
        assert name in text


def test_sliders_change_cost_and_error(notebook: Notebook):
    notebook.page.wait_for_function(
        "document.querySelector('.octomarch-viewer output[data-name=error]').innerText !== '…'"
    )
    cost, error = float(notebook.number("evaluations")), notebook.number("error")
    for name, share in {"max_steps": 0.15, "epsilon": 0.97, "pixel_tolerance": 0.97}.items():
        seen = notebook.frames()
        notebook.slide(name, share)
        seen = notebook.wait_for_last(seen)
        assert float(notebook.number("evaluations")) < cost
        assert notebook.number("error") != error
        if name == "max_steps":
            assert "step limit" in notebook.number("statuses")
        notebook.panel.get_by_text("defaults").click()
        notebook.wait_for_last(seen)
        assert float(notebook.number("evaluations")) == cost


@pytest.mark.parametrize("plane", ["depth", "normal", "steps", "status", "error", "color"])
def test_planes_are_shown(notebook: Notebook, plane: str):
    before, seen = notebook.shown(), notebook.frames()
    notebook.panel.locator("select").select_option(plane)
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 1
    assert notebook.page.locator(".octomarch-viewer .legend").is_visible() == (plane not in ("normal", "color"))


def test_python_sees_what_the_hand_did_and_changes_the_scene(notebook: Notebook):
    jupyter_lab.run_cell(notebook.page, 1)
    printed = "eye moved False ('color', 'depth', 'normal', 'steps', 'status')"
    notebook.page.get_by_text(printed).wait_for()
    before, seen = notebook.shown(), notebook.frames()
    jupyter_lab.run_cell(notebook.page, 2)
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 5


def test_the_console_has_no_errors(notebook: Notebook):
    assert notebook.complaints == []


def screenshot(path: Path) -> None:
    """Keep a picture of the viewer with something picked, as the guide shows it."""
    with opened() as notebook:
        notebook.page.get_by_text("No", exact=True).click()  # news of Jupyter
        x, y = notebook.middle()
        notebook.page.mouse.dblclick(x + 60, y - 20)
        notebook.page.locator(".octomarch-viewer .picked").wait_for()
        notebook.page.locator(".octomarch-viewer").screenshot(path=path)


if __name__ == "__main__":
    screenshot(Path(sys.argv[1]))
