"""What long_work.py has measured, as Markdown. tables.py puts it into the documentation."""

from typing import Any

_PICTURE = ("way", "size", "seconds", "cpu_seconds", "peak_bytes", "pixel_bytes", "file_bytes")
_LATENCY = ("work", "how", "interrupts", "median", "p95", "most")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what long_work.py writes."""
    for key in ("machine", "latency", "pictures"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    for key, columns in {"latency": _LATENCY, "pictures": _PICTURE}.items():
        for index, row in enumerate(result[key]):
            if missing := [column for column in columns if column not in row]:
                raise ValueError(f"{name}: {key}[{index}]: {', '.join(missing)} missing")


def blocks(result: Any) -> dict[str, str]:
    """Return the text of every block by its name."""
    return {"long-pictures": pictures(result), "long-latency": latency(result), "long-how": how(result)}


def pictures(result: Any) -> str:
    """Return what large pictures take."""
    heads = ("pixels", "way", "time", "processor time", "peak memory", "file")
    lines = ["| " + " | ".join(heads) + " |", "|---|---|---:|---:|---:|---:|"]
    for row in result["pictures"]:
        before = row.get("seconds_before")
        time = f"{row['seconds']:.1f} s" if before is None else f"{before:.1f} + {row['seconds']:.1f} s"
        cells = (
            f"{row['size']:,}²",
            {"at once": "`render`, `save`", "bands": "`render_file`"}.get(row["way"], row["way"]),
            time,
            f"{row['cpu_seconds']:.1f} s" if before is None else "",
            _bytes(row["peak_bytes"]),
            _bytes(row["file_bytes"]),
        )
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def latency(result: Any) -> str:
    """Return how soon work ends."""
    rows = (
        f"| {row['work']} | {row['how']} | {_ms(row['median'])} | {_ms(row['most'])} |" for row in result["latency"]
    )
    return "\n".join(["| work | ended by | median | at the most |", "|---|---|---:|---:|", *rows])


def how(result: Any) -> str:
    """Return on what it was measured."""
    machine = result["machine"]
    interrupts = max(row["interrupts"] for row in result["latency"])
    return (
        f"{machine['processor']['model']}, {machine['processor']['usable_processors']} processors, "
        f"{machine['date'][:10]}, octomarch {machine['octomarch']} at {machine['commit']}; each kind of work was ended "
        f"{interrupts} times, at moments of chance; other work kept {machine['busy_processors_during']:g} processors "
        "busy."
    )


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.0f} ms"


def _bytes(count: float) -> str:
    return f"{count / 1e9:.2f} GB" if count >= 1e9 else f"{count / 1e6:.0f} MB"
