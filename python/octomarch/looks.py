"""How planes look: bytes of sRGB for each of them, and the legend that tells what the colours mean.

`viewer` shows pictures so, and `image.Image` itself where it has no colours.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from octomarch import png
from octomarch.colormaps import colormap
from octomarch.image import Image
from octomarch.march import Status

Shown: TypeAlias = Literal["color", "depth", "normal", "steps", "status", "error"]
SHOWN: tuple[Shown, ...] = ("color", "depth", "normal", "steps", "status", "error")
"""What a viewer can show: planes, and the error of depth."""
Bytes: TypeAlias = NDArray[np.uint8]

_NOTHING = (0x3A, 0x3F, 0x4A)
_STATUS = ((0x56, 0xB4, 0xE9), _NOTHING, (0xE6, 0x9F, 0x00), (0xCC, 0x79, 0xA7), (0xD5, 0x5E, 0x00))
"""Of `Status`: colours that the colour-blind can tell from each other [Okabe, Ito 2008]."""
_WRONG = (0x00, 0x9E, 0x73)
_ERRORS = 1e-8, 1e-2  # the ends of the ramp, of the scene's size
_RAMP_STOPS = 9  # colours of the ramp that a legend is drawn from


@dataclass(frozen=True)
class Legend:
    """What colours mean: those of a ramp from its first label to its last, or each that of one label."""

    is_ramp: bool
    colors: tuple[str, ...]
    labels: tuple[str, ...]


def look(image: Image, plane: Shown, errors: NDArray[np.float64] | None = None, extent: float = 1.0) -> Bytes:
    """Return what a plane looks like, shape (height, width, 3).

    Parameters
    ----------
    image : Image
        With that plane.
    plane : str
        One of `SHOWN`.
    errors : ndarray
        Errors of depth (height, width): +inf where only one of the picture and the truth has a surface, NaN where
        neither has one or it is not known. For the plane ``"error"``.
    extent : float
        The scene's size, to which errors are set in relation.

    Examples
    --------
    >>> import octomarch as om
    >>> image = om.render(om.sphere(1.0), size=(32, 24), planes=("depth", "status"))
    >>> look(image, "status")[0, 0].tolist()
    [58, 63, 74]
    """
    if plane == "color":
        return png.levels(image.color)
    if plane == "normal":
        shown: Bytes = np.rint(127.5 + 127.5 * image.normal).astype(np.uint8)
        shown[~image.normal.any(axis=-1)] = _NOTHING
        return shown
    if plane == "status":
        colors: Bytes = np.array(_STATUS, np.uint8)[image.status]
        return colors
    if plane == "error":
        assert errors is not None
        return _look_of_errors(errors, extent)
    values = image.depth if plane == "depth" else image.steps
    low, high = _range(image, plane)
    known = np.isfinite(values)
    shares = (np.where(known, values, low) - low) / (high - low or 1.0)
    return np.where(known[..., None], _ramped(shares), np.array(_NOTHING, np.uint8))


def legend(image: Image, plane: Shown, extent: float = 1.0) -> Legend | None:
    """Return what the colours of `look` mean; None where they speak for themselves.

    Examples
    --------
    >>> import octomarch as om
    >>> image = om.render(om.sphere(1.0), om.Camera((0, 0, 3), (0, 0, 0)), size=(32, 24), planes=("depth",))
    >>> legend(image, "depth").labels
    ('2', '2.67')
    """
    stops = tuple(_hex(color) for color in _ramp()[np.linspace(0, 255, _RAMP_STOPS).astype(int)])
    if plane == "status":
        return Legend(False, tuple(map(_hex, _STATUS)), tuple(_words(status.name) for status in Status))
    if plane == "error":
        labels = tuple(f"{end * extent:.0e}" for end in _ERRORS)
        return Legend(True, (*stops, _hex(_WRONG)), (*labels, "hit in only one"))
    if plane in ("depth", "steps"):
        return Legend(True, stops, tuple(f"{end:.3g}" for end in _range(image, plane)))
    return None


def default_plane(image: Image) -> Shown | None:
    """Return which plane to show of an image; None where there is none that can be.

    Examples
    --------
    >>> import octomarch as om
    >>> default_plane(om.render(om.sphere(1.0), size=(32, 24), planes=("status", "normal")))
    'normal'
    """
    return next((plane for plane in SHOWN if plane in image.planes), None)


def _range(image: Image, plane: Shown) -> tuple[float, float]:
    """Return what gets the first and the last colour."""
    if plane == "steps":
        return 0.0, float(image.steps.max())
    known = image.depth[np.isfinite(image.depth)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)


def _look_of_errors(errors: NDArray[np.float64], extent: float) -> Bytes:
    known = np.isfinite(errors)
    low, high = (math.log(end * extent) for end in _ERRORS)
    shares = (np.log(np.maximum(np.where(known, errors, 0.0), 1e-300)) - low) / (high - low)
    shown = np.where(known[..., None], _ramped(shares), np.array(_NOTHING, np.uint8))
    shown[errors == np.inf] = _WRONG
    return cast("Bytes", shown)


def _ramped(shares: NDArray[Any]) -> Bytes:
    return cast("Bytes", _ramp()[np.clip(shares * 256, 0, 255).astype(np.uint8)])


@functools.cache
def _ramp() -> Bytes:
    return png.levels(colormap(np.linspace(0, 1, 256)))


def _hex(color: Any) -> str:
    return "#" + bytes(map(int, color)).hex()


def _words(name: str) -> str:
    return name.lower().replace("_", " ")
