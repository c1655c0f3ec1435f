"""What sweep.py has measured as Markdown: a table for each sweep, and sentences that the figures make.

sweep_rows.py comes before it; sweep.py prints it, tables.py puts it into the documentation.
"""

from collections.abc import Callable

import sweep_words as words
from peer_tables import time
from sweep_rows import Result, Row, added, marched, median, one, others, ratio, scene_title, total, values, where

PICTURES = {"first": "first", "again": "again", "turned": "turned by 5°", "whole": "whole program"}
STAGES = {
    "build": "from arrays",
    "build_one_by_one": "one by one",
    "compile": "compile",
    "compile_ids": "ids",
    "save": "save",
    "load": "load",
    "drop": "drop",
}


def table(heads: list[str], lines: list[list[str]], texts: int = 1) -> str:
    """Return a table whose first columns are texts and whose others are numbers."""
    rule = "|" + "---|" * texts + "---:|" * (len(heads) - texts)
    return "\n".join(["| " + " | ".join(heads) + " |", rule, *("| " + " | ".join(line) + " |" for line in lines)])


def spread(row: Row, clock: str = "cpu") -> str:
    """Return median and quartiles of a row's milliseconds."""
    low, high = (time(words.quartile(row, clock, percent)) for percent in (25, 75))
    return f"{time(median(row, clock))} ({low}–{high})"


def methods(rows: list[Row]) -> str:
    heads = [
        "scene",
        "method",
        "ms",
        "evaluations",
        "cones",
        "Δt p50",
        "Δt p95",
        "Δt p99",
        "false hits",
        "false misses",
    ]
    lines = []
    for row in rows:
        error = row["error"]
        lines.append(
            [
                scene_title(row),
                f"`{row['method']}`",
                spread(row),
                f"{row['evaluations']['primary']:.1f}",
                f"{row['evaluations']['cones']:.2f}",
                *(f"{error[key]:.1e}" for key in ("p50", "p95", "p99")),
                f"{error['false_hits']:,}",
                f"{error['false_misses']:,}",
            ]
        )
    return f"{table(heads, lines, 2)}\n\n{words.methods(rows)}"


def isas(rows: list[Row]) -> str:
    """Return milliseconds in float32, and how many times as fast as one lane that is."""
    singles = where(rows, precision="float32")
    pictures = list(dict.fromkeys((row["scene"], row["mode"]) for row in singles))
    lines = []
    for isa in values(singles, "isa"):
        cells = []
        for scene, mode in pictures:
            row, lane = (one(singles, scene=scene, mode=mode, isa=name) for name in (isa, "scalar"))
            cells.append("–" if not row or not lane else f"{time(median(row))}, {ratio(lane, row):.1f} ×")
        lines.append([isa, *cells])
    heads = ["ms, × scalar", *(f"{scene}, {words.MODES[mode]}" for scene, mode in pictures)]
    return f"{table(heads, lines)}\n\n{words.isas(singles)}"


def precisions(rows: list[Row]) -> str:
    """Return what float64 takes beside float32, by instruction set."""
    lines = []
    for double in where(rows, precision="float64"):
        single = one(rows, **{key: double[key] for key in ("scene", "mode", "isa")}, precision="float32")
        if single:
            errors = [f"{row['error']['p95']:.1e}" if row["error"] else "–" for row in (single, double)]
            picture = f"{double['scene']}, {words.MODES[double['mode']]}"
            times = [time(median(single)), time(median(double)), f"{ratio(double, single):.2f}"]
            lines.append([picture, double["isa"], *times, *errors])
    heads = ["scene", "", "float32, ms", "float64, ms", "×", "Δt p95, float32", "Δt p95, float64"]
    return table(heads, lines, 2)


def threads(rows: list[Row]) -> str:
    lines = []
    for row in rows:
        alone = one(rows, scene=row["scene"], n=row["n"], threads=1)
        gain = f"{ratio(alone, row, 'wall'):.2f}" if alone else "–"
        processors = f"{median(row) / median(row, 'wall'):.2f}"
        lines.append([scene_title(row), str(row["threads"]), spread(row, "wall"), gain, processors])
    return table(["scene", "threads", "ms by the clock", "× one thread", "processors"], lines)


def balls(rows: list[Row]) -> str:
    lines = []
    for n in values(rows, "n"):
        found = {name: one(rows, n=n, picture=name) for name in PICTURES}
        first = found["first"]
        if not first:
            continue
        facts = [f"{first['cells']:,}", f"{first['cell_bytes'] / 1e6:.1f}", f"{marched(first):.1f}"]
        lines.append([f"{n:,}", *facts, *(spread(row) if row else "–" for row in found.values())])
    heads = ["balls", "cells", "MB of cells", "evaluations", *(f"{title}, ms" for title in PICTURES.values())]
    return f"{table(heads, lines)}\n\n{words.balls(rows)}"


def resolution(rows: list[Row]) -> str:
    sides = values(rows, "side")
    pictures = where(rows, side=sides[0])
    lines = []
    for side in sides:
        cells = []
        for picture in pictures:
            row = one(rows, **{key: picture[key] for key in ("scene", "n", "mode")}, side=side)
            extra = f"{row['extra_bytes'] / 1e6:.1f}" if row and row["extra_bytes"] is not None else "–"
            cells += [time(median(row) / side**2 * 1e6) if row else "–", extra]
        lines.append([f"{side}²", *cells])
    heads = ["pixels"]
    for picture in pictures:
        heads += [f"{scene_title(picture)}, {words.MODES[picture['mode']]}: ms per million pixels", "MB"]
    return f"{table(heads, lines)}\n\n{words.resolution(rows)}"


def features(rows: list[Row]) -> str:
    heads = ["feature", "added to", "ms", "evaluations", "of ids, materials, sky", "counts ≠ when off"]
    lines = []
    for row in rows:
        over = one(rows, feature=row["over"])
        middle, low, high = added(row, over)
        counts = [count(row) - (count(over) if over else 0.0) for count in (total, others)]
        lines.append(
            [
                row["feature"],
                row["over"] or "–",
                f"{middle:.2f} ({low:.2f} to {high:.2f})",
                *(f"{count:.2f}" for count in counts),
                f"{row['different_counts']}" if row["off_pairs"] else "–",
            ]
        )
    return f"{table(heads, lines, 2)}\n\n{words.features(rows)}"


def gradients(rows: list[Row]) -> str:
    """Return nanoseconds of a distance and of a gradient, and how many distances a gradient takes."""
    scenes = values(rows, "scene")
    lines = []
    for isa in values(rows, "isa"):
        cells = []
        for scene in scenes:
            distance, gradient = (one(rows, scene=scene, isa=isa, asked=asked) for asked in ("distance", "gradient"))
            if distance and gradient:
                cells += [f"{median(row) / row['points'] * 1e6:.2f}" for row in (distance, gradient)]
                cells.append(f"{ratio(gradient, distance):.2f}")
        lines.append([isa, *cells])
    heads = [f"{scene}: {what}" for scene in scenes for what in ("ns a distance", "ns a gradient", "ratio")]
    return table(["", *heads], lines)


def building(rows: list[Row]) -> str:
    lines = []
    for shapes in values(rows, "shapes"):
        for n in values(rows, "n"):
            some = where(rows, shapes=shapes, n=n)
            found = [one(some, stage=stage) for stage in STAGES]
            times = [f"{median(row):.3g}" if row else "–" for row in found]
            lines.append([shapes, f"{n:,}", f"{some[0]['instructions']:,}", *times, f"{some[0]['megabytes']:.2g}"])
    return table(["milliseconds", "n", "instructions", *STAGES.values(), "file, MB"], lines)


TABLES: dict[str, Callable[[list[Row]], str]] = {
    "methods": methods,
    "isas": isas,
    "threads": threads,
    "balls": balls,
    "resolution": resolution,
    "features": features,
    "gradients": gradients,
    "building": building,
}


def blocks(result: Result) -> dict[str, str]:
    """Return the text of every block by name, for the sweeps that were run."""
    rows = result["rows"]
    found = {"sweep-how": words.how(result)}
    found |= {f"sweep-{name}": make(rows[name]) for name, make in TABLES.items() if name in rows}
    if "isas" in rows:
        found["sweep-precisions"] = precisions(rows["isas"])
    return found | {"sweep-summary": words.summary(rows)}
