"""``octomarch info``: the machine and the build, or what a scene is."""

from __future__ import annotations

import argparse
import json
import os
import platform
from typing import Any

import numpy as np

import octomarch as om
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.cli.subjects import find
from octomarch.machine import resolve_isa


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "info",
        _run,
        title="show instruction sets, threads, versions and build flags, or what a scene is",
        examples=["octomarch info", "octomarch info --json", "octomarch info shot.json"],
    )
    common.add_scene(parser, optional=True)
    parser.add_argument("--json", action="store_true", help="as JSON, for other programs")


def _run(options: argparse.Namespace) -> None:
    rows = _machine() if options.scene is None else _scene(find(options.scene).request())
    if options.json:
        print(json.dumps(rows, indent=2, default=str))
        return
    width = max(map(len, rows)) + 2
    for name, value in rows.items():
        print(f"{name:{width}}{', '.join(value) if isinstance(value, list) else value}")


def _machine() -> dict[str, Any]:
    pinned = os.environ.get("OCTOMARCH_ISA")
    rows = {
        "octomarch": om.__version__,
        "ISAs": om.isas(),
        "ISA used": resolve_isa() + (" (OCTOMARCH_ISA)" if pinned else ""),
        "threads": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "Python": platform.python_version(),
        "numpy": np.__version__,
        "platform": platform.platform(),
    }
    return rows | {f"build {key}": value for key, value in om.build_info().items() if key != "version"}


def _scene(request: dict[str, Any]) -> dict[str, Any]:
    """Return what a scene is, and the settings that come with it."""
    scene = request.pop("scene")
    program = om.compile(scene)
    rows = {
        "instructions": program.instructions,
        "Lipschitz bound": program.lipschitz,
        "bounds": [str(corner) for corner in program.bounds],
        "objects": len(program.objects),
        "materials": len(program.materials),
    }
    if isinstance(scene, om.Scene):
        rows |= {"lights": list(map(str, scene.lights)), "sky": str(scene.sky), "ambient": str(scene.ambient)}
    return rows | {name: str(value) for name, value in request.items()}
