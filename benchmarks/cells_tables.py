"""What cells.py has measured as Markdown. tables.py puts it into the documentation."""

from typing import Any

_ASKED = ("case", "scattered", "lattice", "rays")
_COLUMNS = ("case", "instructions", "first", "next", "last", "clock", "whole", "evaluations", "cells", "bytes")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what cells.py writes."""
    for key in ("machine", "pictures", "rows", "queries"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    for index, row in enumerate(result["rows"]):
        if missing := [column for column in _COLUMNS if column not in row]:
            raise ValueError(f"{name}: rows[{index}]: {', '.join(missing)} missing")
    for index, row in enumerate(result["queries"]):
        if missing := [column for column in _ASKED if column not in row]:
            raise ValueError(f"{name}: queries[{index}]: {', '.join(missing)} missing")


def blocks(result: Any) -> dict[str, str]:
    """Return the text of every block by name."""
    return {"cells": _table(result), "cells-queries": _queries(result)}


def _ms(seconds: float | None) -> str:
    if seconds is None:
        return "–"
    return f"{seconds * 1e3:,.0f}"


def _table(result: Any) -> str:
    last = f"{result['pictures']}th"
    heads = ("", "instructions", "first picture", "next", last, "whole program", "evaluations, 10⁶", "MB", "MB then")
    lines = ["| " + " | ".join(heads) + " |", "|---" + "|---:" * (len(heads) - 1) + "|"]
    for row in result["rows"]:
        times = (_ms(row[key]) for key in ("first", "next", "last", "whole"))
        counts = (f"{count / 1e6:.1f}" for count in (row["evaluations"], *row["bytes"]))
        lines.append(f"| {row['case']} | {row['instructions']:,} | " + " | ".join([*times, *counts]) + " |")
    return "\n".join(lines)


def _queries(result: Any) -> str:
    lines = ["|  | scattered points | on a lattice | rays |", "|---|---:|---:|---:|"]
    for row in result["queries"]:
        times = (f"{_ms(row[name][0])}, then {_ms(row[name][1])}" for name in _ASKED[1:])
        lines.append(f"| {row['case']} | " + " | ".join(times) + " |")
    return "\n".join(lines)
