"""Options that several commands share, and what they come to."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from octomarch._tasks import Executor
from octomarch.cli.changes import assignment, changed
from octomarch.cli.jobs import Jobs
from octomarch.cli.parser import Parser
from octomarch.cli.subjects import NAMES, find
from octomarch.demo import DEMOS
from octomarch.planes import PLANES


def add_scene(parser: Parser, names: tuple[str, ...] = NAMES, *, optional: bool = False) -> None:
    """Add the argument SCENE."""
    parser.add_argument(
        "scene",
        metavar="SCENE",
        nargs="?" if optional else None,
        help=(
            f"{' or '.join(DEMOS)}; FILE.json; FILE.exr or FILE.png, if the picture holds its scene; or "
            "FILE.py[:NAME], where NAME is a shape, a scene, a shot, or a function without arguments that returns one "
            f"(default: {', else '.join(names)})"
        ),
    )


def add_picture(parser: Parser) -> None:
    """Add what decides about a picture: some options of their own, and ``--set`` for all else."""
    parser.add_argument(
        "--size", type=size, metavar="WxH", help="width and height in pixels (default: the scene's, else 640x480)"
    )
    parser.add_argument("--samples", type=int, metavar="N", help="rays per pixel (default: the scene's, else 1)")
    parser.add_argument("--precision", metavar="TYPE", help="float32 or float64 (default: the scene's, else float32)")
    parser.add_argument(
        "--planes",
        type=_planes,
        metavar="NAMES",
        help=f"all, or some of {','.join(PLANES)} (default: the scene's, else color)",
    )
    parser.add_argument(
        "--crop", type=_crop, metavar="X,Y,W,H", help="render this rectangle of the picture only, from the upper left"
    )
    add_changes(parser)


def add_changes(parser: Parser) -> None:
    """Add ``--set``."""
    parser.add_argument(
        "--set",
        dest="changes",
        type=assignment,
        action="append",
        default=[],
        metavar="PATH=VALUE",
        help=(
            "change a setting, as often as there are some: PATH is a field of march, shading, camera, sky or lights.0 "
            "and so on, such as march.max_steps, or ambient, samples, precision, planes, crop; VALUE is JSON, a word, "
            "or several with commas"
        ),
    )


def add_execution(parser: Parser) -> None:
    """Add what says how work is done, which no result depends on."""
    parser.add_argument("--threads", type=int, metavar="N", help="threads at the most (default: all cores)")
    parser.add_argument("--isa", metavar="NAME", help="instruction set, see octomarch info (default: the best)")
    parser.add_argument("-q", "--quiet", action="store_true", help="show no bar and no summary")


def add_executor(parser: Parser, tasks: str) -> None:
    """Add what says where tasks are done."""
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--jobs", type=_count, metavar="N", help=f"spread {tasks} over N processes")
    where.add_argument(
        "--cluster", metavar="ADDRESS", help=f"spread {tasks} over a Dask cluster, such as tcp://host:8786"
    )
    parser.add_argument(
        "--retries", type=int, default=3, metavar="N", help="how often a failed task is tried again (default: 3)"
    )


def request(options: argparse.Namespace) -> dict[str, Any]:
    """Return what `octomarch.render` is to be called with for SCENE, as the options change it."""
    return with_options(find(options.scene).request(), options)


def with_options(found: Mapping[str, Any], options: argparse.Namespace) -> dict[str, Any]:
    """Return what a scene's request becomes by the options."""
    given = {name: getattr(options, name, None) for name in ("size", "samples", "precision", "planes", "crop")}
    plain = {name: value for name, value in given.items() if value is not None}
    return changed({**found, **plain}, options.changes)


def execution(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments of that name of `octomarch.render` and others."""
    threads = options.threads
    if threads is None and getattr(options, "jobs", None):
        threads = max(1, (os.cpu_count() or 1) // options.jobs)
    return {"threads": threads, "isa": options.isa, "progress": sys.stderr.isatty() and not options.quiet}


@contextmanager
def executor(options: argparse.Namespace) -> Iterator[Executor | None]:
    """Give what runs tasks; None: they run here."""
    if options.jobs:
        with Jobs(options.jobs) as jobs:
            yield jobs
    elif options.cluster:
        try:
            from distributed import Client
        except ImportError as error:
            raise ImportError('a cluster needs Dask: pip install "octomarch[cluster]"') from error
        with Client(options.cluster) as client:  # type: ignore[no-untyped-call, unused-ignore]
            yield client
    else:
        yield None


@contextmanager
def resumable(kept: Sequence[Path]) -> Iterator[None]:
    """Say after Ctrl-C that the same command goes on, if any of the files is there that it goes on with."""
    try:
        yield
    except KeyboardInterrupt:
        found = [path for path in kept if path.exists()]
        if found:
            more = f" and {len(found) - 1} more have" if len(found) > 1 else " has"
            print(f"octomarch: {found[0]}{more} what is done; the same command goes on", file=sys.stderr)
        raise


def check_output(path: Path, *suffixes: str) -> None:
    """Raise what saving would raise at the end of hours of work."""
    if path.suffix.lower() not in suffixes:
        raise ValueError(f"OUT must end in {' or '.join(suffixes)}, got '{path}'")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no directory {path.parent}")


def summary(size: tuple[int, int], stats: Mapping[str, Any]) -> str:
    """Return what a picture took, in a line."""
    width, height = size
    stages = stats["stages"]
    rays = stats["rays"] + stages["shadow"]["count"] + stages["reflection"]["count"]
    marched = stages["primary"]["evaluations"] + stages["cones"]["evaluations"]
    shading = sum(stages[name]["evaluations"] for name in ("shadow", "reflection", "occlusion", "normals"))
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


def size(text: str) -> tuple[int, int]:
    """Return the width and height of a text such as 640x480.

    Examples
    --------
    >>> size("640x480")
    (640, 480)
    """
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"must look like 640x480, got {text!r}")
    return int(width), int(height)


def names(text: str) -> tuple[str, ...]:
    """Return the words of a list with commas.

    Examples
    --------
    >>> names("color,depth")
    ('color', 'depth')
    """
    return tuple(text.split(","))


def _crop(text: str) -> tuple[int, ...]:
    numbers = text.split(",")
    if len(numbers) != 4 or not all(number.isdecimal() for number in numbers):
        raise argparse.ArgumentTypeError(f"must look like 0,0,320,240, got {text!r}")
    return tuple(map(int, numbers))


def _planes(text: str) -> tuple[str, ...]:
    return tuple(PLANES) if text == "all" else names(text)


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 4096:
        raise argparse.ArgumentTypeError(f"must be a number of processes, 1 to 4096, got {text!r}")
    return int(text)
