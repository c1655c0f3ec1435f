"""What run.py and quality.py have measured as Markdown. tables.py puts it into the documentation."""

from typing import Any

import numpy as np

Result = dict[str, Any]

SCENES = ("A", "B")
ISAS = {"neon": "NEON", "sse2": "SSE2", "avx2": "AVX2", "avx512": "AVX-512"}
ROWS = {
    "packet": "xsimd by hand, one packet at a time",
    "engine1": "**octomarch**",
    "block": "xsimd by hand, field fused, refilled blocks",
}


def check_by_hand(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what run.py writes."""
    for key in ("machine", "settings", "rows", "verdicts"):
        if not isinstance(result, dict) or not result.get(key):
            raise ValueError(f"{name}: {key!r} is missing")
    if not _isas([result]):
        raise ValueError(f"{name}: rows: none of {', '.join(ISAS)}")
    there = {row.get("key") for row in result["rows"]}
    wanted = {f"{isa}/{row}" for isa in _isas([result]) for row in (*ROWS, "engine1-secant")}
    if missing := sorted(wanted - there):
        raise ValueError(f"{name}: rows: no {', '.join(missing)}")
    for index, row in enumerate(result["rows"]):
        if missing := [key for key in ("scene", "median", "over_scalar", "evaluations") if key not in row]:
            raise ValueError(f"{name}: rows[{index}]: {', '.join(missing)} missing")


def check_quality(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what quality.py writes."""
    if not isinstance(result, dict) or not isinstance(result.get("rows"), list):
        raise ValueError(f"{name}: 'rows' is missing or not a list")
    for index, row in enumerate(result["rows"]):
        wanted = ("max_steps", "max_distance", "evaluations_per_ray", "step_limit", "false_misses", "false_hits", "p99")
        if missing := [key for key in wanted if key not in row]:
            raise ValueError(f"{name}: rows[{index}]: {', '.join(missing)} missing")


def _isas(results: list[Result]) -> list[str]:
    """Return the instruction sets that all runs have, the best last."""
    return [isa for isa in ISAS if all(any(row.get("isa") == isa for row in result["rows"]) for result in results)]


def figures(results: list[Result], scene: str, key: str, name: str) -> list[float]:
    """Return a figure of a row over the runs."""
    return [row[name] for result in results for row in result["rows"] if (row["scene"], row["key"]) == (scene, key)]


def _ratio(values: list[float], spread: bool) -> str:
    middle = f"{float(np.median(values)):.1f}"
    return f"**{middle}** ({min(values):.1f}–{max(values):.1f})" if spread else middle


def by_hand(results: list[Result]) -> str:
    """Return how many times as fast as scalar C++ everything is, the median over the runs."""
    columns = [(scene, isa) for isa in _isas(results) for scene in SCENES]
    lines = [
        "| × scalar C++ by hand, same flags | " + " | ".join(f"{scene}, {ISAS[isa]}" for scene, isa in columns) + " |",
        "|---|" + "---|" * len(columns),
    ]
    for row, label in ROWS.items():
        ratios = [figures(results, scene, f"{isa}/{row}", "over_scalar") for scene, isa in columns]
        lines.append(f"| {label} | " + " | ".join(_ratio(values, row == "engine1") for values in ratios) + " |")
    return "\n".join([*lines, "", _in_words(results)])


def _in_words(results: list[Result]) -> str:
    isas = _isas(results)
    times = {s: float(np.median(figures(results, s, f"{isas[-1]}/engine1", "median"))) for s in SCENES}
    evaluations = {s: figures(results, s, f"{isas[-1]}/engine1", "evaluations")[0] for s in SCENES}
    threads = [verdict["two_threads"] for result in results for verdict in result["verdicts"]]
    finish = [
        float(np.median(figures(results, scene, f"{isa}/engine1-secant", "median")))
        / float(np.median(figures(results, scene, f"{isa}/engine1", "median")))
        for scene in SCENES
        for isa in isas
    ]
    rounds = {result["settings"]["rounds"] for result in results}
    model = results[0]["machine"]["processor"]["model"]
    spread = f"{100 * (min(finish) - 1):.0f} to {100 * (max(finish) - 1):.0f} %"
    return (
        f"{model}, {results[0]['machine']['date'][:10]}: medians of {len(results)} runs of "
        f"{'–'.join(map(str, sorted(rounds)))} paired rounds, their range in brackets. A takes "
        f"{evaluations['A']:.0f} evaluations a ray and {times['A']:.1f} ms on {ISAS[isas[-1]]}, "
        f"B {evaluations['B']:.0f} and {times['B']:.1f} ms. Two threads take {min(threads):.2f} to "
        f"{max(threads):.2f} times less. The secant finish adds {spread} to a picture."
    )


def quality(result: Result) -> str:
    """Return cost and error of the quality series."""
    lines = [
        "| steps | far | evaluations | out of steps | false misses | false hits | p50 | p95 | p99 |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for row in result["rows"]:
        far = "–" if row["max_distance"] is None else f"{row['max_distance']:g}"
        lines.append(
            f"| {row['max_steps']} | {far} | {row['evaluations_per_ray']:.1f} | {row['step_limit']:.2%} "
            f"| {row['false_misses']} | {row['false_hits']} | {row['p50']:.1e} | {row['p95']:.1e} | {row['p99']:.1e} |"
        )
    return "\n".join(lines)
