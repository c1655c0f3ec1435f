"""sRGB and PNG: how linear colours become bytes that screens show, and how such bytes become linear again.

`image`, `_pixels` and `scenefile` build on it; colours are linear everywhere else.
"""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch._files import atomic

_NUMBERS = 2**16  # turned into bytes at once: they stay in the cache, and Ctrl-C is heard between them
DOCUMENT = "octomarch"
"""Keyword of the text that holds the shot."""
DIGEST = "octomarch digest"
"""Keyword of the text that tells of which shot the picture is, however large that is."""


def write_png(path: str | os.PathLike[str], colors: NDArray[Any]) -> None:
    """Write colours as a PNG file of 8-bit sRGB.

    The file appears whole or not at all.

    Parameters
    ----------
    path : str or path-like
        Any suffix; a file that is there is replaced.
    colors : ndarray, shape (height, width, 3) or (height, width)
        Linear floats, clipped to [0, 1], NaN as 0; or sRGB bytes. Row 0 is at the top. Two axes mean grey.

    Raises
    ------
    TypeError, ValueError
        If `colors` is no such array.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import numpy as np, octomarch as om, pathlib, tempfile
    >>> ramp = np.linspace(0, 1, 256)[np.newaxis].repeat(16, axis=0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     om.write_png(pathlib.Path(folder, "ramp.png"), ramp)
    """
    check.path("path", path)
    if not isinstance(colors, np.ndarray):
        raise TypeError(f"colors must be an array, got {check.shown(colors)}")
    if colors.dtype.kind != "f" and colors.dtype != np.uint8:
        raise TypeError(f"colors must hold floats (linear) or uint8 (sRGB), got dtype {colors.dtype}")
    if colors.ndim not in (2, 3) or colors.shape[2:] not in ((), (3,)) or 0 in colors.shape:
        raise ValueError(f"colors must have shape (height, width, 3) or (height, width), got {colors.shape}")
    data = png_bytes(colors if colors.dtype == np.uint8 else levels(colors))
    with atomic(path) as temporary:
        temporary.write_bytes(data)


def png_bytes(colors: NDArray[np.uint8], texts: Mapping[str, str] | None = None) -> bytes:
    """Return a PNG file of sRGB bytes, shape (height, width, 3) or (height, width), with texts compressed in it."""
    import PIL.Image  # here, since it takes longer to import than all the rest
    import PIL.PngImagePlugin

    chunks = PIL.PngImagePlugin.PngInfo()
    chunks.add(b"sRGB", b"\0")  # perceptual intent: tells viewers which curve these bytes follow
    for keyword, text in (texts or {}).items():
        chunks.add_itxt(keyword, text, zip=True)
    buffer = io.BytesIO()
    PIL.Image.fromarray(np.ascontiguousarray(colors)).save(buffer, format="PNG", pnginfo=chunks)
    return buffer.getvalue()


def read_text(path: str, keyword: str = DOCUMENT, *, whole: bool = False) -> str | None:
    """Return a text that `png_bytes` put into a file, None where there is none; `whole` looks at all of the file first.

    Raises
    ------
    OSError
        Naming the path, if the file cannot be opened or is damaged.
    """
    import PIL.Image

    errors = (SyntaxError, ValueError, EOFError, struct.error, zlib.error, PIL.Image.DecompressionBombError)
    try:
        with PIL.Image.open(path, formats=("PNG",)) as image:
            if whole:
                image.verify()
            return image.info.get(keyword)  # texts stand before the pixels
    except FileNotFoundError:
        raise
    except (OSError, *errors) as error:
        raise OSError(f"{path}: damaged picture: it cannot be decoded ({error})") from error


def levels(linear: NDArray[Any]) -> NDArray[np.uint8]:
    """Return linear numbers as sRGB bytes: clipped to [0, 1], rounded to nearest, NaN as 0."""
    numbers = np.asarray(linear).reshape(-1)
    result = np.empty(numbers.shape, np.uint8)
    for first in range(0, numbers.size, _NUMBERS):
        some = slice(first, first + _NUMBERS)
        with np.errstate(over="ignore"):
            part = np.nan_to_num(numbers[some].astype(np.float32), nan=0.0)
        result[some] = np.searchsorted(_STEPS, part, side="right")
    return result.reshape(np.shape(linear))


def linear(levels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return sRGB bytes as linear numbers, whose bytes they are."""
    return _LEVELS[levels]


def decoded(encoded: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return linear numbers from sRGB ones in [0, 1], by the curve of IEC 61966-2-1."""
    numbers = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return numbers.astype(np.float32)


_LEVELS = decoded(np.arange(256) / 255)
_STEPS = decoded((np.arange(255) + 0.5) / 255)  # at which the byte rises by one
