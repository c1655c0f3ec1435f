"""``octomarch render``: one picture into a file."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

import octomarch as om
from octomarch.bands import bands_folder
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.exr import read_document
from octomarch.planes import PLANES

_LARGE = 2**24  # pixels: above that a picture goes band by band into its file, and an interrupted one goes on
_MAPS = ("perceptual", "iterations")


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "render",
        _run,
        title="render a scene to EXR or PNG",
        description="""
            An EXR file has all planes that are asked for, a PNG file the colours. Both hold the scene and its settings,
            so that they are scenes for the next command. An EXR file of more than 4096x4096 pixels, or one that is
            rendered with --bands, --jobs or --cluster, is written band by band: the same command goes on with one that
            was interrupted.""",
        examples=[
            "octomarch render blend -o blend.png --size 320x180 --samples 4",
            "octomarch render scene.py:make_scene -o scene.exr --planes color,depth,normal --size 320x240",
            "octomarch render shot.json -o draft.png --set march.max_steps=64 --set shading.shadows=none",
            "octomarch render shot.json -o side.png --set camera.eye=4,1,0 --set camera.fov=30 --set ambient=0.3",
            "octomarch render building -o steps.png --size 320x180 --show steps",
            "octomarch render building -o large.exr --size 640x360 --jobs 2",
        ],
    )
    common.add_scene(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help="file, .exr or .png")
    common.add_picture(parser)
    scalars = ", ".join(name for name, plane in PLANES.items() if len(plane.channels) == 1)
    parser.add_argument("--show", metavar="PLANE", help=f"show the numbers of a plane as colours: {scalars}")
    parser.add_argument(
        "--map", default=_MAPS[0], choices=_MAPS, help=f"which colours --show gives them (default: {_MAPS[0]})"
    )
    parser.add_argument("--bands", action="store_true", help="write an EXR file of any size band by band")
    common.add_executor(parser, "bands")
    common.add_execution(parser)


def _run(options: argparse.Namespace) -> None:
    is_exr = options.output.suffix.lower() == ".exr"
    in_bands = bool(options.bands or options.jobs or options.cluster)
    common.check_output(options.output, ".exr", *(() if in_bands else (".png",)))
    arguments = {**common.request(options), **common.execution(options)}
    if options.show:
        if in_bands:
            raise ValueError("--show needs the whole picture, so it goes without --bands, --jobs and --cluster")
        arguments["planes"] = (options.show,)
    elif not is_exr and "color" not in arguments.get("planes", ("color",)):
        raise ValueError(f"a PNG file needs the plane color, or --show, got --planes {','.join(arguments['planes'])}")
    width, height = arguments.setdefault("size", (640, 480))
    if in_bands or (is_exr and width * height > _LARGE and not options.show):
        size, stats = _in_bands(arguments, options)
    else:
        size, stats = _at_once(arguments, options)
    if not options.quiet:
        print(f"{options.output}: {common.summary(size, stats)}")


def _at_once(arguments: dict[str, Any], options: argparse.Namespace) -> tuple[tuple[int, int], dict[str, Any]]:
    image = om.render(**arguments)
    if options.show:
        colors = image.false_color(options.show, options.map)
        image = om.Image({"color": colors}, stats=image.stats, metadata=image.metadata)
    image.save(options.output)
    return image.size, image.stats


def _in_bands(arguments: dict[str, Any], options: argparse.Namespace) -> tuple[tuple[int, int], dict[str, Any]]:
    with common.resumable([bands_folder(options.output)]), common.executor(options) as executor:
        path = om.render_file(**arguments, out=options.output, executor=executor, retries=options.retries)
    crop = arguments.get("crop")
    return tuple(crop[2:]) if crop else arguments["size"], read_document(os.fspath(path))["stats"]
