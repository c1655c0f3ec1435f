"""`write_movie`: pictures one after the other as one file, by imageio. They come from `frames.render_frames`, say."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch import png
from octomarch._files import atomic
from octomarch._pixels import Picture, pixels
from octomarch.image import Image

Frames: TypeAlias = "Iterable[Image | Picture]"


def write_movie(path: str | os.PathLike[str], pictures: Frames, fps: float = 24.0, *, quality: int = 90) -> None:
    """Write pictures as an animated GIF or WebP, that is played over and over, or as MP4 (H.264).

    Needs the extra ``movie``: imageio. The file appears whole or not at all.

    Parameters
    ----------
    path : str or path-like
        Ends in ``.gif``, ``.webp`` or ``.mp4``; a file that is there is replaced.
    pictures : iterable of Image, path or array
        Of one size, at least one: images with colours, EXR, PNG or JPEG files, arrays as `octomarch.write_png` takes
        them. MP4 takes them one by one, so that a generator needs little memory; the others hold them all.
    fps : float
        Pictures a second, > 0. GIF knows hundredths of a second only: at 24 each picture stays for 4 of them.
    quality : int
        1 to 100, more for larger files. WebP has no losses at 100. GIF has 256 colours a picture, whatever it is.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or pictures differ in size.
    ImportError
        If imageio is not installed.
    OSError
        If a file cannot be read or written.

    Notes
    -----
    MP4 needs an even width and height: the last column or row stands twice where they are not.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> images = [om.render(om.sphere(0.5 + 0.1 * i), om.Camera((0, 0, 4), (0, 0, 0)), (32, 24)) for i in range(3)]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     om.write_movie(pathlib.Path(folder, "growing.gif"), images, fps=10)
    """
    name = check.path("path", path)
    suffix = Path(name).suffix.lower()
    if suffix not in (".gif", ".webp", ".mp4"):
        raise ValueError(f"path must end in .gif, .webp or .mp4, got {check.shown(name)}")
    rate, grade = check.positive("fps", fps), check.integer("quality", quality, 1, 100)
    if isinstance(pictures, (str, os.PathLike, Image, np.ndarray)) or not isinstance(pictures, Iterable):
        raise TypeError(f"pictures must be several pictures, got {check.shown(pictures)}")
    require_imageio()
    frames = _frames(pictures)
    with atomic(path) as temporary:
        if suffix == ".mp4":
            _write_video(temporary, frames, rate, grade)
        else:
            _write_animation(temporary, frames, rate, {} if suffix == ".gif" else _webp(grade))


def require_imageio() -> None:
    """Raise ImportError, saying how to get it, where imageio is not installed."""
    try:
        import imageio  # noqa: F401 - here, since few need it
    except ImportError as error:
        raise ImportError('movies need imageio: pip install "octomarch[movie]"') from error


def _frames(pictures: Frames) -> Iterator[NDArray[np.uint8]]:
    """Give each picture as sRGB bytes, once it is found to be as large as the first."""
    shape: tuple[int, ...] = ()
    for place, picture in enumerate(pictures):
        name = f"pictures[{place}]"
        levels = picture.to_srgb() if isinstance(picture, Image) else png.levels(pixels(name, picture))
        if shape and levels.shape != shape:
            sizes = " and ".join(f"{width}×{height}" for height, width, _ in (shape, levels.shape))
            raise ValueError(f"{name} must be as large as the first, got {sizes}")
        shape = levels.shape
        yield levels
    if not shape:
        raise ValueError("pictures must hold at least one, got none")


def _webp(quality: int) -> dict[str, Any]:
    return {"lossless": True} if quality == 100 else {"quality": quality}


def _write_animation(path: Path, frames: Iterator[NDArray[np.uint8]], fps: float, options: dict[str, Any]) -> None:
    import imageio.v3

    imageio.v3.imwrite(path, list(frames), plugin="pillow", duration=1000 / fps, loop=0, **options)


def _write_video(path: Path, frames: Iterator[NDArray[np.uint8]], fps: float, quality: int) -> None:
    import imageio.v2

    # imageio counts from 1 to 10, and makes sizes whole multiples of a number by scaling, unless that is 1
    options: dict[str, Any] = {"fps": fps, "codec": "libx264", "quality": 1 + (quality - 1) / 11, "macro_block_size": 1}
    # its own context manager lets a failed writer go on
    with contextlib.closing(imageio.v2.get_writer(path, format="FFMPEG", **options)) as writer:
        for frame in frames:
            height, width, _ = frame.shape
            writer.append_data(np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge"))
