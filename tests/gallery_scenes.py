"""What the scripts of examples/gallery render, for tests that ask something else of the same scenes."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import octomarch as om
from octomarch.empty import expected

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "examples" / "gallery").glob("[0-9]*.py"))


class Rendered(NamedTuple):
    """Arguments of a call of `octomarch.render`."""

    scene: om.Scene
    camera: Any
    options: dict[str, Any]


def rendered(script: Path) -> Rendered:
    """Run a script, and return what it asked to be rendered last; its pictures are 4 × 3 pixels."""
    calls: list[Rendered] = []
    render = om.render

    def small(scene: om.Shape | om.Scene, camera: Any = None, size: Any = None, **options: Any) -> om.Image:
        del size  # of the script's picture
        calls.append(Rendered(scene if isinstance(scene, om.Scene) else om.Scene(scene), camera, options))
        with expected():
            return render(scene, camera, (4, 3), **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(om, "render", small)
        patch.setattr(om.Image, "save", lambda image, path: None)
        patch.setattr(sys, "argv", [str(script)])
        patch.syspath_prepend(str(script.parent))
        runpy.run_path(str(script), run_name="__main__")
    return calls[-1]
