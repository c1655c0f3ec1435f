"""What sweep.py keeps, as numbers for tables and plots: rows by what they are of, medians, ratios of paired rounds.

sweep_tables.py and sweep_plots.py come after it. octomarch is not needed.
"""

from typing import Any

import numpy as np

Result = dict[str, Any]
Row = dict[str, Any]

_TIMES = ("cpu", "wall")
COLUMNS = {
    "methods": ("scene", "n", "method", "evaluations", "error"),
    "isas": ("scene", "mode", "isa", "precision", "evaluations", "error"),
    "threads": ("scene", "n", "threads"),
    "balls": ("n", "picture", "evaluations", "cells", "cell_bytes"),
    "resolution": ("scene", "n", "mode", "side", "extra_bytes"),
    "features": ("feature", "over", "evaluations", "off_pairs", "different_counts", "different_pixels"),
    "gradients": ("scene", "n", "isa", "asked", "points"),
    "building": ("shapes", "n", "stage", "megabytes", "instructions"),
}


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what sweep.py writes."""
    for key in ("machine", "settings", "rows"):
        if not isinstance(result, dict) or not isinstance(result.get(key), dict):
            raise ValueError(f"{name}: {key!r} is missing or not a dict")
    for sweep, rows in result["rows"].items():
        if sweep not in COLUMNS:
            raise ValueError(f"{name}: rows: unknown sweep {sweep!r}")
        for index, row in enumerate(rows):
            if missing := [key for key in (*COLUMNS[sweep], *_TIMES) if key not in row]:
                raise ValueError(f"{name}: rows.{sweep}[{index}]: {', '.join(missing)} missing")
            if not (row["cpu"] and len(row["cpu"]) == len(row["wall"])):
                raise ValueError(f"{name}: rows.{sweep}[{index}]: cpu and wall must be as long, and not empty")


def where(rows: list[Row], **wanted: Any) -> list[Row]:
    """Return the rows that have these values."""
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def one(rows: list[Row], **wanted: Any) -> Row | None:
    return next(iter(where(rows, **wanted)), None)


def values(rows: list[Row], key: str) -> list[Any]:
    """Return the different values of a column in the order in which they come."""
    return list(dict.fromkeys(row[key] for row in rows))


def median(row: Row, clock: str = "cpu") -> float:
    """Return milliseconds."""
    return float(np.median(row[clock]))


def ratio(slower: Row, faster: Row, clock: str = "cpu") -> float:
    """Return how many times as long one takes as the other: the median over rounds that both have."""
    rounds = min(len(slower[clock]), len(faster[clock]))
    return float(np.median(np.divide(slower[clock][:rounds], faster[clock][:rounds])))


def added(row: Row, over: Row | None) -> tuple[float, float, float]:
    """Return milliseconds that a picture takes more than another, or than none: median and quartiles over rounds."""
    rounds = min(len(row["cpu"]), len(over["cpu"])) if over else len(row["cpu"])
    low, middle, high = np.percentile(
        np.subtract(row["cpu"][:rounds], over["cpu"][:rounds] if over else 0.0), [25, 50, 75]
    )
    return float(middle), float(low), float(high)


def total(row: Row) -> float:
    """Return all evaluations of the field per pixel."""
    return float(sum(row["evaluations"].values())) - others(row)


def others(row: Row) -> float:
    """Return evaluations per pixel of object ids, materials and skies."""
    return float(sum(row["evaluations"][kind] for kind in ("objects", "materials", "sky")))


def marched(row: Row) -> float:
    """Return evaluations per pixel until its ray has arrived, those of its cone included."""
    return float(row["evaluations"]["primary"] + row["evaluations"]["cones"])


def scene_title(row: Row) -> str:
    return f"{row['scene']}, {row['n']:,} balls" if row["n"] else str(row["scene"])
