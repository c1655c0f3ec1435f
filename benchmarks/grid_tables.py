"""What grid.py has measured as Markdown. tables.py puts it into the documentation."""

from typing import Any

_LEAST = 0.5
"""Nanoseconds that one run differs from the next by."""
_COLUMNS = ("shape", "isa", "places", "ns")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what grid.py writes."""
    for key in ("machine", "points", "lookups", "pictures"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    for index, row in enumerate(result["lookups"]):
        if missing := [column for column in _COLUMNS if column not in row]:
            raise ValueError(f"{name}: lookups[{index}]: {', '.join(missing)} missing")


def blocks(result: Any) -> dict[str, str]:
    """Return the text of every block by name."""
    return {"grid-lookups": _lookups(result), "grid-pictures": _pictures(result)}


def _table(heads: list[str], rows: list[list[str]]) -> str:
    lines = ["| " + " | ".join(heads) + " |", "|---" + "|---:" * (len(heads) - 1) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def _lookups(result: Any) -> str:
    """Return nanoseconds by shape, a column for each instruction set and kind of places."""
    columns = list(dict.fromkeys((row["isa"], row["places"]) for row in result["lookups"]))
    shapes = list(dict.fromkeys(row["shape"] for row in result["lookups"]))
    found = {(row["shape"], row["isa"], row["places"]): row["ns"] for row in result["lookups"]}
    rows = [[shape, *(_shown(found[shape, *column]) for column in columns)] for shape in shapes]
    return _table(["ns a point", *(f"{isa}, {places}" for isa, places in columns)], rows)


def _shown(ns: float) -> str:
    return f"{ns:.1f}" if ns >= _LEAST else f"< {_LEAST}"


def _pictures(result: Any) -> str:
    rows = [
        [row["shape"], f"{row['slope']:.2f}", f"{row['evaluations']:.1f}", f"{row['ms']:.1f}", f"{row['build_ms']:.0f}"]
        for row in result["pictures"]
    ]
    return _table(["ball", "slope", "evaluations a ray", "ms", "to build, ms"], rows)
