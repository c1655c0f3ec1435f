"""`render_file`: one large picture, band by band into its file, with little memory; what ends it early costs one band.

Each band is a crop in a file of its own, beside the picture, as `frames` renders them; `_exr_bands` joins them.
"""

from __future__ import annotations

import dataclasses
import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from octomarch import _validate as check
from octomarch._exr_bands import join
from octomarch._exr_chunks import ROWS, parts_of
from octomarch._files import remove_leftovers
from octomarch._tasks import Executor, executor_or_none, run
from octomarch._validate import Precision
from octomarch.camera import AnyCamera
from octomarch.frames import Frame, FramesError, is_rendered, look, render_frame
from octomarch.march import March
from octomarch.planes import PlaneName
from octomarch.progress import Callback, reporting
from octomarch.scene import Scene
from octomarch.scenefile import digest, parsed, text_for_picture
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.shot import Shot

_PIXELS = 2**18
"""Of a band: few enough that Ctrl-C need not wait for one to be written, and enough to keep all cores busy."""


def render_file(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (640, 480),
    *,
    out: str | os.PathLike[str],
    executor: Executor | None = None,
    retries: int = 3,
    march: March | None = None,
    shading: Shading | None = None,
    planes: PlaneName | Sequence[PlaneName] | Sequence[str] = ("color",),
    precision: Precision = "float32",
    samples: int = 1,
    crop: Sequence[int] | None = None,
    threads: int | None = None,
    isa: str | None = None,
    progress: bool | Callback | None = None,
) -> Path:
    """Render a picture into an EXR file, band by band, so that memory does not limit its size.

    The file holds the bits that ``render(...).save(out)`` writes, and appears when all of it is there. Until then its
    bands are in a folder beside it, ``.NAME.bands``: the same call goes on where an earlier one ended, whatever ended
    it. If the file is there, and of this scene, camera, settings and version of octomarch, nothing is done.

    Parameters
    ----------
    scene, camera, size, march, shading, planes, precision, samples, crop, threads, isa
        As for `octomarch.render`.
    out : str or path-like
        Ends in ``.exr``; a file of anything else that is there is replaced.
    executor, retries
        What renders the bands, and how often one that fails is tried again, as for `render_frames`.
    progress : bool, callable or Progress, optional
        True shows a bar. A callable gets (bands done, bands) from time to time, and what it raises ends the work.
        A `Progress` can be cancelled.

    Returns
    -------
    path
        Of the file.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, before anything is rendered.
    SceneError
        If the scene cannot be compiled.
    FramesError
        If some bands have failed each time; those that have not are kept.
    OSError
        If the file cannot be written.
    KeyboardInterrupt, CancelledError
        Ctrl-C and `Progress.cancel` end the work at once. What an executor has begun ends by itself.

    Warns
    -----
    RenderWarning
        If it seems that nothing is to be seen: why, and what would help, before the picture is rendered.

    Examples
    --------
    >>> import octomarch as om, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = om.render_file(om.sphere(1.0), size=(2000, 500), out=f"{folder}/ball.exr")
    ...     om.read_exr(path)
    <Image 2000×500: color>
    """
    executor = executor_or_none("executor", executor)
    tries = check.integer("retries", retries, 0)
    check.threads(threads)
    check.isa(isa)
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    path = _path(out)
    whole = Shot(
        Scene(scene) if isinstance(scene, Shape) else scene,
        camera,
        size,
        march=march,
        shading=shading,
        planes=planes,
        precision=precision,
        samples=samples,
        crop=crop,
    )
    shot = Frame(whole, path, isinstance(scene, Shape)).lit()
    mark = digest(shot)
    window = check.crop(shot.crop, shot.size)
    with reporting(progress, "render", " rays", window[2] * window[3] * shot.samples, "bands") as report:
        if not is_rendered(path, mark):
            if shot.crop is None:
                look(Frame(shot, path, threads=threads, isa=isa))
            folder = bands_folder(path)
            folder.mkdir(exist_ok=True)
            rows = max(1, _PIXELS // (ROWS * window[2])) * ROWS
            frames = [
                Frame(
                    dataclasses.replace(shot, crop=band),
                    folder / f"{band[1]:08d}.exr",
                    threads=threads,
                    isa=isa,
                    mark=f"{mark} {band}",
                )
                for band in parts_of(window, rows)
            ]
            bands = [frame.path for frame in frames]
            failures = run(render_frame, frames, executor, tries, report)
            if failures:
                raise FramesError(failures, bands, "band") from next(iter(failures.values()))

            def poll() -> None:
                if report is not None:
                    report(len(bands), len(bands))

            join(path, bands, lambda of_band: _metadata(of_band, shot, mark), poll)
            shutil.rmtree(folder)
            remove_leftovers([path])
    return path


def bands_folder(path: Path) -> Path:
    """Return where the bands of a picture are until all are there.

    Examples
    --------
    >>> bands_folder(Path("large.exr")).name
    '.large.exr.bands'
    """
    return path.with_name(f".{path.name}.bands")


def _path(out: object) -> Path:
    name = check.path("out", out)
    path = Path(name).absolute()
    if path.suffix.lower() != ".exr":
        raise ValueError(f"out must end in .exr, got {check.shown(name)}")
    if path.is_dir():
        raise IsADirectoryError(f"cannot write {path}: it is a directory")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no directory {path.parent}")
    return path


def _metadata(of_band: Mapping[str, Any], shot: Shot, mark: str) -> dict[str, Any]:
    """Return the metadata of a whole picture, by those of a band."""
    document = of_band.get("document")
    if document is not None:
        document = text_for_picture(dataclasses.replace(parsed(document), crop=shot.crop))
    made = {**of_band["render"], "crop": shot.crop}
    return {**of_band, "render": made, "document": document, "digest": mark}
