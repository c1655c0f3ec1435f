"""``octomarch mesh``: the surface of a scene as triangles in a file."""

from __future__ import annotations

import argparse
from pathlib import Path

import octomarch as om
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.cli.subjects import find
from octomarch.meshing import Colors

_SUFFIXES = (".stl", ".ply", ".obj", ".glb")


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "mesh",
        _run,
        title="write the surface of a scene as triangles to STL, PLY, OBJ or GLB",
        description="""
            Vertices lie on the surface and have exact normals and the colours of the materials, except in STL files,
            which hold neither. The mesh is closed. What has no end, such as a floor, must be cut by --bounds.""",
        examples=[
            "octomarch mesh blend -o blend.glb --resolution 64 --bounds=-3,-1.2,-2,3,1.5,2",
            "octomarch mesh building -o building.stl --resolution 64 --bounds=-6,-1,-6,6,5,6",
        ],
    )
    common.add_scene(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help=f"file, {', '.join(_SUFFIXES)}")
    parser.add_argument(
        "--resolution", type=int, default=128, metavar="N", help="cells along the longest edge (default: 128)"
    )
    parser.add_argument(
        "--bounds", type=_bounds, metavar="X,Y,Z,X,Y,Z", help="two corners of a box that the shape is cut to"
    )
    parser.add_argument("--threads", type=int, metavar="N", help="threads at the most (default: all cores)")
    parser.add_argument("-q", "--quiet", action="store_true", help="show no summary")


def _run(options: argparse.Namespace) -> None:
    common.check_output(options.output, *_SUFFIXES)
    scene = find(options.scene).request()["scene"]
    shape = scene.shape if isinstance(scene, om.Scene) else scene
    colors: Colors = "linear" if options.output.suffix.lower() == ".glb" else "srgb"
    mesh = shape.mesh(options.resolution, bounds=options.bounds, colors=colors, threads=options.threads)
    mesh.export(options.output)
    if not options.quiet:
        counts = f"{len(mesh.vertices)} vertices, {len(mesh.faces)} triangles"
        print(f"{options.output}: {counts}, {mesh.metadata['evaluations']} evaluations")


def _bounds(text: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    try:
        numbers = tuple(map(float, text.split(",")))
    except ValueError:
        numbers = ()
    if len(numbers) != 6:
        raise argparse.ArgumentTypeError(f"bounds must look like -1,-1,-1,1,1,1, got {text!r}")
    return numbers[:3], numbers[3:]
