"""What evaluations.py has counted as Markdown. tables.py puts it into the documentation."""

from typing import Any

_COLUMNS = ("case", "method", "primary", "cones", "false_misses", "false_hits", "undecided", "p95")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what evaluations.py writes."""
    for key in ("size", "epsilon", "rows"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    for index, row in enumerate(result["rows"]):
        if missing := [column for column in _COLUMNS if column not in row]:
            raise ValueError(f"{name}: rows[{index}]: {', '.join(missing)} missing")


def table(result: Any) -> str:
    """Return the rows, one for a scene and method; a scene is named in its first."""
    heads = ("scene", "method", "evaluations", "of cones", "false misses", "false hits", "undecided", "error, p95")
    lines = ["| " + " | ".join(heads) + " |", "|---|---" + "|---:" * 6 + "|"]
    named = ""
    for row in result["rows"]:
        cones = f"{row['cones']:.2f}" if row["cones"] else "–"
        cells = [
            "" if row["case"] == named else row["case"],
            f'`"{row["method"]}"`',
            f"{row['primary'] + row['cones']:.1f}",
            cones,
            *(f"{row[key]:,}" if row[key] else "–" for key in ("false_misses", "false_hits", "undecided")),
            f"{row['p95']:.0e}",
        ]
        named = row["case"]
        lines.append("| " + " | ".join(cells) + " |")
    width, height = result["size"]
    rays = f"{width} × {height} rays, float64, hit epsilon {result['epsilon']:g}, no pixel tolerance."
    return "\n".join(lines) + f"\n\n{rays}"
