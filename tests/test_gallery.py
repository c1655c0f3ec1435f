"""Every picture of the gallery, small, against the one that is stored in tests/data/gallery.

``python tests/test_gallery.py`` stores them anew, after a change that is meant to change them: look at them all then.
"""

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import octomarch as om

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "examples" / "gallery").glob("[0-9]*.py"))
STORED = ROOT / "tests" / "data" / "gallery"

REDUCED = 16
"""A picture of 640 × 480 is compared at 40 × 30."""

COLOR_TOLERANCE = 2e-3
"""Of a linear colour. The library that computes a camera's and a turn's sines may differ from machine to machine by an
ulp; that moves hits by a few hit epsilons, and what is shaded by as much."""

PIXELS_ASTRAY = 0.01
"""Share of pixels that may differ by more: those where a ray passes within a hit epsilon of an edge."""

STATUSES_ASTRAY = 3
"""Pixels by which the number of each status may differ, for the same reason."""


def small_picture(script: Path, monkeypatch: pytest.MonkeyPatch) -> om.Image:
    """Run a script with fewer pixels; return the colours that it would save, and the statuses of its rays."""
    render, rendered, saved = om.render, [], []

    def small(scene: Any, camera: Any = None, size: tuple[int, int] = (640, 480), **options: Any) -> om.Image:
        planes = options.pop("planes", "color")
        names = (planes,) if isinstance(planes, str) else tuple(planes)
        reduced = (size[0] // REDUCED, size[1] // REDUCED)
        rendered.append(render(scene, camera, reduced, planes=(*names, "status"), **options))
        return rendered[-1]

    monkeypatch.setattr(om, "render", small)
    monkeypatch.setattr(om.Image, "save", lambda image, path: saved.append(image))
    monkeypatch.setattr(sys, "argv", [str(script)])
    monkeypatch.syspath_prepend(str(script.parent))
    runpy.run_path(str(script), run_name="__main__")
    return om.Image({"color": saved[-1].color.astype(np.float32), "status": rendered[-1].status})


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_picture_is_the_stored_one(script: Path, monkeypatch: pytest.MonkeyPatch):
    picture = small_picture(script, monkeypatch)
    stored = om.read_exr(STORED / f"{script.stem}.exr")
    counts, stored_counts = (np.bincount(image.status.ravel(), minlength=5) for image in (picture, stored))
    assert np.abs(counts - stored_counts).max() <= STATUSES_ASTRAY
    astray = (np.abs(picture.color - stored.color) > COLOR_TOLERANCE).any(axis=-1)
    assert astray.mean() <= PIXELS_ASTRAY


def test_no_picture_is_stored_that_nobody_renders():
    assert {path.stem for path in STORED.glob("*.exr")} == {script.stem for script in SCRIPTS}


if __name__ == "__main__":
    STORED.mkdir(parents=True, exist_ok=True)
    for script in SCRIPTS:
        with pytest.MonkeyPatch.context() as patch:
            picture = small_picture(script, patch)
        om.write_exr(STORED / f"{script.stem}.exr", picture)
