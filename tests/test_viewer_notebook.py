"""The viewer in a real JupyterLab: it shows a picture, follows the hand, and its sliders change what rays cost.

One notebook serves all tests, in their order; what is measured is printed, and no test asks for a time.
`python tests/test_viewer_notebook.py docs/images/notebook.png` keeps a screenshot for the guide.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anywidget")
pytest.importorskip("jupyterlab")
pytest.importorskip("playwright")

import jupyter_lab
from viewer_page import ViewerPage, in_jupyter_lab

pytestmark = pytest.mark.skipif(jupyter_lab.BROWSER is None, reason="needs Debian's chromium")

SCENE = """import octomarch as om

blend = om.sphere(1.0).union(om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25)
blend = blend.paint(om.Material(color=(0.8, 0.1, 0.1), roughness=0.4))
scene = blend | om.cylinder(3.0, height=0.2).translate(0.4, -1.1, 0)
viewer = om.view(scene, om.Camera(eye=(3, 2, 4), target=(0, 0, 0)))
viewer"""
LOOK = "print('picked', viewer.picked.object, 'eye moved', viewer.camera.eye != (3, 2, 4), viewer.image.planes)"
WAIT = """import time

camera, end = viewer.camera, time.monotonic() + 30
while viewer.camera == camera and time.monotonic() < end:
    time.sleep(0.05)
print("moved", "meanwhile" if viewer.camera != camera else "never")"""
CHANGE = "viewer.scene = om.gyroid(0.8, 0.1) & om.sphere(1.4); viewer.camera = None"
DRAGGED = 3.0
"""Seconds for which pictures are counted."""


COMPLAINTS: list[str] = []
"""What the page has complained about."""


@pytest.fixture(scope="module")
def notebook() -> Iterator[ViewerPage]:
    with in_jupyter_lab((SCENE, LOOK, WAIT, CHANGE), COMPLAINTS) as found:
        yield found


def test_a_picture_is_shown(notebook: ViewerPage):
    shown = notebook.shown()
    red = (shown[..., 0] > 1.5 * shown[..., 1]).mean()
    assert 0.05 < red < 0.6
    assert shown.std() > 20
    assert "16 rays a pixel" in notebook.number("picture")
    assert notebook.number("milliseconds") != "…"


def test_a_drag_turns_the_scene_many_times_a_second(notebook: ViewerPage):
    before, seen = notebook.shown(), notebook.frames()
    rate = notebook.drag(DRAGGED)
    print(f"\n{rate:.0f} pictures a second while the hand moves, {notebook.number('picture')}")
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 2


@pytest.mark.parametrize("way", ["pan", "zoom", "keys", "home"])
def test_the_hand_changes_the_view(notebook: ViewerPage, way: str):
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


def test_a_double_click_picks(notebook: ViewerPage):
    notebook.page.mouse.dblclick(*notebook.middle())
    picked = notebook.page.locator(".octomarch-viewer .picked")
    picked.wait_for()
    text = picked.inner_text()
    for name in ("pixel", "status", "hit", "position", "normal", "object", "material", "steps"):
        assert name in text


def test_sliders_change_cost_and_error(notebook: ViewerPage):
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
        assert notebook.panel.get_by_text("(default)").count() == 3


@pytest.mark.parametrize("plane", ["depth", "normal", "steps", "status", "error", "color"])
def test_planes_are_shown(notebook: ViewerPage, plane: str):
    before, seen = notebook.shown(), notebook.frames()
    notebook.panel.locator("select").select_option(plane)
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 1
    assert notebook.page.locator(".octomarch-viewer .legend").is_visible() == (plane not in ("normal", "color"))


def test_python_sees_what_the_hand_did_and_changes_the_scene(notebook: ViewerPage):
    jupyter_lab.run_cell(notebook.page, 1)
    printed = "eye moved False ('color', 'depth', 'normal', 'steps', 'status')"
    notebook.page.get_by_text(printed).wait_for()
    before, seen = notebook.shown(), notebook.frames()
    jupyter_lab.run_cell(notebook.page, 3)
    notebook.wait_for_last(seen)
    assert np.abs(notebook.shown() - before).mean() > 5


def test_the_viewer_follows_while_a_cell_runs(notebook: ViewerPage):
    seen = notebook.frames()
    jupyter_lab.run_cell(notebook.page, 2)
    notebook.page.get_by_text("(ipykernel) | Busy").wait_for()
    notebook.drag()
    notebook.page.get_by_text("moved meanwhile").wait_for()
    assert notebook.frames() > seen


@pytest.mark.usefixtures("notebook")
def test_the_console_has_no_errors():
    assert COMPLAINTS == []


def screenshot(path: Path) -> None:
    """Keep a picture of the viewer with something picked, as the guide shows it."""
    with in_jupyter_lab((SCENE,), []) as notebook:
        notebook.page.get_by_text("No", exact=True).click()  # news of Jupyter
        x, y = notebook.middle()
        notebook.page.mouse.dblclick(x + 60, y - 20)
        notebook.page.locator(".octomarch-viewer .picked").wait_for()
        notebook.page.locator(".octomarch-viewer").screenshot(path=path)


if __name__ == "__main__":
    screenshot(Path(sys.argv[1]))
