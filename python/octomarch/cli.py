"""The command ``octomarch``: demo, info and listing."""

from __future__ import annotations

import argparse
import os
import platform
import runpy
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import octomarch as om
from octomarch.demo import DEMOS
from octomarch.machine import resolve_isa


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status: 0, 1 on an error that it has told, 130 when interrupted.

    Examples
    --------
    >>> main(["listing", "no-such-scene"])
    1
    """
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except (OSError, ValueError, TypeError, om.SceneError) as error:
        print(f"octomarch: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("octomarch: interrupted", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="octomarch", description="A SIMD ray marcher for signed distance fields.")
    parser.add_argument("--version", action="version", version=f"octomarch {om.__version__}")
    commands = parser.add_subparsers(required=True, metavar="command")

    demo = commands.add_parser("demo", help="render the demo scenes to EXR and PNG")
    demo.add_argument("-o", "--output", type=Path, default=Path(), metavar="DIR", help="folder (default: this one)")
    demo.add_argument("--size", type=_size, default=(960, 540), metavar="WxH", help="in pixels (default: 960x540)")
    demo.add_argument("--threads", type=int, metavar="N", help="threads at the most (default: all cores)")
    demo.add_argument("--isa", help=f"instruction set, of {', '.join(om.isas())} (default: the best)")
    demo.set_defaults(run=_demo)

    info = commands.add_parser("info", help="show instruction sets, threads, versions and build flags")
    info.set_defaults(run=_info)

    listing = commands.add_parser("listing", help="show the compiled program of a scene")
    listing.add_argument(
        "scene",
        metavar="SCENE",
        help=f"{' or '.join(DEMOS)}; or a Python file FILE.py[:NAME], run to take NAME (default: scene, else shape)",
    )
    listing.set_defaults(run=_listing)
    return parser


def _size(text: str) -> tuple[int, int]:
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"size must look like 640x480, got {text!r}")
    return int(width), int(height)


def _demo(options: argparse.Namespace) -> None:
    options.output.mkdir(parents=True, exist_ok=True)
    for name, make in DEMOS.items():
        demo = make()
        image = om.render(
            demo.scene,
            demo.camera,
            options.size,
            march=demo.march,
            planes=("color", "depth", "position", "normal", "object_id", "material_id", "steps", "status"),
            threads=options.threads,
            isa=options.isa,
            progress=sys.stderr.isatty(),
        )
        paths = [options.output / f"{name}{suffix}" for suffix in (".exr", ".png")]
        for path in paths:
            image.save(path)
        print(f"{name}: {', '.join(map(str, paths))}")
        print(f"  {_summary(image)}")


def _summary(image: om.Image) -> str:
    stats = image.stats
    rays, threads = stats["rays"] + stats["shadow_rays"], stats["threads"]
    kinds = ("primary", "shadow", "occlusion", "gradient")
    evaluations = sum(stats[f"{kind}_evaluations"] for kind in kinds) / stats["rays"]
    parts = [
        f"{image.size[0]}x{image.size[1]}",
        stats["isa"],
        f"{threads} thread{'s' if threads > 1 else ''}",
        f"{stats['seconds']:.3f} s",
        f"{rays / max(stats['seconds'], 1e-9) / 1e6:.1f} Mrays/s",
        f"{stats['primary_evaluations'] / stats['rays']:.1f} evaluations per primary ray",
        f"{evaluations:.1f} per pixel with shading",
    ]
    return ", ".join(parts)


def _info(_: argparse.Namespace) -> None:
    pinned = os.environ.get("OCTOMARCH_ISA")
    rows = {
        "octomarch": om.__version__,
        "ISAs": ", ".join(om.isas()),
        "ISA used": resolve_isa() + (" (OCTOMARCH_ISA)" if pinned else ""),
        "threads": str(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()),
        "Python": platform.python_version(),
        "numpy": np.__version__,
        "platform": platform.platform(),
    }
    rows |= {f"build {key}": value for key, value in om.build_info().items() if key != "version"}
    width = max(map(len, rows)) + 2
    for name, value in rows.items():
        print(f"{name:{width}}{value}")


def _listing(options: argparse.Namespace) -> None:
    print(om.compile(_scene(options.scene)))


def _scene(text: str) -> om.Shape | om.Scene:
    """Return the demo scene of that name, or what a Python file defines."""
    if text in DEMOS:
        return DEMOS[text]().scene
    path, _, name = text.partition(":")
    if not path.endswith(".py"):
        raise ValueError(f"scene must be {' or '.join(DEMOS)} or FILE.py[:NAME], got {text!r}")
    defined = runpy.run_path(path, run_name="octomarch_scene")
    for candidate in [name] if name else ["scene", "shape"]:
        if isinstance(value := defined.get(candidate), (om.Shape, om.Scene)):
            return value
    raise ValueError(f"{path} defines no shape or scene named {name or 'scene or shape'}")
