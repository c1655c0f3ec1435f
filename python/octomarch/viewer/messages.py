"""What an engine and a front end tell each other, as JSON and bytes; `widget` and `server` carry it to `viewer.js`.

To the front end go ``state`` (what can be set, and to what it is), ``frame`` (a picture, its file as bytes), ``errors``
(of the last frame, once the truth is known), ``picked``, ``error``, and ``done`` if nothing has changed. Each but
``state`` tells up to which input of which client it ``answers``. From the front end come ``hello`` and ``input``: what
the hand has done since the last one, with the client's name and a number.
"""

from __future__ import annotations

import io
import math
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

import numpy as np

from octomarch import png
from octomarch.image import Image
from octomarch.looks import SHOWN, Bytes, Legend
from octomarch.march import March, Status
from octomarch.study.errors import DepthErrors
from octomarch.study.measure import evaluations
from octomarch.viewer.pace import Quality
from octomarch.viewer.picking import Pick
from octomarch.viewer.pictures import View, resolved

Message: TypeAlias = dict[str, Any]

_JPEG_QUALITY = 85
_MOST_STEPS = 1024
_COARSEST_EPSILON, _FINEST_EPSILON = 1e-1, 1e-8  # of the scene's size
_TOLERANCES = 1e-3, 16.0


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture on its way to the front end."""

    image: Image
    view: View
    quality: Quality
    shown: Bytes
    legend: Legend | None
    errors: DepthErrors | None
    is_last: bool
    """No finer one follows unless something changes."""


def state(view: View) -> Message:
    """Return what a front end shows beside pictures, and where its sliders end.

    Examples
    --------
    >>> import octomarch as om
    >>> from octomarch.viewer.pictures import view_of
    >>> state(view_of(om.sphere(1.0)))["sliders"]["max_steps"]
    {'value': 256, 'low': 1, 'high': 1024, 'is_default': True}
    """
    march, default = resolved(view), March()
    sliders = {
        name: {
            "value": getattr(march, name),
            "low": low,
            "high": high,
            "is_default": getattr(view.march, name) == getattr(default, name),
        }
        for name, (low, high) in _ranges(view.extent).items()
    }
    return {"kind": "state", "size": view.size, "plane": view.plane, "planes": SHOWN, "sliders": sliders}


def _ranges(extent: float) -> dict[str, tuple[float, float]]:
    """Return the ends of sliders, whose ways are logarithms."""
    epsilons = _FINEST_EPSILON * extent, _COARSEST_EPSILON * extent
    return {"max_steps": (1, _MOST_STEPS), "epsilon": epsilons, "pixel_tolerance": _TOLERANCES}


def frame_message(frame: Frame) -> tuple[Message, bytes]:
    """Return what to say of a picture, and its file: PNG of the last one, JPEG of those that soon are replaced."""
    image, quality = frame.image, frame.quality
    counts = np.bincount(image.status.ravel(), minlength=len(Status))
    message = {
        "kind": "frame",
        "type": "image/png" if frame.is_last else "image/jpeg",
        "size": image.size,
        "is_last": frame.is_last,
        "is_lit": quality.is_lit,
        "samples": quality.samples,
        "plane": frame.view.plane,
        "evaluations": evaluations(image),
        "milliseconds": 1e3 * image.stats["seconds"],
        "errors": errors(frame.errors),
        "statuses": {status.name: int(counts[status]) for status in Status if counts[status]},
        "legend": frame.legend and asdict(frame.legend),
    }
    return message, png.png_bytes(frame.shown) if frame.is_last else jpeg_bytes(frame.shown)


def errors(found: DepthErrors | None) -> Message | None:
    """Return how far a picture is from the truth; None where that is not known yet."""
    return None if found is None else {name: _finite(value) for name, value in asdict(found).items()}


def picked_message(pick: Pick) -> Message:
    """Return what a ray met."""
    position, normal = (list(vector) for vector in (pick.position, pick.normal))
    changed = {"status": pick.status.name, "t": _finite(pick.t), "position": position, "normal": normal}
    return {"kind": "picked", **asdict(pick), **changed}


def error_message(error: Exception) -> Message:
    """Return what went wrong.

    Examples
    --------
    >>> error_message(ValueError("scene must be a shape, got 3"))["text"]
    'ValueError: scene must be a shape, got 3'
    """
    return {"kind": "error", "text": f"{type(error).__name__}: {error}"}


def jpeg_bytes(shown: Bytes) -> bytes:
    """Return a JPEG file of sRGB bytes, shape (height, width, 3).

    Examples
    --------
    >>> jpeg_bytes(np.zeros((4, 4, 3), np.uint8))[:2].hex()
    'ffd8'
    """
    import PIL.Image  # here, since it takes longer to import than all the rest

    buffer = io.BytesIO()
    PIL.Image.fromarray(np.ascontiguousarray(shown)).save(buffer, format="JPEG", quality=_JPEG_QUALITY)
    return buffer.getvalue()


def _finite(value: float) -> float | None:
    """Return a number as JSON knows it: None stands for infinity."""
    return value if math.isfinite(value) else None
