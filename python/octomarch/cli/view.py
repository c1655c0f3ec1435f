"""``octomarch view``: a scene in the browser, from all sides."""

from __future__ import annotations

import argparse
import time
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

import octomarch as om
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, ScriptError, command
from octomarch.viewer.pictures import view_of
from octomarch.viewer.server import Server

_LOOK_AGAIN = 0.3  # seconds between looks at the file


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "view",
        _run,
        title="look at a scene in the browser, from all sides",
        description="""
            Dragging orbits, the wheel zooms, dragging with shift pans, a double click tells what a ray met; sliders
            change the march. A scene from a file is shown anew whenever the file is saved. The page is served to this
            machine alone, until Ctrl-C.""",
        examples=[
            "octomarch view blend",
            "octomarch view scene.py:make_scene --size 320x240 --samples 4",
            "octomarch view shot.json --no-browser --set march.pixel_tolerance=0.5",
        ],
    )
    common.add_scene(parser)
    parser.add_argument(
        "--size",
        type=common.size,
        metavar="WxH",
        help="width and height in pixels (default: the scene's, else 640x480)",
    )
    parser.add_argument("--samples", type=int, default=16, metavar="N", help="rays per pixel in the end (default: 16)")
    common.add_changes(parser)
    parser.add_argument("--port", type=int, default=0, metavar="N", help="of this machine (default: any that is free)")
    parser.add_argument("--no-browser", action="store_true", help="only tell the address of the page")


def _run(options: argparse.Namespace) -> None:
    samples, options.samples = options.samples, None
    if not 1 <= samples <= 64:
        raise ValueError(f"--samples must lie in [1, 64], got {samples}")
    if not 0 <= options.port < 2**16:
        raise ValueError(f"--port must lie in [0, 65535], got {options.port}")
    with Server(view_of(**_arguments(options)), samples, options.port) as server:
        print(f"{server.address} (Ctrl-C ends)", flush=True)
        if not options.no_browser:
            webbrowser.open(server.address)
        path = Path(options.scene.rpartition(":")[0] if ".py:" in options.scene else options.scene)
        _follow(path, lambda: _show(server, options))


def _arguments(options: argparse.Namespace) -> dict[str, Any]:
    """Return what `view_of` is to be called with."""
    found = common.request(options)
    size = found.get("size") or (640, 480)
    return {name: found.get(name) for name in ("scene", "camera", "march", "shading")} | {"size": size}


def _show(server: Server, options: argparse.Namespace) -> None:
    """Show what the file holds now, from where it is seen; tell what is wrong with it."""
    try:
        server.engine.change(scene=_arguments(options)["scene"])
        print("shown anew", flush=True)
    except (OSError, ValueError, TypeError, om.SceneError, ScriptError) as error:
        server.engine.fail(error)
        print(f"octomarch: {error}", flush=True)


def _follow(path: Path, show: Callable[[], None]) -> None:
    """Show a file anew whenever it has been saved, until Ctrl-C."""
    seen = _saved(path)
    try:
        while True:
            time.sleep(_LOOK_AGAIN)
            if (now := _saved(path)) not in (seen, None):
                seen = now
                show()
    except KeyboardInterrupt:
        print()


def _saved(path: Path) -> int | None:
    """Return when a file was saved; None where there is none."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return None
