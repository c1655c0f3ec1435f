"""OpenEXR files: all planes of an `image.Image` and how it was made, written whole and read back checked.

Channels: R G B (linear), Z (depth along the ray), P.X P.Y P.Z, N.X N.Y N.Z as 32-bit floats; object_id, material_id,
steps and status as unsigned integers. Ids are stored plus one, so that 0 means none. One string attribute,
``octomarch``, holds the image's metadata and statistics as JSON, with a CRC-32 of each plane. The data window of a crop
is where it lies in the display window, the whole picture.
"""

from __future__ import annotations

import json
import os
import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._exr_chunks import ROWS, Checksums, chunks_of, parts_of, write_chunks
from octomarch._exr_layout import Layout, read_layout
from octomarch._files import atomic, temporary_name
from octomarch.image import Image
from octomarch.planes import PLANES, PlaneName

ATTRIBUTE = "octomarch"
"""Of the header: what is known of the picture, as `encoded` gives it."""
# Rec. ITU-R BT.709 primaries and white, x and y of each: what R G B mean.
_CHROMATICITIES = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
_PIXELS = 2**18  # of a part

Channels: TypeAlias = dict[str, NDArray[Any]]
Window: TypeAlias = tuple[int, int, int, int]
"""x, y, width, height."""


def write_exr(path: str | os.PathLike[str], image: Image) -> None:
    """Write all planes of an image, and how it was made, as an OpenEXR file with ZIP compression.

    The file appears whole or not at all. Planes of float64 are stored as float32.

    Parameters
    ----------
    path : str or path-like
        Any suffix; a file that is there is replaced.
    image : Image
        With at least one plane.

    Raises
    ------
    TypeError
        If `image` is no `Image`.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> image = om.render(om.sphere(1.0), size=(32, 24), planes=("color", "depth", "object_id"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "ball.exr")
    ...     om.write_exr(path, image)
    ...     om.read_exr(path)
    <Image 32×24: color, depth, object_id>
    """
    if not isinstance(image, Image):
        raise TypeError(f"image must be an om.Image, got {check.shown(image)}")
    check.path("path", path)
    import OpenEXR  # here, since it is not needed to render

    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "chromaticities": _CHROMATICITIES,
        "software": f"octomarch {_version()}",
    }
    sums = Checksums()
    for _, planes in _parts(image):
        sums.add(planes)
    text = encoded(image.metadata, image.stats, sums.of_planes())
    with atomic(path) as temporary:
        try:
            _write(temporary, temporary_name(Path(os.path.realpath(path))), image, {**header, ATTRIBUTE: text})
        except RuntimeError as error:
            raise OSError(f"cannot write {os.fspath(path)}: {error}") from error


def _write(path: Path, part: Path, image: Image, header: Mapping[str, Any]) -> None:
    """Write a file part by part, each in turn in `part`, so that Ctrl-C is heard while pixels are compressed."""
    import OpenEXR

    display, (x, y, _, _) = _windows(image)

    def written(window: Window, planes: Mapping[PlaneName, Channels]) -> Layout:
        windows = {"displayWindow": _corners(display), "dataWindow": _corners(window)}
        channels = {name: pixels for group in planes.values() for name, pixels in group.items()}
        OpenEXR.File({**header, **windows}, channels).write(os.fspath(part))
        return read_layout(os.fspath(part))

    def chunks(first: Layout, others: Iterator[tuple[Window, dict[PlaneName, Channels]]]) -> Iterator[bytes]:
        yield from chunks_of(part, first)
        for (left, top, width, height), planes in others:
            yield from chunks_of(part, written((x + left, y + top, width, height), planes))

    try:
        parts = _parts(image)
        (_, _, width, height), planes = next(parts)
        first = written((x, y, width, height), planes)
        window = struct.pack("<4i", x, y, x + width - 1, y + image.size[1] - 1)
        attributes = {**first.attributes, "dataWindow": ("box2i", window)}
        with path.open("wb") as out:
            write_chunks(out, attributes, image.size[1], chunks(first, parts))
    finally:
        part.unlink(missing_ok=True)


def _parts(image: Image) -> Iterator[tuple[Window, dict[PlaneName, Channels]]]:
    """Give the channels of all planes part by part, from the top."""
    width, height = image.size
    rows = max(1, _PIXELS // (ROWS * width)) * ROWS
    for window in parts_of((0, 0, width, height), rows):
        some = slice(window[1], window[1] + window[3])
        yield window, {name: _stored(name, getattr(image, name)[some]) for name in image.planes}


def read_exr(path: str | os.PathLike[str], *, verify: bool = True) -> Image:
    """Read an OpenEXR file, checked as far as the format allows.

    Parameters
    ----------
    path : str or path-like
        A scan-line file of one part, by octomarch or any other program.
    verify : bool
        Compare the pixels with the checksums that octomarch wrote. False reads what other programs have edited.

    Returns
    -------
    Image
        The planes whose channels there are, channels of other names passed over; ``metadata`` and ``stats`` as saved.

    Raises
    ------
    OSError
        Naming the path, and what is missing or wrong: if the file cannot be opened, is of another kind, truncated or
        damaged, or holds none of the planes.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "ball.exr")
    ...     om.render(om.sphere(1.0), size=(32, 24), planes=("depth",)).save(path)
    ...     om.read_exr(path).metadata["render"]["size"]
    [32, 24]
    """
    name, is_verified = check.path("path", path), check.flag("verify", verify)
    document, groups = read_channels(name, read_layout(name), verify=is_verified)
    arrays = {plane: _restored(name, plane, group) for plane, group in groups.items()}
    return Image(arrays, stats=document.get("stats"), metadata=document.get("metadata"))


def read_channels(
    path: str, layout: Layout, *, verify: bool = True
) -> tuple[dict[str, Any], dict[PlaneName, dict[str, NDArray[Any]]]]:
    """Return what `encoded` gave, and the channels of each plane, as `read_exr` does.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = str(pathlib.Path(folder, "ball.exr"))
    ...     om.render(om.sphere(1.0), size=(32, 24), planes=("depth",)).save(path)
    ...     document, planes = read_channels(path, read_layout(path))
    >>> list(planes["depth"]), planes["depth"]["Z"].shape
    (['Z'], (24, 32))
    """
    header, channels = _read(path, layout)
    document = _document(path, header)
    groups = _groups(path, layout, channels)
    expected = document.get("crc32")
    if verify and expected is not None:
        _verify(path, groups, expected)
    return document, groups


def encoded(metadata: Mapping[str, Any], stats: Mapping[str, Any], checksums: Mapping[str, int]) -> str:
    """Return what a file tells of its picture beside the pixels, and a CRC-32 of each plane.

    Examples
    --------
    >>> json.loads(encoded({}, {"rays": 12}, {"depth": 0}))["stats"]
    {'rays': 12}
    """
    document = {"version": _version(), "metadata": metadata, "stats": stats, "crc32": checksums}
    return json.dumps(_plain(document), ensure_ascii=False, separators=(",", ":"))


def read_document(path: str) -> dict[str, Any]:
    """Return what is known of the image in a file, without its pixels: what `encoded` gave, ``metadata`` and ``stats``.

    Raises
    ------
    OSError
        As `read_exr` does.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "ball.exr")
    ...     om.render(om.sphere(1.0), size=(32, 24)).save(path)
    ...     read_document(str(path))["metadata"]["camera"]["fov"]
    35.0
    """
    import OpenEXR

    read_layout(path)
    try:
        with OpenEXR.File(path, header_only=True) as file:
            header = dict(file.header())
    except (RuntimeError, ValueError, TypeError, MemoryError) as error:
        raise OSError(f"{path}: damaged EXR file: it cannot be decoded ({error})") from error
    return {"metadata": {}, "stats": {}, **_document(path, header)}


def _read(path: str, layout: Layout) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return header and channels, once all channels that the header lists are found to have come back whole."""
    import OpenEXR

    try:
        with OpenEXR.File(path, separate_channels=True) as file:
            header = dict(file.header())
            channels = {name: channel.pixels for name, channel in file.channels().items()}
    except (RuntimeError, ValueError, TypeError, MemoryError) as error:
        raise OSError(f"{path}: damaged EXR file: it cannot be decoded ({error})") from error
    kinds = {"uint": np.uint32, "half": np.float16, "float": np.float32}
    for name, kind in layout.channels.items():
        pixels = channels.get(name)
        if pixels is None or pixels.shape != (layout.height, layout.width) or pixels.dtype != kinds[kind]:
            raise OSError(f"{path}: damaged EXR file: the pixels of channel {name!r} cannot be decoded")
    return header, channels


def _document(path: str, header: Mapping[str, Any]) -> dict[str, Any]:
    text = header.get(ATTRIBUTE, "{}")
    try:
        document = json.loads(text)
    except (ValueError, TypeError, RecursionError) as error:
        raise OSError(f"{path}: damaged EXR file: the attribute {ATTRIBUTE!r} is no JSON ({error})") from error
    if not isinstance(document, dict) or not all(
        isinstance(document.get(key, {}), dict) for key in ("metadata", "stats", "crc32")
    ):
        raise OSError(f"{path}: damaged EXR file: the attribute {ATTRIBUTE!r} is not what octomarch writes")
    return document


def _groups(path: str, layout: Layout, channels: dict[str, NDArray[Any]]) -> dict[PlaneName, dict[str, NDArray[Any]]]:
    """Return the channels of each plane that there is."""
    groups: dict[PlaneName, dict[str, NDArray[Any]]] = {}
    for plane, spec in PLANES.items():
        present = [name for name in spec.channels if name in channels]
        if not present:
            continue
        missing = [name for name in spec.channels if name not in channels]
        if missing:
            raise OSError(f"{path}: {plane} is incomplete: there is no channel {', '.join(missing)}")
        for name in present:
            if (layout.channels[name] == "uint") == spec.is_float:
                raise OSError(f"{path}: channel {name!r} has the type {layout.channels[name]}")
        groups[plane] = {name: channels[name] for name in spec.channels}
    if not groups:
        raise OSError(f"{path}: none of its channels is a plane octomarch knows: {', '.join(layout.channels)}")
    return groups


def _verify(path: str, groups: Mapping[PlaneName, dict[str, NDArray[Any]]], expected: Mapping[str, int]) -> None:
    lost = [name for name in expected if name not in groups]
    if lost:
        raise OSError(f"{path}: the plane {', '.join(lost)} was written but is not there; verify=False reads the rest")
    for plane, group in groups.items():
        if _checksum(group) != expected.get(plane):
            raise OSError(
                f"{path}: the pixels of {plane} are not those that octomarch wrote: the file is damaged, or was edited "
                "by another program (verify=False reads it nonetheless)"
            )


def _windows(image: Image) -> tuple[Window, Window]:
    """Return the display window and the data window: of a crop where it lies in the whole, else twice the image's."""
    alone = (0, 0, *image.size)
    made = image.metadata.get("render")
    if not isinstance(made, Mapping) or made.get("crop") is None:
        return alone, alone
    try:
        whole = check.size(made.get("size"))
        x, y, width, height = check.crop(made["crop"], whole)
    except (TypeError, ValueError):
        return alone, alone
    if (width, height) != image.size:
        return alone, alone
    return (0, 0, *whole), (x, y, width, height)


def _corners(window: Window) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    x, y, width, height = window
    return np.array([x, y], np.int32), np.array([x + width - 1, y + height - 1], np.int32)


def _stored(name: PlaneName, array: NDArray[Any]) -> Channels:
    """Return the channels of a plane. Contiguous: the library writes anything else wrong without a word."""
    plane = PLANES[name]
    if plane.is_float:
        with np.errstate(over="ignore"):
            values = array.astype(np.float32)
    else:
        values = (array.astype(np.int64) + plane.stored_offset).astype(np.uint32)
    components = values.reshape(*values.shape[:2], len(plane.channels))
    return {channel: np.ascontiguousarray(components[..., i]) for i, channel in enumerate(plane.channels)}


def _restored(path: str, name: PlaneName, group: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    plane = PLANES[name]
    if plane.is_float:
        values = np.stack([channel.astype(np.float32) for channel in group.values()], axis=-1)
        return values if len(group) == 3 else values[..., 0]
    integers = group[plane.channels[0]].astype(np.int64) - plane.stored_offset
    if integers.max() > np.iinfo(plane.dtype).max:
        raise OSError(f"{path}: {name} holds {integers.max()}, more than there can be")
    return integers.astype(plane.dtype)


def _checksum(channels: Mapping[str, NDArray[Any]]) -> int:
    checksum = 0
    for channel in channels.values():
        checksum = zlib.crc32(np.ascontiguousarray(channel).data, checksum)
    return checksum


def _plain(value: Any) -> Any:
    """Return `value` with nothing in it that JSON lacks: numbers that are not finite become strings."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value


def _version() -> str:
    return _core.build_info()["version"]
