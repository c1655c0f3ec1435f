"""``octomarch animate``: a scene that turns, or the frames of a script, as a movie or as numbered files."""

from __future__ import annotations

import argparse
import dataclasses
import inspect
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import octomarch as om
from octomarch import _validate as check
from octomarch.camera import framing_box
from octomarch.cli import options as common
from octomarch.cli.parser import Commands, command
from octomarch.cli.subjects import find
from octomarch.frames import Frame, paths_of, render_all
from octomarch.movies import require_imageio

_MOVIES = (".gif", ".webp", ".mp4")
_NAMES = ("frames", "frame", "shot", "scene", "shape")


def add(commands: Commands) -> None:
    """Add the command."""
    parser = command(
        commands,
        "animate",
        _run,
        title="render a turntable, or the frames of a script, as a movie or as numbered files",
        description="""
            In a Python file NAME may also be several shapes, scenes or shots, or a function that returns them; or a
            function of one argument, that gets the time, from 0 to just below 1, and returns one of them. Anything else
            is shown from all sides. Frames that are there are not rendered again, so that the same command goes on with
            what was interrupted. Movies need pip install "octomarch[movie]".""",
        examples=[
            "octomarch animate blend -o blend.gif --size 96x54 --frames 8",
            "octomarch animate scene.py:growing -o growing.webp --size 96x72 --frames 6 --fps 12",
            "octomarch animate scene.py:growing -o 'growing_{:04d}.png' --size 96x72 --frames 4 --jobs 2",
            "octomarch animate shot.json -o turn.mp4 --size 96x72 --frames 6 --keep 'turn_{:02d}.exr'",
        ],
    )
    common.add_scene(parser, _NAMES)
    parser.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="OUT",
        help=f"{', '.join(_MOVIES)}, or .exr or .png with a place for the frame's number, such as frame_{{:04d}}.png",
    )
    parser.add_argument("--frames", type=int, default=60, metavar="N", help="how many frames (default: 60)")
    parser.add_argument(
        "--degrees", type=float, default=360.0, metavar="A", help="how far the camera goes round (default: 360)"
    )
    parser.add_argument("--fps", type=float, default=24.0, metavar="N", help="frames a second of a movie (default: 24)")
    parser.add_argument("--quality", type=int, default=90, metavar="Q", help="of a movie, 1 to 100 (default: 90)")
    parser.add_argument("--keep", metavar="PATTERN", help="keep the frames of a movie, in files such as f_{:04d}.exr")
    common.add_picture(parser)
    common.add_executor(parser, "frames")
    common.add_execution(parser)


def _run(options: argparse.Namespace) -> None:
    path = Path(options.output)
    is_movie = path.suffix.lower() in _MOVIES
    common.check_output(path, *_MOVIES, ".exr", ".png")
    if options.keep and not is_movie:
        raise ValueError(f"--keep is for movies, but OUT is '{path}'")
    if is_movie:
        require_imageio()
    requests = _requests(options)
    folder = path.with_name(f".{path.name}.frames")
    if is_movie and not options.keep:
        folder.mkdir(exist_ok=True)
    paths = paths_of(options.keep or (folder / "{:06d}.png" if is_movie else path), len(requests))
    execution = common.execution(options)
    frames = [_frame(request, file, execution) for request, file in zip(requests, paths, strict=True)]
    with common.resumable(paths), common.executor(options) as executor:
        render_all(frames, executor, options.retries, execution["progress"])
    if is_movie:
        om.write_movie(path, paths, options.fps, quality=options.quality)
        shutil.rmtree(folder, ignore_errors=True)
    if not options.quiet:
        print(f"{path}: {len(paths)} frames")


def _frame(request: Mapping[str, Any], path: Path, execution: Mapping[str, Any]) -> Frame:
    scene = request["scene"]
    shot = om.Shot(**{**request, "scene": om.Scene(scene) if isinstance(scene, om.Shape) else scene})
    return Frame(shot, path, isinstance(scene, om.Shape), execution["threads"], execution["isa"])


def _requests(options: argparse.Namespace) -> list[dict[str, Any]]:
    """Return what `octomarch.render` would be called with for each frame."""
    count = check.integer("--frames", options.frames, 1)
    subject = find(options.scene, _NAMES)
    if subject.is_function and _takes_time(subject.value):
        frames = [subject.called(frame / count) for frame in range(count)]
    else:
        subject = subject.called()
        if isinstance(subject.value, (om.Shape, om.Scene, om.Shot)):
            return _turning(
                common.with_options(_framed([subject.request()], options)[0], options), count, options.degrees
            )
        items = check.sequence(subject.place, subject.value, "a shape, a scene, a shot or several, or a function")
        frames = [
            dataclasses.replace(subject, place=f"{subject.place}[{i}]", value=item) for i, item in enumerate(items)
        ]
    if not frames:
        raise ValueError(f"{subject.place} must hold at least one frame, got none")
    return [common.with_options(request, options) for request in _framed([each.request() for each in frames], options)]


def _turning(request: dict[str, Any], count: int, degrees: float) -> list[dict[str, Any]]:
    cameras = om.turntable(request["scene"], count, camera=request["camera"], degrees=degrees)
    return [{**request, "camera": camera} for camera in cameras]


def _framed(requests: list[dict[str, Any]], options: argparse.Namespace) -> list[dict[str, Any]]:
    """Give frames without a camera one that sees all of them, so that what grows does not seem to stand still."""
    lacking = [request for request in requests if request.get("camera") is None]
    if not lacking:
        return requests
    boxes = [box for request in lacking if (box := om.compile(request["scene"]).focus)]
    whole = (tuple(np.min(boxes, axis=(0, 1)).tolist()), tuple(np.max(boxes, axis=(0, 1)).tolist())) if boxes else None
    size = check.size(options.size or lacking[0].get("size", (640, 480)))
    camera = framing_box(whole, size)
    return [request if request.get("camera") is not None else {**request, "camera": camera} for request in requests]


def _takes_time(function: Callable[..., Any]) -> bool:
    """Tell whether a function has to be given an argument."""
    try:
        inspect.signature(function).bind()
    except TypeError:
        return True
    return False
