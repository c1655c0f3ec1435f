"""``octomarch study``: what settings cost in a scene, and how far each is from the truth."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path
from typing import Any

import octomarch as om
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.study.settings import GROUPS
from octomarch.study.truth import TRUTH_KINDS

_SIZE = (160, 120)
_SEARCHED = (640, 480)


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "study",
        _run,
        title="measure what settings cost in a scene, and how far each is from the truth",
        description="""
            Settings are varied about those of the scene and of --set, and the report is one HTML file. What is measured
            is kept in a file beside it, with which the same command goes on after Ctrl-C. With --p95 it looks for the
            cheapest settings that keep an error instead, and prints them as options for octomarch render.""",
        examples=[
            "octomarch study blend -o study.html --size 32x24 --groups series,finish --rounds 0",
            "octomarch study shot.json -o shadows.html --size 32x24 --groups shadows --set march.method=plain",
            "octomarch study building -o building.html --size 32x24 --groups method --rounds 0 --jobs 2",
            "octomarch study shot.json --p95 1e-2 --size 64x48",
        ],
    )
    common.add_scene(parser)
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("study.html"), metavar="OUT", help="report (default: study.html)"
    )
    parser.add_argument(
        "--size",
        type=common.size,
        metavar="WxH",
        help=f"in pixels (default: {_SIZE[0]}x{_SIZE[1]}, with --p95 {_SEARCHED[0]}x{_SEARCHED[1]})",
    )
    parser.add_argument("--precision", metavar="TYPE", help="float32 or float64 (default: the scene's, else float32)")
    common.add_changes(parser)
    parser.add_argument(
        "--groups",
        type=common.names,
        default=GROUPS,
        metavar="NAMES",
        help=f"of {','.join(GROUPS)} (default: all)",
    )
    parser.add_argument("--truth", default="auto", choices=TRUTH_KINDS, help="how much of it to prove (default: auto)")
    parser.add_argument(
        "--far", type=float, metavar="T", help="far limit of the series (default: past all that is bounded)"
    )
    parser.add_argument("--rounds", type=int, default=3, metavar="N", help="how often pictures are timed (default: 3)")
    parser.add_argument(
        "--resume", type=Path, metavar="FILE", help="keeps what is measured, to go on after Ctrl-C (default: OUT.json)"
    )
    search = parser.add_argument_group("settings for an error")
    search.add_argument("--p95", type=float, metavar="E", help="error of depth that 95 of 100 rays may not exceed")
    search.add_argument(
        "--misses", type=float, default=0.0, metavar="SHARE", help="of rays that may miss a surface (default: 0)"
    )
    search.add_argument(
        "--false-hits", type=float, default=1.0, metavar="SHARE", help="of rays that may hit nothing (default: 1)"
    )
    common.add_executor(parser, "settings")
    common.add_execution(parser)


def _run(options: argparse.Namespace) -> None:
    searched = options.p95 is not None
    if not searched:
        common.check_output(options.output, ".html")
    options.size = options.size or (_SEARCHED if searched else _SIZE)
    (_search if searched else _measure)(common.request(options), options)


def _measure(request: dict[str, Any], options: argparse.Namespace) -> None:
    kept = options.resume or options.output.with_suffix(".json")
    names = ("scene", "camera", "size", "march", "shading", "precision")
    settings = {name: request[name] for name in names if name in request}
    given = {name: getattr(options, name) for name in ("groups", "truth", "far", "rounds")}
    with common.resumable([kept]), common.executor(options) as executor:
        given |= {"executor": executor, "retries": options.retries, **common.execution(options)}
        found = om.study(**settings, **given, resume=kept)
    found.save(options.output)
    if not options.quiet:
        print(f"{found}\n")
    print(f"{options.output}: {len(found.table)} settings; {kept} has the numbers")


def _search(request: dict[str, Any], options: argparse.Namespace) -> None:
    names = ("scene", "camera", "size", "precision")
    march = request.get("march") or om.March()
    execution = common.execution(options)
    found = om.March.for_error(
        **{name: request[name] for name in names if name in request},
        p95=options.p95,
        misses=options.misses,
        false_hits=options.false_hits,
        max_distance=march.max_distance,
        threads=execution["threads"],
        progress=execution["progress"],
    )
    standard = om.March()
    fields = [field.name for field in dataclasses.fields(found)]
    values = {name: getattr(found, name) for name in fields if getattr(found, name) != getattr(standard, name)}
    print(" ".join(f"--set march.{name}={value}" for name, value in values.items()) or "the defaults")
    if not options.quiet:
        print(found.measured)
