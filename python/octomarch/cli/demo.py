"""``octomarch demo``: the demo scenes, to see that all is well."""

from __future__ import annotations

import argparse
from pathlib import Path

from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.demo import DEMOS
from octomarch.planes import PLANES


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "demo",
        _run,
        title="render the demo scenes to EXR and PNG",
        description=f"They are {' and '.join(DEMOS)}, which the other commands take as scenes too.",
        examples=["octomarch demo -o out --size 320x180"],
    )
    parser.add_argument("-o", "--output", type=Path, default=Path(), metavar="DIR", help="folder (default: this one)")
    parser.add_argument(
        "--size", type=common.size, default=(960, 540), metavar="WxH", help="in pixels (default: 960x540)"
    )
    common.add_execution(parser)


def _run(options: argparse.Namespace) -> None:
    options.output.mkdir(parents=True, exist_ok=True)
    for name, make in DEMOS.items():
        image = make().render(size=options.size, planes=tuple(PLANES), **common.execution(options))
        paths = [options.output / f"{name}{suffix}" for suffix in (".exr", ".png")]
        for path in paths:
            image.save(path)
        if not options.quiet:
            print(f"{name}: {', '.join(map(str, paths))}")
            print(f"  {common.summary(image.size, image.stats)}")
