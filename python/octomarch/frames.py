"""`render_frames`: many pictures into files, here or on many machines, each whole or not at all.

A file says by a digest of which `shot.Shot` it is. Whoever is to render a frame looks there first, so that what was
rendered before an end of any kind is not rendered again. `_tasks` runs the frames, `movies` makes one file of them.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from octomarch import _validate as check
from octomarch import png
from octomarch._files import remove_leftovers
from octomarch._tasks import Executor, executor_or_none, run
from octomarch._validate import Precision
from octomarch.camera import AnyCamera, or_framing
from octomarch.march import March
from octomarch.planes import PlaneName
from octomarch.program import compile
from octomarch.progress import Callback, reporting
from octomarch.render import lit_by_default, render
from octomarch.scene import Scene
from octomarch.scenefile import digest
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.shot import Shot

_MOST_TOLD = 3  # failures, in a message
_LOOKED_AT = 128  # pixels along the longer side of what tells whether there is something to be seen


class FramesError(RuntimeError):
    """Some pictures could not be rendered; all others are there.

    Parameters
    ----------
    failures : mapping of int to Exception
        The last error of each, by the frame's number.
    paths : sequence of path
        Of all frames, those that failed included.
    noun : str
        What they are called in the message.

    Examples
    --------
    >>> import octomarch as om, tempfile
    >>> nothing = om.field(om.sqrt(-1 - om.coordinates()[0] ** 2), lipschitz=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     try:
    ...         om.render_frames([om.sphere(1.0)] * 2, size=(32, 24), isa="avx9", out=f"{folder}/{{}}.exr", retries=0)
    ...     except om.FramesError as error:
    ...         print(sorted(error.failures))
    [0, 1]
    """

    failures: dict[int, Exception]
    """The last error of each frame that failed, by its number."""
    paths: list[Path]
    """Where all frames are, or should be."""

    def __init__(self, failures: Mapping[int, Exception], paths: Sequence[Path], noun: str = "frame") -> None:
        self.failures, self.paths, self._noun = dict(failures), list(paths), noun
        told = [
            f"{noun} {place} ({paths[place].name}): {type(error).__name__}: {error}"
            for place, error in list(self.failures.items())[:_MOST_TOLD]
        ]
        more = len(self.failures) - len(told)
        super().__init__(
            f"{len(self.failures)} of {len(paths)} {noun}s failed, the others are there: {'; '.join(told)}"
            + (f"; and {more} more" if more else "")
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.failures, self.paths, self._noun)


@dataclass(frozen=True)
class Frame:
    """One picture that is to be in a file. `render_frame` renders it, on whatever machine."""

    shot: Shot
    path: Path
    is_bare: bool = False
    """Whether the shot is of a shape alone, that is to be lit as `octomarch.render` lights one."""
    threads: int | None = None
    isa: str | None = None
    mark: str = ""
    """What the file is known by; none: the digest of the shot, which takes a while where the scene is large."""

    def lit(self) -> Shot:
        """Return the shot that is to be rendered."""
        shot = self.shot
        if not self.is_bare or "color" not in shot.planes:
            return shot
        camera = shot.camera or or_framing(None, compile(shot.scene), shot.size)
        return dataclasses.replace(shot, scene=lit_by_default(shot.scene.shape, camera), camera=camera)


def render_frames(
    scenes: Shape | Scene | Iterable[Shape | Scene],
    cameras: AnyCamera | Iterable[AnyCamera] | None = None,
    size: tuple[int, int] = (640, 480),
    *,
    out: str | os.PathLike[str] = "frame_{:04d}.exr",
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
) -> list[Path]:
    """Render many pictures into files, one after the other or by an executor.

    Each file appears whole or not at all, and says of what it is. Frames whose files are there already are left as they
    are, so that the same call goes on where an earlier one ended, whatever ended it. A file of another scene, camera,
    setting or version of octomarch is replaced.

    Parameters
    ----------
    scenes : Shape or Scene, or iterable of them
        One for each frame, or one for all.
    cameras : Camera, OrthographicCamera or PanoramicCamera, or iterable of them, optional
        One for each frame, or one for all; None: each scene is framed. `turntable` makes some.
    size, march, shading, planes, precision, samples, crop, threads, isa
        As for `octomarch.render`, the same for all frames.
    out : str or path-like
        Where frames go, with a place for the number, which counts from 0; ends in ``.exr`` or ``.png``.
    executor : object with a method submit, optional
        What runs the frames, each as one task: an executor of ``concurrent.futures``, a client of ``dask.distributed``
        (extra ``cluster``), or any other. It has to see the same files. None: one frame after the other, here.
    retries : int
        How often a frame that fails is tried again, ≥ 0.
    progress : bool, callable or Progress, optional
        True shows a bar. A callable gets (frames done, frames) from time to time, and what it raises ends the work.
        A `Progress` can be cancelled.

    Returns
    -------
    list of path
        Of all frames, in order.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, before anything is rendered.
    FileNotFoundError
        If there is no such folder.
    FramesError
        When all frames are done, if some have failed each time: it says which, and why.
    KeyboardInterrupt, CancelledError
        Ctrl-C and `Progress.cancel` end the work at once. What an executor has begun ends by itself.

    Examples
    --------
    >>> import octomarch as om, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cameras = om.turntable(om.box(1.0), frames=3)
    ...     paths = om.render_frames(om.box(1.0), cameras, size=(32, 24), out=f"{folder}/turn_{{:02d}}.png")
    ...     [path.name for path in paths]
    ['turn_00.png', 'turn_01.png', 'turn_02.png']
    """
    executor = executor_or_none("executor", executor)
    check.integer("retries", retries, 0)
    check.threads(threads)
    check.isa(isa)
    subjects, views = _paired(scenes, cameras)
    paths = paths_of(out, len(subjects))
    frames = []
    for subject, view, path in zip(subjects, views, paths, strict=True):
        is_bare = isinstance(subject, Shape)
        shot = Shot(
            Scene(subject) if isinstance(subject, Shape) else subject,
            view,
            size,
            march=march,
            shading=shading,
            planes=planes,
            precision=precision,
            samples=samples,
            crop=crop,
        )
        frames.append(Frame(shot, path, is_bare, threads, isa))
    render_all(frames, executor, retries, progress)
    return paths


def render_all(
    frames: Sequence[Frame], executor: Executor | None, retries: int, progress: bool | Callback | None
) -> None:
    """Render frames into their files; see `render_frames`.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     frame = Frame(om.Shot(om.Scene(om.sphere(1.0)), size=(32, 24)), pathlib.Path(folder, "ball.png"))
    ...     render_all([frame], None, 0, None)
    ...     frame.path.exists()
    True
    """
    tries = check.integer("retries", retries, 0)
    for frame in frames:
        if frame.path.suffix.lower() == ".png" and "color" not in frame.shot.planes:
            raise ValueError(f"planes must have 'color' for frames in PNG, got {check.shown(frame.shot.planes)}")
    windows = [check.crop(frame.shot.crop, frame.shot.size) for frame in frames]
    if executor is not None and frames[0].shot.crop is None:
        look(frames[0])
    rays = sum(window[2] * window[3] * frame.shot.samples for window, frame in zip(windows, frames, strict=True))
    with reporting(progress, "render", " rays", rays, "frames") as report:
        failures = run(render_frame, frames, executor, tries, report)
    remove_leftovers([frame.path for place, frame in enumerate(frames) if place not in failures])
    if failures:
        raise FramesError(failures, [frame.path for frame in frames]) from next(iter(failures.values()))


def render_frame(frame: Frame, progress: Callback | None = None) -> None:
    """Render a frame, unless its file is there.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     frame = Frame(om.Shot(om.Scene(om.sphere(1.0)), size=(32, 24)), pathlib.Path(folder, "ball.png"))
    ...     render_frame(frame)
    ...     is_rendered(frame.path, digest(frame.shot))
    True
    """
    shot = frame.lit()
    mark = frame.mark or digest(shot)
    if not is_rendered(frame.path, mark):
        image = shot.render(threads=frame.threads, isa=frame.isa, progress=progress)
        image.metadata["digest"] = mark
        image.save(frame.path)


def look(frame: Frame) -> None:
    """Warn if a picture seems to show nothing, before it takes hours: by a small one of the same view.

    Bands of a picture are too small to tell, and what workers warn of is heard by nobody.

    Examples
    --------
    >>> import octomarch as om
    >>> look(Frame(om.Shot(om.Scene(om.sphere(1.0)), size=(16384, 16384)), Path("ball.exr")))
    """
    shot = frame.lit()
    scale = min(1.0, _LOOKED_AT / max(shot.size))
    width, height = (max(1, round(scale * pixels)) for pixels in shot.size)
    march = shot.march or March()
    march = dataclasses.replace(march, pixel_tolerance=march.pixel_tolerance * height / shot.size[1])
    render(
        shot.scene,
        shot.camera,
        (width, height),
        march=march,
        planes="status",
        precision=shot.precision,
        threads=frame.threads,
        isa=frame.isa,
    )


def is_rendered(path: Path, mark: str) -> bool:
    """Tell whether a file is the whole picture of the shot with that digest.

    Examples
    --------
    >>> is_rendered(Path("no-such-file.exr"), "")
    False
    """
    try:
        if path.suffix.lower() == ".png":
            return png.read_text(os.fspath(path), png.DIGEST, whole=True) == mark
        from octomarch.exr import read_document  # here, since it is not needed to render

        return bool(read_document(os.fspath(path))["metadata"].get("digest") == mark)
    except OSError:
        return False


def _paired(scenes: object, cameras: object) -> tuple[list[Any], list[Any]]:
    """Return a scene and a camera for each frame, where one alone is for all."""
    subjects = (
        [scenes]
        if isinstance(scenes, (Shape, Scene))
        else check.sequence("scenes", scenes, "a shape, a scene or several")
    )
    views = (
        [cameras]
        if cameras is None or isinstance(cameras, AnyCamera)
        else check.sequence("cameras", cameras, "cameras")
    )
    for name, items in {"scenes": subjects, "cameras": views}.items():
        if not items:
            raise ValueError(f"{name} must hold at least one, got none")
    for place, subject in enumerate(subjects):
        if not isinstance(subject, (Shape, Scene)):
            raise TypeError(f"scenes[{place}] must be an om.Shape or om.Scene, got {check.shown(subject)}")
    for place, view in enumerate(views):
        if view is not None and not isinstance(view, AnyCamera):
            raise TypeError(f"cameras[{place}] must be a camera such as om.Camera, got {check.shown(view)}")
    count = max(len(subjects), len(views))
    if isinstance(scenes, (Shape, Scene)):
        subjects *= count
    if len(views) == 1:
        views *= count
    if len(subjects) != len(views):
        raise ValueError(f"cameras must be one, or as many as scenes, {len(subjects)}, got {len(views)}")
    return subjects, views


def paths_of(out: str | os.PathLike[str], count: int) -> list[Path]:
    """Return where frames go, whatever the folder of the process that writes them.

    Examples
    --------
    >>> [path.name for path in paths_of("frame_{:04d}.png", 2)]
    ['frame_0000.png', 'frame_0001.png']
    """
    pattern = check.path("out", out)
    try:
        paths = [Path(pattern.format(place)).absolute() for place in range(max(count, 2))]
    except (IndexError, KeyError, ValueError, AttributeError) as error:
        raise ValueError(
            f"out must have one place for a number, such as {{:04d}}, got {check.shown(pattern)}"
        ) from error
    if len(set(paths)) < len(paths):
        raise ValueError(f"out must have a place for the frame's number, such as {{:04d}}, got {check.shown(pattern)}")
    if paths[0].suffix.lower() not in (".exr", ".png"):
        raise ValueError(f"out must end in .exr or .png, got {check.shown(pattern)}")
    if not paths[0].parent.is_dir():
        raise FileNotFoundError(f"cannot write {paths[0]}: there is no directory {paths[0].parent}")
    return paths[:count]
