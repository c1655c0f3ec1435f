"""What meshing.py has measured as Markdown. tables.py puts it into the documentation."""

from typing import Any

Row = dict[str, Any]

_HEAD = (
    "| shape | cells | triangles | evaluations for cells | of a dense grid's | for vertices | processor time, s "
    "| dense | MB | dense |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
)
_KEYS = ("shape", "way", "resolution", "triangles", "evaluations", "cell_evaluations", "cpu_seconds", "megabytes")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what meshing.py writes."""
    for key in ("machine", "rows"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    for index, row in enumerate(result["rows"]):
        if missing := [key for key in _KEYS if key not in row]:
            raise ValueError(f"{name}: rows[{index}]: {', '.join(missing)} missing")


def table(rows: list[Row]) -> str:
    """Return a table in which the dense grid stands beside each mesh that has one."""
    grids = {(row["shape"], row["resolution"]): row for row in rows if row["way"] == "dense"}
    near = [row for row in rows if row["way"] == "near"]
    return "\n".join([_HEAD, *(_line(row, grids.get((row["shape"], row["resolution"]))) for row in near)])


def _line(row: Row, grid: Row | None) -> str:
    cells = [
        row["shape"],
        f"{row['resolution']}³",
        f"{row['triangles']:,}",
        f"{row['cell_evaluations']:,}",
        f"1/{grid['evaluations'] / row['cell_evaluations']:.1f}" if grid else "–",
        f"{row['evaluations'] - row['cell_evaluations']:,}",
        f"{row['cpu_seconds']:.2f}",
        f"{grid['cpu_seconds']:.2f}" if grid else "–",
        f"{row['megabytes']:.0f}",
        f"{grid['megabytes']:.0f}" if grid else "–",
    ]
    return f"| {' | '.join(cells)} |"
