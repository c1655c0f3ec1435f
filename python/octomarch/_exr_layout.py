"""Checks that an EXR file is whole before the library reads it, which says nothing when pixels are missing.

`exr.read_exr` calls `read_layout` first. It parses the header and walks the table of chunks: every chunk must lie in
the file, belong to its rows and be large enough for the pixels that it claims. The format is described in "OpenEXR
File Layout" (Academy Software Foundation).
"""

from __future__ import annotations

import os
import struct
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO, TypeAlias

import numpy as np

_MAGIC = 20000630
_PIXEL_TYPES = {0: ("uint", 4), 1: ("half", 2), 2: ("float", 4)}
# Rows per chunk by compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
_ROWS = {0: 1, 1: 1, 2: 1, 3: 16, 4: 32, 5: 16, 6: 32, 7: 32, 8: 32, 9: 256}
_DEFLATED = (2, 3)
_DEFLATE_LIMIT = 1032  # of deflate: 258 bytes from a pair of one-bit codes


Attribute: TypeAlias = tuple[str, bytes]
"""Type and value, as the file holds them."""


@dataclass(frozen=True)
class Layout:
    """What a header promises: size in pixels and the type of each channel; and the parts of the file."""

    width: int
    height: int
    channels: dict[str, str]
    attributes: dict[str, Attribute]
    chunks: tuple[tuple[int, int], ...] = ()
    """First byte and number of bytes of each, from the top row."""


class _Reader:
    """Reads little-endian values, and says what is missing when the file ends."""

    def __init__(self, file: BinaryIO, path: str) -> None:
        self.file, self.path = file, path
        self.length = os.fstat(file.fileno()).st_size

    def error(self, what: str) -> OSError:
        return OSError(f"{self.path}: damaged EXR file: {what}")

    def take(self, count: int, what: str) -> bytes:
        # Asked first, since a damaged count would allocate memory beyond the length of the file.
        remaining = self.length - self.file.tell()
        data = self.file.read(count) if 0 <= count <= remaining else b""
        if len(data) != count:
            raise self.error(f"it ends after {self.length} bytes, in {what}")
        return data

    def integers(self, count: int, what: str) -> tuple[int, ...]:
        return struct.unpack(f"<{count}i", self.take(4 * count, what))

    def text(self, what: str) -> str:
        data = bytearray()
        while (byte := self.take(1, what)) != b"\0":
            data += byte
            if len(data) > 255:
                raise self.error(f"a name longer than 255 bytes in {what}")
        return data.decode("utf-8", "replace")


def read_layout(path: str) -> Layout:
    """Return the layout of a whole scan-line EXR file of one part.

    Raises
    ------
    OSError
        Naming the path: if the file cannot be opened, is of another kind, is truncated or damaged.
    """
    with Path(path).open("rb") as file:
        reader = _Reader(file, path)
        if reader.length == 0:
            raise reader.error("it is empty")
        if struct.unpack("<i", reader.take(4, "the magic number"))[0] != _MAGIC:
            raise OSError(f"{path}: not an OpenEXR file")
        version = reader.integers(1, "the version")[0]
        if version & 0xFF != 2 or version & ~0x6FF:
            raise OSError(f"{path}: only EXR files of one part without deep data can be read")
        if version & 0x200:
            raise OSError(f"{path}: only scan-line EXR files can be read, this one is tiled")
        attributes = _attributes(reader)
        layout, compression, first_row = _header(reader, attributes)
        return replace(layout, chunks=_checked_chunks(reader, layout, compression, first_row))


def _attributes(reader: _Reader) -> dict[str, Attribute]:
    attributes: dict[str, Attribute] = {}
    while name := reader.text("the header"):
        kind = reader.text("the header")
        count = reader.integers(1, "the header")[0]
        attributes[name] = kind, reader.take(count, f"the header's attribute {name!r}")
    return attributes


def _header(reader: _Reader, attributes: dict[str, Attribute]) -> tuple[Layout, int, int]:
    """Return the layout, the compression and the number of the first row."""
    for name, count in {"channels": None, "compression": 1, "dataWindow": 16}.items():
        if name not in attributes or (count is not None and len(attributes[name][1]) != count):
            raise reader.error(f"the header's attribute {name!r} is missing or of a wrong length")
    compression = attributes["compression"][1][0]
    if compression not in _ROWS:
        raise OSError(f"{reader.path}: unknown EXR compression {compression}")
    x_min, y_min, x_max, y_max = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x_max - x_min + 1, y_max - y_min + 1
    if not (1 <= width < 2**31 and 1 <= height < 2**31):
        raise reader.error(f"a size of {width}×{height} pixels")
    return Layout(width, height, _channels(reader, attributes["channels"][1]), attributes), compression, y_min


def _channels(reader: _Reader, data: bytes) -> dict[str, str]:
    channels: dict[str, str] = {}
    at = 0
    while at < len(data) and data[at] != 0:
        end = data.find(b"\0", at)
        if end < 0 or end + 17 > len(data):
            raise reader.error("the list of channels is cut")
        name = data[at:end].decode("utf-8", "replace")
        kind, _, x_step, y_step = struct.unpack("<4i", data[end + 1 : end + 17])
        if kind not in _PIXEL_TYPES:
            raise reader.error(f"channel {name!r} has the unknown type {kind}")
        if (x_step, y_step) != (1, 1):
            raise OSError(f"{reader.path}: channel {name!r} is subsampled, which cannot be read")
        channels[name] = _PIXEL_TYPES[kind][0]
        at = end + 17
    if not channels:
        raise reader.error("it has no channels")
    return channels


def _checked_chunks(reader: _Reader, layout: Layout, compression: int, first_row: int) -> tuple[tuple[int, int], ...]:
    rows = _ROWS[compression]
    count = -(-layout.height // rows)
    table = reader.take(8 * count, f"the table of {count} chunks for {layout.width}×{layout.height} pixels")
    first_byte = reader.file.tell()
    sizes = dict(_PIXEL_TYPES.values())
    chunks = []
    row_bytes = layout.width * sum(sizes[kind] for kind in layout.channels.values())
    for index, offset in enumerate(np.frombuffer(table, dtype="<u8").tolist()):
        what = f"chunk {index + 1} of {count}"
        if not first_byte <= offset < reader.length:
            raise reader.error(f"it has {reader.length} bytes, and {what} at byte {offset}")
        reader.file.seek(offset)
        row, size = reader.integers(2, what)
        raw = row_bytes * min(rows, layout.height - index * rows)
        if row != first_row + index * rows:
            raise reader.error(f"{what} is not where the table says")
        if not 0 < size <= raw or (compression in _DEFLATED and size < raw and size * _DEFLATE_LIMIT + 64 < raw):
            raise reader.error(f"{what} has {size} bytes for {raw} bytes of pixels")
        if offset + 8 + size > reader.length:
            missing = offset + 8 + size - reader.length
            raise reader.error(f"it ends after {reader.length} bytes, {missing} bytes short of the end of {what}")
        chunks.append((offset, 8 + size))
    return tuple(chunks)
