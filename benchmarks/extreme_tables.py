"""What extremes.py has measured as Markdown. tables.py puts it into the documentation."""

from typing import Any

Result = dict[str, Any]

_COLUMNS = {
    "offsets": ("precision", "offset", "hits", "lost", "depth_p50", "depth_p99", "degrees_p95"),
    "distances": ("precision", "ball", "distance", "missed", "off_p50", "off_p95", "off_most", "depth_unit"),
    "grazing": ("degrees", "formula", "plain", "auto", "status", "height"),
    "bounds": ("shape", "least", "p50", "most"),
    "differences": ("precision", "normals", "step", "degrees_p95"),
}
_FOLDS = ("order", "one_cell_share", "one_cell_most", "ours_most")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what extremes.py writes."""
    for key in (*_COLUMNS, "folds"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    for key, columns in _COLUMNS.items():
        for index, row in enumerate(result[key]):
            if missing := [column for column in columns if column not in row]:
                raise ValueError(f"{name}: {key}[{index}]: {', '.join(missing)} missing")
    if missing := [key for key in _FOLDS if key not in result["folds"]]:
        raise ValueError(f"{name}: folds: {', '.join(missing)} missing")


def blocks(result: Result) -> dict[str, str]:
    """Return the text of every block by name."""
    return {
        "extremes-offsets": _offsets(result["offsets"]),
        "extremes-distances": _distances(result["distances"]),
        "extremes-grazing": _grazing(result["grazing"]),
        "extremes-bounds": _bounds(result["bounds"]),
        "extremes-differences": _differences(result["differences"]),
        "extremes-folds": _folds(result["folds"]),
    }


def _table(head: list[str], rows: list[list[str]]) -> str:
    ruler = "|---" + "|---:" * (len(head) - 1) + "|"
    return "\n".join(["| " + " | ".join(head) + " |", ruler, *("| " + " | ".join(row) + " |" for row in rows)])


def _power(number: float) -> str:
    """Return 0, or a number as a power of ten."""
    return f"{number:.0e}".replace("e+0", "e").replace("e+", "e") if number else "0"


def _offsets(rows: list[Result]) -> str:
    head = ["", "offset", "hits lost", "depth p50", "p99", "normals p95"]
    return _table(
        head,
        [
            [
                row["precision"],
                _power(row["offset"]),
                f"{row['lost']} of {row['hits']:,}",
                f"{row['depth_p50']:.1e}",
                f"{row['depth_p99']:.1e}",
                f"{row['degrees_p95']:.1e}°",
            ]
            for row in rows
        ],
    )


def _distances(rows: list[Result]) -> str:
    head = ["", "distance", "missed", "off the surface p50", "p95", "most", "unit of depth there"]
    return _table(
        head,
        [
            [
                f"{row['precision']}, {row['ball']}",
                _power(row["distance"]),
                str(row["missed"]),
                f"{row['off_p50']:.1e}",
                f"{row['off_p95']:.1e}",
                f"{row['off_most']:.1e}",
                f"{row['depth_unit']:.1e}",
            ]
            for row in rows
        ],
    )


def _grazing(rows: list[Result]) -> str:
    head = ["angle", "ln(h/ε)/−ln(1 − sin)", "steps, plain", "auto", "after 256 plain steps", "height left"]
    return _table(
        head,
        [
            [
                f"{row['degrees']:g}°",
                f"{row['formula']:,.0f}",
                f"{row['plain']:,}",
                f"{row['auto']:,}",
                f"`{row['status']}`",
                f"{row['height']:.1e}",
            ]
            for row in rows
        ],
    )


def _bounds(rows: list[Result]) -> str:
    head = ["", "least", "median", "most"]
    return _table(head, [[row["shape"], *(f"{row[key]:.3f}" for key in ("least", "p50", "most"))] for row in rows])


def _differences(rows: list[Result]) -> str:
    steps = sorted({row["step"] for row in rows if row["step"] is not None}, reverse=True)
    head = ["degrees, p95", "", *(f"step {_power(step)}" for step in steps)]
    own: dict[tuple[str, str], dict[float | None, float]] = {}
    for row in rows:
        own.setdefault((row["precision"], row["normals"]), {})[row["step"]] = row["degrees_p95"]
    lines = []
    for names, found in own.items():
        wanted = [None] if None in found else steps  # exact ones take no step
        cells = [f"{found[step]:.1e}" for step in wanted]
        lines.append([*names, *cells, *[""] * (len(steps) - len(cells))])
    return _table(head, lines)


def _folds(folds: Result) -> str:
    order, most, ours = f"{folds['order']:.3f}", f"{folds['one_cell_most']:.2f}", _power(folds["ours_most"])
    return (
        f"Folding three shapes with k = 0.3 in the other order changes a smooth union by up to {order}. A repeat\n"
        f"that looked at the nearest cell alone would say too much at {folds['one_cell_share']:.0%} of the points\n"
        f"around some content that is not symmetric, by up to {most} of a period; octomarch's says too much by\n"
        f"{ours} at the most."
    )
