"""Sentences about what sweep.py has measured. Who wins is read off the figures, whoever it is.

sweep_rows.py comes before it, sweep_tables.py after it.
"""

from collections.abc import Callable

import numpy as np

from peer_tables import time
from sweep_rows import Result, Row, marched, median, one, ratio, scene_title, values, where

MODES = {"depth": "depth", "shaded": "full shading"}
NEAR = 1.05  # times that are nearer to each other than this have no winner


def quartile(row: Row, clock: str, percent: float) -> float:
    return float(np.percentile(row[clock], percent))


def how(result: Result) -> str:
    """Return on what, with what and how thoroughly was measured."""
    machine, settings = result["machine"], result["settings"]
    build, processor = machine["engine_build"], machine["processor"]
    width, height = settings["size"]
    numbers = sorted({len(row["cpu"]) for rows in result["rows"].values() for row in rows})
    rounds = "–".join(map(str, dict.fromkeys((numbers[0], numbers[-1]))))
    return (
        f"{processor['model']}, {machine['date'][:10]}, octomarch {machine['octomarch']} at {machine['commit']}, "
        f"{build['compiler']}, `{build['flags']}`: medians and quartiles of {rounds} paired rounds, {width}×{height} "
        "and one thread where nothing else is said, milliseconds of processor time; other work kept "
        f"{machine['busy_processors_during']} of {processor['processors']} processors busy."
    )


def methods(rows: list[Row]) -> str:
    """Say for each scene which method is fastest, and what the default saves."""
    lines = []
    for scene in values(rows, "scene"):
        some = where(rows, scene=scene)
        fastest = min(some, key=median)
        auto, plain = (one(some, method=method) for method in ("auto", "plain"))
        if not auto or not plain:
            continue
        if ratio(auto, fastest) > NEAR:
            who = f"`{fastest['method']}` wins, with {1 / ratio(auto, fastest):.2f} of the time of the default; that"
        else:
            who = "nothing is faster than the default, `auto`, which"
        lines.append(
            f"- {scene_title(auto)}: {who} takes {ratio(fastest, plain):.2f} of the time of `plain`; `auto` needs "
            f"{marched(plain) / marched(auto):.1f} times fewer evaluations."
        )
    return "\n".join(lines)


def isas(rows: list[Row]) -> str:
    """Say what the best instruction set gains over one lane."""
    gains = []
    for lane in where(rows, isa="scalar"):
        others = [row for row in where(rows, scene=lane["scene"], mode=lane["mode"]) if row["isa"] != "scalar"]
        if others:
            best = min(others, key=median)
            gains.append(f"{best['isa']} {ratio(lane, best):.1f} times in {lane['scene']}, {MODES[lane['mode']]}")
    return f"Over one lane, the fastest gains: {'; '.join(gains)}."


def balls(rows: list[Row]) -> str:
    """Say how time grows, what following pictures save, and where the whole program is faster."""
    ns, lines = values(rows, "n"), []
    for again in where(rows, picture="again")[-1:]:
        first = one(rows, n=again["n"], picture="first")
        if first:
            lines.append(
                f"- With {again['n']:,} balls a picture that follows takes {ratio(again, first):.2f} of the first."
            )
    smallest, first = (one(rows, n=n, picture="first") for n in (ns[0], ns[-1]))
    if first and smallest:
        lines.append(
            f"- From {ns[0]:,} to {ns[-1]:,} balls, {ns[-1] / ns[0]:,.0f} times as many, time grows "
            f"{median(first) / median(smallest):,.0f} times."
        )
    for picture, what in (("first", "a first picture"), ("again", "one that follows")):
        for n in ns:
            parts, whole = one(rows, n=n, picture=picture), one(rows, n=n, picture="whole")
            if parts and whole and parts["cells"]:
                times = ratio(parts, whole)
                if times > NEAR:
                    verdict = f"over {what} in parts, which takes {times:.2f} times as long"
                    lines.append(f"- {n:,} balls: **the whole program wins** {verdict}.")
                elif times < 1 / NEAR:
                    lines.append(f"- {n:,} balls: {what} in parts takes {times:.2f} of the time of the whole program.")
    return "\n".join(lines)


def resolution(rows: list[Row]) -> str:
    """Say how the time of a pixel changes from the smallest picture to the largest."""
    sides, found = values(rows, "side"), []
    for large in where(rows, side=sides[-1]):
        small = one(rows, **{key: large[key] for key in ("scene", "n", "mode")}, side=sides[0])
        if small:
            change = median(large) / median(small) * (sides[0] / sides[-1]) ** 2
            found.append(f"{change:.2f} in {scene_title(large)}, {MODES[large['mode']]}")
    return f"A pixel of {sides[-1]}² takes this share of the time of one of {sides[0]}²: {'; '.join(found)}."


def features(rows: list[Row]) -> str:
    """Say whether what is switched off costs anything."""
    pairs, counts, pixels = (
        sum(row[key] for row in rows) for key in ("off_pairs", "different_counts", "different_pixels")
    )
    verdict = "so that what is off costs nothing" if counts == 0 else "**so that something costs although it is off**"
    return (
        f"Over {pairs} pairs of pictures, one with a feature switched off and one that never had it, {counts} counts "
        f"of `image.stats` and {pixels} pixels differ, {verdict}."
    )


def _default_method(rows: list[Row]) -> str:
    saved = []
    for auto in where(rows, method="auto"):
        plain = one(rows, scene=auto["scene"], method="plain")
        if plain:
            evaluations = f"{marched(auto) / marched(plain):.2f} of the evaluations"
            saved.append(f"{ratio(auto, plain):.2f} of the time and {evaluations} in {scene_title(auto)}")
    return f"The default method beside plain sphere tracing: {'; '.join(saved)}."


def _most_threads(rows: list[Row]) -> str:
    most, gains = max(values(rows, "threads")), []
    for row in where(rows, threads=most):
        alone = one(rows, scene=row["scene"], threads=1)
        if alone:
            gains.append(f"{ratio(alone, row, 'wall'):.2f} times in {scene_title(row)}")
    return f"{most} threads, full shading, gain over one: {'; '.join(gains)}."


def _growth(rows: list[Row]) -> str:
    times = []
    for first in where(rows, picture="first"):
        again = one(rows, n=first["n"], picture="again")
        times.append(f"{first['n']:,} balls {time(median(first))} and {time(median(again)) if again else '–'}")
    return f"Milliseconds of the first and a following picture of scene C: {'; '.join(times)}."


def summary(rows: dict[str, list[Row]]) -> str:
    """Return the lines for the README, a line a sweep."""
    makers: dict[str, Callable[[list[Row]], str]] = {
        "methods": _default_method,
        "isas": lambda found: isas(where(found, precision="float32")),
        "threads": _most_threads,
        "balls": _growth,
        "features": features,
    }
    return "\n".join(f"- {make(rows[name])}" for name, make in makers.items() if name in rows)
