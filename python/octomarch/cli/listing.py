"""``octomarch listing``: the compiled program of a scene."""

from __future__ import annotations

import argparse

import octomarch as om
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.cli.subjects import find


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "listing",
        _run,
        title="show the compiled program of a scene",
        examples=["octomarch listing blend", "octomarch listing scene.py:make_scene"],
    )
    common.add_scene(parser)


def _run(options: argparse.Namespace) -> None:
    print(om.compile(find(options.scene).request()["scene"]))
