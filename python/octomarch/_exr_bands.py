"""Joins EXR files of the bands of one picture to one of the whole, without holding it in memory.

The chunks of the whole are those of the bands (`_exr_chunks`), and only the header and the table of chunks are new.
`bands` renders the files, `exr` reads and writes the format, `_exr_layout` knows where chunks lie.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from octomarch._exr_chunks import Checksums, chunks_of, write_chunks
from octomarch._exr_layout import Layout, read_layout
from octomarch._files import atomic
from octomarch.exr import ATTRIBUTE, encoded, read_channels

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
    sums = Checksums()
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

    def chunks() -> Iterator[bytes]:
        for band, layout in zip(bands, layouts, strict=True):
            poll()
            yield from chunks_of(band, layout)

    with atomic(path) as temporary, temporary.open("wb") as out:
        write_chunks(out, attributes, sum(layout.height for layout in layouts), chunks())


def summed(stats: Sequence[Metadata]) -> dict[str, Any]:
    """Return what a picture cost by what its bands did.

    Examples
    --------
    >>> summed([{"evaluations": 4, "occupancy": 0.5}, {"evaluations": 12, "occupancy": 1.0}])
    {'evaluations': 16, 'occupancy': 0.8}
    """
    result: dict[str, Any] = {}
    for name, first in stats[0].items():
        values = [band.get(name, first) for band in stats]
        if isinstance(first, Mapping):
            result[name] = summed(values)
        elif name == "occupancy":
            lanes = sum(band["evaluations"] / band[name] for band in stats if band["evaluations"])
            result[name] = sum(band["evaluations"] for band in stats) / lanes if lanes else 1.0
        elif name in ("threads", "cells", "cell_bytes"):
            result[name] = max(values)
        elif isinstance(first, str):
            result[name] = ", ".join(dict.fromkeys(values))
        else:
            result[name] = sum(values)
    return result


def _window(layouts: Sequence[Layout]) -> bytes:
    x_min, y_min, x_max, _ = struct.unpack("<4i", layouts[0].attributes["dataWindow"][1])
    return struct.pack("<4i", x_min, y_min, x_max, y_min + sum(layout.height for layout in layouts) - 1)
