"""Flat shapes of outlines that others have drawn: matplotlib's paths, and text. Polygons (`flat`) are made of them.

matplotlib is looked for when it is asked for; the extra ``octomarch[plot]`` installs it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from octomarch import _rings
from octomarch import _validate as check
from octomarch.flat import polygon
from octomarch.operators import union
from octomarch.shapes import Shape

if TYPE_CHECKING:
    from matplotlib.path import Path

FINENESS = 500
"""Text is within its size over this of the curves that it is drawn with."""


def from_path(path: Path, tolerance: float) -> Shape:
    """Return the flat shape that a path of matplotlib encloses.

    Subpaths are closed, and count as fonts are drawn: inside is where they do not go round as often in one sense as in
    the other, so that an outline is filled and one of the other sense within it is a hole. Curves become edges.

    Parameters
    ----------
    path : matplotlib.path.Path
        Lines and Bézier curves.
    tolerance : float
        How far edges may lie from the curves, > 0. A curve takes about as many edges as the root of its size over this.

    Returns
    -------
    Shape
        Flat: a union of polygons with holes, exact where outlines do not cross. Its cost grows with their edges.

    Raises
    ------
    ImportError
        If matplotlib is missing.
    TypeError, ValueError
        If an argument is of a wrong type or not finite, or nothing is enclosed; where an outline crosses itself, or one
        of the other sense.

    Examples
    --------
    >>> import octomarch as om
    >>> from matplotlib.path import Path
    >>> disc = om.from_path(Path.circle(radius=1.0), tolerance=1e-3)
    >>> bool(abs(disc.distance([3, 0, 0]) - 2) < 1e-3)
    True
    """
    path_class = _matplotlib().Path
    if not isinstance(path, path_class):
        raise TypeError(f"path must be a matplotlib.path.Path, got {check.shown(path)}")
    return _shape_of(path, check.positive("tolerance", tolerance), "path")


def text(
    string: str,
    size: float = 1.0,
    font: str | PathLike[str] | None = None,
    align: Literal["left", "center", "right"] = "center",
    tolerance: float | None = None,
) -> Shape:
    """Return a line of text as a flat shape, to be extruded.

    Parameters
    ----------
    string : str
        One line, not blank. What stands between two ``$`` is set as matplotlib sets formulas.
    size : float
        Of the font in scene units, > 0: capitals are about 0.73 times as high.
    font : str or path, optional
        Name of a family that matplotlib finds, such as ``"DejaVu Serif"``, or file of a font (``.ttf``, ``.otf``);
        DejaVu Sans, which matplotlib brings along, for None.
    align : {"left", "center", "right"}
        What of the text stands at x = 0. Letters stand on y = 0.
    tolerance : float, optional
        How far edges may lie from the font's curves, > 0; a 500th of the size for None.

    Returns
    -------
    Shape
        Flat: a union of polygons, each a letter or a part of one; see `from_path`. Letters far from a ray cost nothing.

    Raises
    ------
    ImportError
        If matplotlib is missing.
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, the font is not found, or has no outlines for the text.

    Examples
    --------
    >>> import octomarch as om
    >>> sign = om.text("octomarch", size=1.0).extrude(0.2)
    >>> (lo, hi) = sign.bounds()
    >>> round(float(hi[0] - lo[0]), 1), round(float(hi[1]), 2)
    (5.2, 0.76)
    """
    if not isinstance(string, str):
        raise TypeError(f"string must be a str, got {check.shown(string)}")
    if not string.strip() or "\n" in string:
        raise ValueError(f"string must be one line of text that is not blank, got {check.shown(string)}")
    height = check.positive("size", size)
    finest = height / FINENESS if tolerance is None else check.positive("tolerance", tolerance)
    share = {"left": 0.0, "center": 0.5, "right": 1.0}[check.choice("align", align, ("left", "center", "right"))]
    path = _matplotlib().TextPath((0.0, 0.0), string, size=height, prop=_font(font))
    if not len(path.vertices):
        raise ValueError(f"string must have outlines in this font, got {check.shown(string)}")
    shape = _shape_of(path, finest, "string")
    lo, hi = shape.bounds()
    return shape.translate(-float(lo[0] + share * (hi[0] - lo[0])), 0.0, 0.0)


def _matplotlib() -> Any:
    """Return matplotlib's text paths, a module that knows paths and fonts too."""
    try:
        from matplotlib import textpath
    except ImportError as error:
        raise ImportError('paths and text need matplotlib: pip install "octomarch[plot]"') from error
    return textpath


def _font(font: str | PathLike[str] | None) -> Any:
    from matplotlib import font_manager

    if font is None:
        return font_manager.FontProperties(family="DejaVu Sans")
    if not isinstance(font, (str, PathLike)):
        raise TypeError(f"font must be a name or a file, got {check.shown(font)}")
    name = fspath(font)
    if FilePath(name).suffix.lower() in (".ttf", ".otf", ".ttc") or isinstance(font, PathLike):
        if not FilePath(name).is_file():
            raise FileNotFoundError(f"font {name!r} is no file")
        return font_manager.FontProperties(fname=name)
    properties = font_manager.FontProperties(family=name)
    try:
        font_manager.findfont(properties, fallback_to_default=False)
    except ValueError:
        raise ValueError(f"font must be a family that matplotlib finds, or a file, got {name!r}") from None
    return properties


def _shape_of(path: Path, tolerance: float, argument: str) -> Shape:
    rings = list(_flattened(path, tolerance))
    if not all(np.isfinite(ring).all() for ring in rings):
        raise ValueError(f"{argument} must have finite corners")
    found = _rings.regions(rings)
    if not found:
        raise ValueError(f"{argument} must enclose something, got outlines without an inside")
    return union(*(polygon(region.outline, region.holes) for region in found))


def _flattened(path: Path, tolerance: float) -> Iterator[NDArray[np.float64]]:
    """Yield the subpaths as corners."""
    corners: list[NDArray[np.float64]] = []
    for numbers, code in path.iter_segments(simplify=False, curves=True, remove_nans=False):
        points = numbers.reshape(-1, 2)
        if code == path.MOVETO:
            if corners:
                yield np.concatenate(corners)
            corners = [points]
        elif code in (path.LINETO, path.CURVE3, path.CURVE4):
            corners.append(_edges(np.concatenate([corners[-1][-1:], points]), tolerance))
    if corners:
        yield np.concatenate(corners)


def _edges(control: NDArray[np.float64], tolerance: float) -> NDArray[np.float64]:
    """Return the corners after the first of edges along a Bézier curve of degree 1, 2 or 3.

    A chord over a share h of the parameter lies within h²/8·max ‖p″‖ of the curve, and p″ within the second differences
    of the control points, times the degree and one less.
    """
    degree = len(control) - 1
    if degree == 1:
        return control[1:]
    bends = np.linalg.norm(np.diff(control, 2, axis=0), axis=1).max() * degree * (degree - 1)
    count = max(1, math.ceil(math.sqrt(float(bends) / (8 * tolerance))))
    t = (np.arange(1, count + 1) / count)[:, None]
    points = np.broadcast_to(control[:, None], (degree + 1, count, 2))
    while len(points) > 1:
        points = points[:-1] * (1 - t) + points[1:] * t
    corners: NDArray[np.float64] = points[0]
    return corners
