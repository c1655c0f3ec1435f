"""`Image`: the planes of a rendered picture, and how they are shown and saved.

`render` makes images, `exr.read_exr` reads them back; colours are linear in memory and in EXR, sRGB in PNG.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal, Never

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch import colormaps, png
from octomarch._files import atomic
from octomarch.planes import PLANES, PlaneName
from octomarch.queries import Floats


class Image:
    """Planes of a picture, each an array of shape (height, width) or (height, width, 3), row 0 at the top.

    A plane that was not rendered raises `AttributeError` that says how to ask for it.

    Parameters
    ----------
    planes : mapping of str to ndarray
        At least one, named as the attributes below.
    stats, metadata : mapping, optional
        What the render counted, and what it was made from.

    Raises
    ------
    TypeError, ValueError
        If a name is unknown, or an array has a wrong shape or type.

    Examples
    --------
    >>> import octomarch as om
    >>> image = om.render(om.sphere(1.0), size=(64, 48), planes=("color", "depth"))
    >>> image
    <Image 64×48: color, depth>
    >>> image.normal
    Traceback (most recent call last):
    AttributeError: normal was not rendered: add 'normal' to planes=... of om.render()
    """

    color: Floats
    """Linear RGB (height, width, 3). Rays that start inside are black, and so are invalid ones; a ray that ran out of
    steps over a surface that faces away shows the sky."""
    depth: Floats
    """Distance along the ray (height, width) in scene units; +inf where nothing is met, and the march's min_distance
    where the ray begins inside."""
    position: Floats
    """Points met (height, width, 3), world frame; 0 where nothing is met."""
    normal: Floats
    """Unit normals (height, width, 3), world frame, outward; 0 where nothing is met."""
    object_id: NDArray[np.int32]
    """Index in `Program.objects` (height, width); -1 where nothing is met."""
    material_id: NDArray[np.int32]
    """Index in `Program.materials` (height, width); -1 where nothing is met."""
    steps: NDArray[np.int32]
    """Evaluations of the field spent on each primary ray (height, width); those of cones are in `stats`."""
    status: NDArray[np.uint8]
    """What became of each primary ray (height, width): see `Status`."""
    planes: tuple[PlaneName, ...]
    """Names of the planes that there are."""
    size: tuple[int, int]
    """(width, height)."""
    stats: dict[str, Any]
    """What the picture cost: counts of rays, evaluations, instructions and packets, how full the lanes were, the
    octree's ``cells`` and ``cell_bytes``, seconds; and the same of each stage by itself, in ``stages``."""

    def __init__(
        self,
        planes: Mapping[PlaneName, NDArray[Any]],
        *,
        stats: Mapping[str, Any] | None = None,
        metadata: Mapping[str, Any] | Callable[[], Mapping[str, Any]] | None = None,
    ) -> None:
        if not isinstance(planes, Mapping):
            raise TypeError(f"planes must be arrays by the name of their plane, got {check.shown(planes)}")
        arrays = {name: _plane(name, planes[name]) for name in check.planes(list(planes), tuple(PLANES))}
        extents = {array.shape[:2] for array in arrays.values()}
        if len(extents) > 1:
            raise ValueError(f"planes must have one (height, width), got {sorted(extents)}")
        height, width = extents.pop()
        self.size = (int(width), int(height))
        self.planes = tuple(arrays)
        self.stats = dict(stats or {})
        self._metadata = metadata
        for name, array in arrays.items():
            setattr(self, name, array)

    @property
    def metadata(self) -> dict[str, Any]:
        """How to make the picture again, as plain data: scene, camera, settings. Described when first asked for."""
        if not isinstance(self._metadata, dict):
            described = self._metadata() if callable(self._metadata) else self._metadata
            self._metadata = dict(described or {})
        return self._metadata

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_metadata": self.metadata}  # described now: what describes it cannot travel

    def __getattr__(self, name: str) -> Never:
        if name in PLANES:
            raise AttributeError(f"{name} was not rendered: add {name!r} to planes=... of om.render()")
        raise AttributeError(f"Image has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"<Image {self.size[0]}×{self.size[1]}: {', '.join(self.planes)}>"

    def to_srgb(self) -> NDArray[np.uint8]:
        """Return the colours as 8-bit sRGB, shape (height, width, 3): clipped to [0, 1] and rounded to nearest.

        Examples
        --------
        >>> import numpy as np, octomarch as om
        >>> om.Image({"color": np.full((1, 1, 3), 0.5)}).to_srgb().tolist()
        [[[188, 188, 188]]]
        """
        return png.levels(self.color)

    def to_png_bytes(self) -> bytes:
        """Return the colours as a PNG file of 8-bit sRGB.

        Examples
        --------
        >>> import octomarch as om
        >>> om.render(om.sphere(1.0), size=(32, 24)).to_png_bytes()[1:4]
        b'PNG'
        """
        return png.png_bytes(self.to_srgb())

    def false_color(
        self,
        plane: Literal["depth", "object_id", "material_id", "steps", "status"] = "steps",
        map: Literal["perceptual", "iterations"] = "perceptual",  # noqa: A002
        vmin: float | None = None,
        vmax: float | None = None,
    ) -> NDArray[np.float32]:
        """Colour the numbers of a plane.

        Parameters
        ----------
        plane : {"depth", "object_id", "material_id", "steps", "status"}
            Which has to be there.
        map : {"perceptual", "iterations"}
            By `octomarch.colormap`, or by `octomarch.iteration_colors`, for planes of integers ≥ 0.
        vmin, vmax : float, optional
            Limits of the perceptual map; None: those of the finite values.

        Returns
        -------
        ndarray of float32, shape (height, width, 3)
            Linear RGB, for `octomarch.write_png` or an image of its own.

        Raises
        ------
        AttributeError
            If the plane was not rendered.
        TypeError, ValueError
            If a name is unknown, the plane's numbers are not for this map, or it has no limits and there are some.

        Examples
        --------
        >>> import octomarch as om
        >>> image = om.render(om.sphere(1.0), size=(64, 48), planes=("depth", "steps"))
        >>> om.Image({"color": image.false_color("steps", "iterations")})
        <Image 64×48: color>
        """
        scalars = [name for name, plane in PLANES.items() if len(plane.channels) == 1]
        values = getattr(self, check.choice("plane", plane, scalars))
        if check.choice("map", map, ("perceptual", "iterations")) == "perceptual":
            return colormaps.colormap(values, vmin, vmax)
        for name, limit in {"vmin": vmin, "vmax": vmax}.items():
            if limit is not None:
                raise ValueError(f"{name} must be None for the map 'iterations', got {check.shown(limit)}")
        return colormaps.iteration_colors(values)

    def _repr_png_(self) -> bytes | None:
        """Show the colours in notebooks, or what else there is to be seen."""
        from octomarch import looks  # here, since it builds on this module

        plane = looks.default_plane(self)
        return None if plane is None else png.png_bytes(looks.look(self, plane))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save as OpenEXR (all planes and how they were made) or PNG (the colours), by the suffix of `path`.

        Both hold the scene, the camera and the settings, where they are not too large: `octomarch.load` and
        `Shot.load` find them there. The file appears whole or not at all: an interrupted or failed save leaves what was
        there before.

        Parameters
        ----------
        path : str or path-like
            Ends in ``.exr`` or ``.png``.

        Raises
        ------
        ValueError
            If the suffix is another.
        AttributeError
            If a PNG is asked for and the colours were not rendered.
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> import octomarch as om, pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     om.render(om.sphere(1.0), size=(32, 24)).save(pathlib.Path(folder, "ball.png"))
        """
        name = check.path("path", path)
        suffix = Path(name).suffix.lower()
        if suffix == ".exr":
            from octomarch.exr import write_exr  # here, since exr builds on this module

            write_exr(path, self)
        elif suffix == ".png":
            texts = {png.DOCUMENT: self.metadata.get("document"), png.DIGEST: self.metadata.get("digest")}
            data = png.png_bytes(self.to_srgb(), {key: text for key, text in texts.items() if isinstance(text, str)})
            with atomic(path) as temporary:
                temporary.write_bytes(data)
        else:
            raise ValueError(f"path must end in .exr or .png, got {check.shown(name)}")


def _plane(name: PlaneName, value: NDArray[Any]) -> NDArray[Any]:
    """Return `value` in the type of the plane, once its shape is found right."""
    plane, array = PLANES[name], np.asarray(value)
    components = array.shape[2:]
    if array.ndim < 2 or 0 in array.shape or components != ((3,) if len(plane.channels) == 3 else ()):
        expected = "(height, width, 3)" if len(plane.channels) == 3 else "(height, width)"
        raise ValueError(f"{name} must have shape {expected}, got {array.shape}")
    if array.dtype.kind not in ("fiu" if plane.is_float else "iu"):
        raise TypeError(f"{name} must hold {plane.dtype} numbers, got dtype {array.dtype}")
    if plane.is_float:
        return array if array.dtype in (np.float32, np.float64) else array.astype(np.float32)
    limits = np.iinfo(plane.dtype)
    lowest, highest = max(int(limits.min), -plane.stored_offset), limits.max
    if array.min() < lowest or array.max() > highest:
        raise ValueError(f"{name} must lie in [{lowest}, {highest}], got {array.min()} to {array.max()}")
    return array.astype(plane.dtype, copy=False)
