"""Pictures as linear colours: what `textures` and skies take from arrays, EXR, PNG and JPEG files."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch import png

Picture: TypeAlias = "str | os.PathLike[str] | NDArray[Any]"

_LARGEST = 2**28  # pixels, as for renders


def pixels(name: str, source: object) -> NDArray[np.float32]:
    """Return a picture's linear RGB, shape (height, width, 3), row 0 at the top.

    An array holds linear floats or sRGB bytes, in grey (height, width) or colour (height, width, 3). Files: EXR holds
    linear colours, PNG and JPEG sRGB ones; transparency is passed over.

    Raises
    ------
    TypeError, ValueError
        Naming the argument, if it is neither a path nor such an array, or holds numbers that are not finite.
    OSError
        Naming the path, if the file cannot be opened, is of another kind or damaged.
    """
    if isinstance(source, (str, os.PathLike)):
        return _from_file(os.fspath(source))
    if not isinstance(source, np.ndarray):
        raise TypeError(f"{name} must be a path or an array, got {check.shown(source)}")
    if source.dtype.kind != "f" and source.dtype != np.uint8:
        raise TypeError(f"{name} must hold floats (linear) or uint8 (sRGB), got dtype {source.dtype}")
    if source.ndim not in (2, 3) or source.shape[2:] not in ((), (3,)) or 0 in source.shape:
        raise ValueError(f"{name} must have shape (height, width, 3) or (height, width), got {source.shape}")
    if source.shape[0] * source.shape[1] > _LARGEST:
        raise ValueError(f"{name} must hold at most 2**28 pixels, got shape {source.shape}")
    with np.errstate(over="ignore"):
        colors = png.linear(source) if source.dtype == np.uint8 else source.astype(np.float32)
    if not np.isfinite(colors).all():
        raise ValueError(f"{name} must hold finite numbers, got some that are not, or do not fit float32")
    return _rgb(colors)


def _from_file(path: str) -> NDArray[np.float32]:
    with Path(path).open("rb") as file:  # a missing file is told here, by its name
        is_exr = file.read(4) == b"\x76\x2f\x31\x01"
    colors = _from_exr(path) if is_exr else _from_pillow(path)
    if not np.isfinite(colors).all():
        raise OSError(f"{path}: some of its colours are not finite")
    return colors


def _from_exr(path: str) -> NDArray[np.float32]:
    from octomarch.exr import read_exr  # here, since it is not needed to render

    image = read_exr(path, verify=False)
    if "color" not in image.planes:
        raise OSError(f"{path}: there are no channels R, G, B")
    return np.asarray(image.color, dtype=np.float32)


def _from_pillow(path: str) -> NDArray[np.float32]:
    import PIL.Image  # here, since it takes longer to import than all the rest

    errors = (OSError, SyntaxError, ValueError, EOFError, IndexError, struct.error, zlib.error)
    try:
        with PIL.Image.open(path, formats=("PNG", "JPEG")) as image:
            if image.mode.startswith("I"):  # 16 bits of grey
                return _rgb(png.decoded(np.asarray(image, dtype=np.float64) / 65535))
            return _rgb(png.linear(np.asarray(image.convert("RGB"))))
    except PIL.UnidentifiedImageError as error:
        raise OSError(f"{path}: not an EXR, PNG or JPEG file") from error
    except (*errors, PIL.Image.DecompressionBombError) as error:
        raise OSError(f"{path}: damaged picture: it cannot be decoded ({error})") from error


def _rgb(colors: NDArray[np.float32]) -> NDArray[np.float32]:
    return colors if colors.ndim == 3 else np.repeat(colors[..., np.newaxis], 3, axis=-1)
