"""What trade.py has measured as Markdown: the settings that nothing beats, and what they buy in words.

trade_plots.py draws the rest; tables.py puts both into the documentation. octomarch is not needed.
"""

from typing import Any

from peer_tables import time
from sweep_rows import Row, median, one, ratio, scene_title, values, where
from sweep_tables import table

_COLUMNS = (
    *("scene", "n", "method", "finish", "tolerance", "evaluations", "p50", "p95", "p99", "false_hits", "false_misses"),
    *("truth", "same_bits", "front", "simd", "lane"),
)
DEFAULT = {"method": "auto", "finish": "secant", "tolerance": 0.1}
CLASSIC = {"method": "plain", "finish": None, "tolerance": 0.1}


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what trade.py writes."""
    for key, kind in (("machine", dict), ("settings", dict), ("rows", list)):
        if not isinstance(result, dict) or not isinstance(result.get(key), kind) or not result[key]:
            raise ValueError(f"{name}: {key!r} is missing")
    for index, row in enumerate(result["rows"]):
        if missing := [key for key in _COLUMNS if key not in row]:
            raise ValueError(f"{name}: rows[{index}]: {', '.join(missing)} missing")


def blocks(result: Any) -> dict[str, str]:
    """Return the text of every block by name."""
    return {
        "trade-how": _how(result),
        "trade-summary": _summary(result["rows"]),
        "trade-front": _front(result["rows"]),
    }


def _how(result: Any) -> str:
    found, settings = result["machine"], result["settings"]
    rounds = sorted({len(row["simd"]["cpu"]) for row in result["rows"]})
    times = "–".join(map(str, dict.fromkeys((rounds[0], rounds[-1]))))
    bits = "the same bits" if all(row["same_bits"] for row in result["rows"]) else "**other bits**"
    truths = "; ".join(f"{row['scene']}: {row['truth']}" for row in where(result["rows"], **DEFAULT))
    return (
        f"{found['processor']['model']}, {found['date'][:10]}, octomarch {found['octomarch']} at {found['commit']}: "
        f"{settings['isa']} and one lane, which gave {bits}; {settings['size'][0]}×{settings['size'][1]}, depth alone, "
        f"one thread, medians of {times} rounds in milliseconds of processor time; other work kept "
        f"{found['busy_processors_during']} of {found['processor']['processors']} processors busy. Truth of {truths}."
    )


def _summary(rows: list[Row]) -> str:
    """Return a sentence for each scene: the defaults beside plain sphere tracing with the same tolerance."""
    lines = []
    for name in values(rows, "scene"):
        ours, classic = (one(where(rows, scene=name), **wanted) for wanted in (DEFAULT, CLASSIC))
        if ours and classic:
            lines.append(
                f"- {scene_title(ours)}: by default {_price(ours)}; plain steps without a finish, at the same "
                f"tolerance: {_price(classic)}."
            )
    return "\n".join(lines)


def _price(row: Row) -> str:
    simd, lane = (time(median(row[kernel])) for kernel in ("simd", "lane"))
    return f"{row['evaluations']:.1f} evaluations a ray, {simd} ms ({lane} on one lane), Δt p95 {_error(row['p95'])}"


def _front(rows: list[Row]) -> str:
    """Return the settings of each scene that no other beats in evaluations, p95 and rays that end wrong."""
    heads = ["scene", "steps", "finish", "pixels", "evaluations", "ms", "one lane", "×"]
    heads += ["Δt p50", "Δt p95", "Δt p99", "false hits", "false misses"]
    lines = []
    for row in sorted(where(rows, front=True), key=lambda row: (row["scene"], row["evaluations"])):
        cells = [
            scene_title(row),
            f"`{row['method']}`",
            row["finish"] or "none",
            f"{row['tolerance']:g}",
            f"{row['evaluations']:.1f}",
            time(median(row["simd"])),
            time(median(row["lane"])),
            f"{ratio(row['lane'], row['simd']):.1f}",
            *(_error(row[key]) for key in ("p50", "p95", "p99")),
            f"{row['false_hits']:,}",
            f"{row['false_misses']:,}",
        ]
        lines.append(cells if any(row[key] != DEFAULT[key] for key in DEFAULT) else [f"**{cell}**" for cell in cells])
    return table(heads, lines, 3)


def _error(value: float | None) -> str:
    return "∞" if value is None else f"{value:.1e}"
