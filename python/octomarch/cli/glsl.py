"""``octomarch glsl``: a scene as a fragment shader."""

from __future__ import annotations

import argparse
from pathlib import Path

import octomarch as om
from octomarch._files import atomic
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command

_TAKEN = ("camera", "march", "shading", "size")


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "glsl",
        _run,
        title="write a scene as a fragment shader, in the manner of ShaderToy",
        description="""
            GLSL ES 3.00 with the function mainImage, all that the picture is made of in it. What cannot be part of a
            shader, such as a large image, is told.""",
        examples=[
            "octomarch glsl building -o building.glsl",
            "octomarch glsl shot.json -o shot.frag --set shading.shadows=hard --set camera.fov=30",
        ],
    )
    common.add_scene(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help="file, .glsl or .frag")
    parser.add_argument(
        "--size", type=common.size, metavar="WxH", help="for which a missing camera is found (default: 640x480)"
    )
    common.add_changes(parser)


def _run(options: argparse.Namespace) -> None:
    common.check_output(options.output, ".glsl", ".frag")
    request = common.request(options)
    scene: om.Shape | om.Scene = request["scene"]
    text = scene.glsl(**{name: request[name] for name in _TAKEN if request.get(name) is not None})
    with atomic(options.output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    print(f"{options.output}: {text.count(chr(10))} lines")
