"""The command ``octomarch``: demo, info, listing, render and study."""

from __future__ import annotations

import argparse
import dataclasses
import os
import platform
import runpy
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import octomarch as om
from octomarch.demo import DEMOS
from octomarch.exr import read_document
from octomarch.machine import resolve_isa
from octomarch.planes import PLANES
from octomarch.scenefile import read
from octomarch.study.settings import GROUPS
from octomarch.study.truth import TRUTH_KINDS

_LARGE = 2**24  # pixels: above that a picture goes band by band into its file, and an interrupted one goes on
_NAMES = ("shot", "scene", "shape")  # looked for in Python files


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
    _add_execution(demo)
    demo.set_defaults(run=_demo)

    render = commands.add_parser("render", help="render a scene to EXR or PNG")
    _add_scene(render)
    render.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help="file, .exr or .png")
    render.add_argument("--size", type=_size, metavar="WxH", help="in pixels (default: the scene's, else 640x480)")
    render.add_argument("--samples", type=int, metavar="N", help="rays per pixel (default: the scene's, else 1)")
    render.add_argument(
        "--planes",
        type=_planes,
        metavar="NAMES",
        help=f"all, or of {','.join(PLANES)} (default: the scene's, else color)",
    )
    _add_execution(render)
    render.set_defaults(run=_render)

    study = commands.add_parser(
        "study", help="measure what settings cost in a scene, and how far each is from the truth"
    )
    _add_scene(study)
    study.add_argument(
        "-o", "--output", type=Path, default=Path("study.html"), metavar="OUT", help="report (default: study.html)"
    )
    study.add_argument("--size", type=_size, default=(160, 120), metavar="WxH", help="in pixels (default: 160x120)")
    study.add_argument(
        "--groups", type=_names, default=GROUPS, metavar="NAMES", help=f"of {','.join(GROUPS)} (default: all)"
    )
    study.add_argument("--truth", default="auto", choices=TRUTH_KINDS, help="how much of it to prove (default: auto)")
    study.add_argument(
        "--far", type=float, metavar="T", help="far limit of the series (default: past all that is bounded)"
    )
    study.add_argument("--rounds", type=int, default=3, metavar="N", help="how often pictures are timed (default: 3)")
    study.add_argument(
        "--resume", type=Path, metavar="FILE", help="keeps what is measured, to go on after Ctrl-C (default: OUT.json)"
    )
    _add_execution(study)
    study.set_defaults(run=_study)

    info = commands.add_parser("info", help="show instruction sets, threads, versions and build flags")
    info.set_defaults(run=_info)

    listing = commands.add_parser("listing", help="show the compiled program of a scene")
    _add_scene(listing)
    listing.set_defaults(run=_listing)
    return parser


def _add_scene(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "scene",
        metavar="SCENE",
        help=(
            f"{' or '.join(DEMOS)}; a scene file FILE.json; a picture FILE.exr or FILE.png that holds its scene; or a "
            f"Python file FILE.py[:NAME], run to take NAME (default: {', else '.join(_NAMES)})"
        ),
    )


def _add_execution(command: argparse.ArgumentParser) -> None:
    command.add_argument("--threads", type=int, metavar="N", help="threads at the most (default: all cores)")
    command.add_argument("--isa", help=f"instruction set, of {', '.join(om.isas())} (default: the best)")


def _size(text: str) -> tuple[int, int]:
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"size must look like 640x480, got {text!r}")
    return int(width), int(height)


def _planes(text: str) -> tuple[str, ...]:
    return tuple(PLANES) if text == "all" else _names(text)


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split(","))


def _demo(options: argparse.Namespace) -> None:
    options.output.mkdir(parents=True, exist_ok=True)
    for name, make in DEMOS.items():
        image = make().render(size=options.size, planes=tuple(PLANES), **_execution(options))
        paths = [options.output / f"{name}{suffix}" for suffix in (".exr", ".png")]
        for path in paths:
            image.save(path)
        print(f"{name}: {', '.join(map(str, paths))}")
        print(f"  {_summary(image.size, image.stats)}")


def _render(options: argparse.Namespace) -> None:
    given = {name: getattr(options, name) for name in ("size", "samples", "planes")}
    changes = {name: value for name, value in given.items() if value is not None}
    _check_output(options.output, ".exr", ".png")
    subject = _scene(options.scene)
    if isinstance(subject, om.Shot):
        fields = {field.name: getattr(subject, field.name) for field in dataclasses.fields(subject)}
    else:
        fields = {"scene": subject}
    settings = {**fields, **changes, **_execution(options)}
    width, height = settings.get("size", (0, 0))
    if options.output.suffix.lower() == ".exr" and width * height > _LARGE:
        stats = read_document(os.fspath(om.render_file(**settings, out=options.output)))["stats"]
    else:
        image = om.render(**settings)
        image.save(options.output)
        (width, height), stats = image.size, image.stats
    print(f"{options.output}: {_summary((width, height), stats)}")


def _study(options: argparse.Namespace) -> None:
    _check_output(options.output, ".html")
    subject = _scene(options.scene)
    settings: dict[str, Any] = {}
    if isinstance(subject, om.Shot):
        settings = {name: getattr(subject, name) for name in ("camera", "march", "shading", "precision")}
        subject = subject.scene
    kept = options.resume or options.output.with_suffix(".json")
    given = {name: getattr(options, name) for name in ("size", "groups", "truth", "far", "rounds")}
    try:
        found = om.study(subject, **settings, **given, resume=kept, **_execution(options))
    except KeyboardInterrupt:
        if kept.exists():
            print(f"octomarch: {kept} has what is done; the same command goes on", file=sys.stderr)
        raise
    found.save(options.output)
    print(f"{found}\n\n{options.output}: {len(found.table)} settings; {kept} has the numbers")


def _check_output(path: Path, *suffixes: str) -> None:
    """Raise what saving would raise at the end of hours of work."""
    if path.suffix.lower() not in suffixes:
        raise ValueError(f"OUT must end in {' or '.join(suffixes)}, got '{path}'")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no directory {path.parent}")


def _execution(options: argparse.Namespace) -> dict[str, Any]:
    return {"threads": options.threads, "isa": options.isa, "progress": sys.stderr.isatty()}


def _summary(size: tuple[int, int], stats: Mapping[str, Any]) -> str:
    width, height = size
    rays = stats["rays"] + stats["shadow_rays"] + stats["reflection_rays"]
    marched = stats["primary_evaluations"] + stats["cone_evaluations"]
    shading = sum(stats[f"{kind}_evaluations"] for kind in ("shadow", "reflection", "occlusion", "gradient"))
    parts = [
        f"{width}x{height}",
        stats["isa"],
        f"{stats['threads']} thread{'s' if stats['threads'] > 1 else ''}",
        f"{stats['seconds']:.3f} s",
        f"{rays / max(stats['seconds'], 1e-9) / 1e6:.1f} Mrays/s",
        f"{marched / stats['rays']:.1f} evaluations per primary ray",
        f"{(marched + shading) / (width * height):.1f} per pixel with shading",
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
    subject = _scene(options.scene)
    print(om.compile(subject.scene if isinstance(subject, om.Shot) else subject))


def _scene(text: str) -> om.Shape | om.Scene | om.Shot:
    """Return the demo scene of that name, what a scene file or a picture holds, or what a Python file defines."""
    if text in DEMOS:
        return DEMOS[text]()
    if Path(text).suffix.lower() in (".json", ".exr", ".png"):
        return read(text)
    path, _, name = text.partition(":")
    if not path.endswith(".py"):
        kinds = "FILE.json, FILE.exr, FILE.png or FILE.py[:NAME]"
        raise ValueError(f"scene must be {', '.join(DEMOS)}, {kinds}, got {text!r}")
    defined = runpy.run_path(path, run_name="octomarch_scene")
    for candidate in [name] if name else _NAMES:
        if isinstance(value := defined.get(candidate), (om.Shape, om.Scene, om.Shot)):
            return value
    raise ValueError(f"{path} defines no shape, scene or shot named {name or ' or '.join(_NAMES)}")
