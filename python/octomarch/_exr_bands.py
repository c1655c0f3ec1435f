"""Joins EXR files of the bands of one picture to one of the whole, without holding it in memory.

Pixels are compressed in chunks of some rows, each of which names its first row, and bands are whole numbers of chunks:
so the chunks of the whole are those of the bands, and only the header and the table of chunks are new. `bands` renders
the files, `exr` reads and writes the format, `_exr_layout` knows where chunks lie.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from octomarch._exr_layout import Attribute, Layout, read_layout
from octomarch._files import atomic
from octomarch.exr import ATTRIBUTE, encoded, read_channels
from octomarch.planes import PLANES, PlaneName

ROWS = 16
"""Of which the height of each band must be a multiple, the last excepted: as ZIP takes them."""

_POLYNOMIAL = 0xEDB88320  # of CRC-32, reflected: the highest bit stands for x⁰

Metadata = Mapping[str, Any]


def join(
    path: Path, bands: Sequence[Path], metadata: Callable[[Metadata], Metadata], poll: Callable[[], None] = lambda: None
) -> None:
    """Write the file of which these are the bands, from the top, once all their pixels are found to be sound.

    Parameters
    ----------
    path : path
        A file that is there is replaced.
    bands : sequence of path
        Files that `octomarch.write_exr` wrote of crops that adjoin.
    metadata : callable
        Makes the whole's metadata of the first band's.
    poll : callable
        Called between bands; what it raises ends the work.

    Raises
    ------
    OSError
        If a band is missing or damaged, or the file cannot be written.
    """
    layouts: list[Layout] = []
    sums = _Checksums()
    told: list[Metadata] = []
    for band in bands:
        poll()
        layouts.append(read_layout(os.fspath(band)))
        document, planes = read_channels(os.fspath(band), layouts[-1])
        sums.add(planes)
        told.append(document)
    stats = summed([document.get("stats", {}) for document in told])
    text = encoded(metadata(told[0].get("metadata", {})), stats, sums.of_planes())
    attributes = {
        **layouts[0].attributes,
        ATTRIBUTE: ("string", text.encode()),
        "dataWindow": ("box2i", _window(layouts)),
    }
    with atomic(path) as temporary, temporary.open("wb") as out:
        _write_header(out, bands[0], attributes)
        sizes = [size for layout in layouts for _, size in layout.chunks]
        offset = out.tell() + 8 * len(sizes)
        for size in sizes:
            out.write(struct.pack("<Q", offset))
            offset += size
        for band, layout in zip(bands, layouts, strict=True):
            poll()
            with band.open("rb") as file:
                for first, size in layout.chunks:
                    file.seek(first)
                    out.write(file.read(size))


def summed(stats: Sequence[Metadata]) -> dict[str, Any]:
    """Return what a picture cost by what its bands did.

    Examples
    --------
    >>> summed([{"rays": 3, "packets": 1, "occupancy": 0.5}, {"rays": 4, "packets": 3, "occupancy": 1.0}])
    {'rays': 7, 'packets': 4, 'occupancy': 0.875}
    """
    result: dict[str, Any] = {}
    packets = [max(band.get("packets", 0), 1) for band in stats]
    for name, first in stats[0].items():
        values = [band.get(name, first) for band in stats]
        if name == "occupancy":
            result[name] = sum(n * value for n, value in zip(packets, values, strict=True)) / sum(packets)
        elif name in ("threads", "cells", "cell_bytes"):
            result[name] = max(values)
        elif isinstance(first, str):
            result[name] = ", ".join(dict.fromkeys(values))
        else:
            result[name] = sum(values)
    return result


class _Checksums:
    """CRC-32 of all channels of planes whose rows come band by band."""

    def __init__(self) -> None:
        self._sums: dict[str, int] = {}
        self._bytes: dict[str, int] = {}
        self._planes: tuple[PlaneName, ...] = ()

    def add(self, planes: Mapping[PlaneName, Mapping[str, Any]]) -> None:
        self._planes = tuple(planes)
        for channels in planes.values():
            for name, pixels in channels.items():
                self._sums[name] = zlib.crc32(pixels.data, self._sums.get(name, 0))
                self._bytes[name] = self._bytes.get(name, 0) + pixels.nbytes

    def of_planes(self) -> dict[str, int]:
        """Return the sum of each plane: of its channels, one after the other."""
        result: dict[str, int] = {}
        for plane in self._planes:
            total = 0
            for channel in PLANES[plane].channels:
                total = crc32_of_both(total, self._sums[channel], self._bytes[channel])
            result[plane] = total
        return result


def crc32_of_both(first: int, second: int, length: int) -> int:
    """Return the CRC-32 of two texts one after the other, from that of each and the number of bytes of the second.

    The first counts for as much as it does when `length` zero bytes follow: it is multiplied by x to the 8 `length`,
    modulo the polynomial, as in zlib's ``crc32_combine``.

    Examples
    --------
    >>> crc32_of_both(zlib.crc32(b"ray "), zlib.crc32(b"marcher"), 7) == zlib.crc32(b"ray marcher")
    True
    """
    square, power, exponent = 1 << 30, 1 << 31, 8 * length  # x, 1
    while exponent:
        if exponent & 1:
            power = _product(power, square)
        square = _product(square, square)
        exponent >>= 1
    return _product(power, first) ^ second


def _product(a: int, b: int) -> int:
    """Return the product of two polynomials over GF(2) modulo that of CRC-32."""
    result = 0
    for bit in range(31, -1, -1):
        if a >> bit & 1:
            result ^= b
        b = b >> 1 ^ (_POLYNOMIAL if b & 1 else 0)
    return result


def _window(layouts: Sequence[Layout]) -> bytes:
    x_min, y_min, x_max, _ = struct.unpack("<4i", layouts[0].attributes["dataWindow"][1])
    return struct.pack("<4i", x_min, y_min, x_max, y_min + sum(layout.height for layout in layouts) - 1)


def _write_header(out: BinaryIO, like: Path, attributes: Mapping[str, Attribute]) -> None:
    with like.open("rb") as file:
        out.write(file.read(8))  # magic number and version
    for name, (kind, value) in attributes.items():
        out.write(name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value)
    out.write(b"\0")


def bands_of(window: tuple[int, int, int, int], rows: int) -> Iterator[tuple[int, int, int, int]]:
    """Give the bands of a window, of so many rows, from the top.

    Examples
    --------
    >>> list(bands_of((5, 10, 640, 40), 16))
    [(5, 10, 640, 16), (5, 26, 640, 16), (5, 42, 640, 8)]
    """
    x, y, width, height = window
    for first in range(0, height, rows):
        yield x, y + first, width, min(rows, height - first)
