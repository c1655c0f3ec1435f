"""Writes an EXR file chunk by chunk, as they come from files of its parts; and the checksums of what comes so.

Pixels are compressed in chunks of some rows, each of which names its first row, so the chunks of a picture are those of
its parts, where these are whole numbers of chunks. `exr` writes large images so, `_exr_bands` joins files of bands.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from octomarch._exr_layout import Attribute, Layout
from octomarch.planes import PLANES, PlaneName

ROWS = 16
"""Of which the height of each part must be a multiple, the last excepted: as ZIP takes them."""

_HEAD = struct.pack("<2i", 20000630, 2)  # magic number and version, of a scan-line file of one part
_POLYNOMIAL = 0xEDB88320  # of CRC-32, reflected: the highest bit stands for x⁰


def write_chunks(out: BinaryIO, attributes: Mapping[str, Attribute], height: int, chunks: Iterable[bytes]) -> None:
    """Write a file of `height` rows, whose chunks come from the top."""
    out.write(_HEAD)
    for name, (kind, value) in attributes.items():
        out.write(name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value)
    out.write(b"\0")
    table = out.tell()
    out.write(bytes(8 * -(-height // ROWS)))  # their places, which are known at the end
    places = []
    for chunk in chunks:
        places.append(out.tell())
        out.write(chunk)
    out.seek(table)
    out.write(struct.pack(f"<{len(places)}Q", *places))


def chunks_of(path: Path, layout: Layout) -> Iterator[bytes]:
    """Give the chunks of a file from the top."""
    with path.open("rb") as file:
        for first, size in layout.chunks:
            file.seek(first)
            yield file.read(size)


def parts_of(window: tuple[int, int, int, int], rows: int) -> Iterator[tuple[int, int, int, int]]:
    """Give the parts of a window (x, y, width, height), of so many rows, from the top.

    Examples
    --------
    >>> list(parts_of((5, 10, 640, 40), 16))
    [(5, 10, 640, 16), (5, 26, 640, 16), (5, 42, 640, 8)]
    """
    x, y, width, height = window
    for first in range(0, height, rows):
        yield x, y + first, width, min(rows, height - first)


class Checksums:
    """CRC-32 of all channels of planes whose rows come part by part."""

    def __init__(self) -> None:
        self._sums: dict[str, int] = {}
        self._bytes: dict[str, int] = {}
        self._planes: tuple[PlaneName, ...] = ()

    def add(self, planes: Mapping[PlaneName, Mapping[str, Any]]) -> None:
        """Add the rows of a part."""
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
