"""Measure the trade: how much error how many evaluations and how much time buy, on all lanes and on one.

``python benchmarks/trade.py`` (or ``make bench``) renders the depth of scenes A, B and C with pixel tolerances from
coarse to fine, with long and with plain steps, with the secant finish and without, on the best instruction set and on
one lane, and keeps everything in benchmarks/results/trade-*.json. octomarch itself must be installed. tables.py comes
after it.
"""

import argparse
import json
import math
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

import machine
import octomarch as om
import trade_tables
from octomarch.study.errors import depth_errors
from octomarch.study.front import pareto_front
from octomarch.study.truth import Truth, find_truth
from sweeps.plan import FULL, QUICK, Case, Plan, Row, say
from sweeps.views import View, evaluations, view
from timing import Times, measure

TOLERANCES = (8.0, 2.0, 0.5, 0.1, 0.02, 0.005)
METHODS: tuple[Literal["auto", "plain"], ...] = ("auto", "plain")
FINISHES: tuple[Literal["secant"] | None, ...] = ("secant", None)


def scene(seen: View, plan: Plan) -> list[Row]:
    """Return a row for each setting of a scene: counts, errors, and milliseconds of all rounds on both kernels."""
    say(f"{seen.name}: the truth")
    true = truth(seen, plan.size)
    isas = (om.isas()[0], "scalar")
    settings = [(method, finish, tolerance) for method in METHODS for finish in FINISHES for tolerance in TOLERANCES]
    cases = [
        Case(f"{setting} {isa}", partial(picture, seen, plan.size, isa, *setting))
        for setting in settings
        for isa in isas
    ]
    title = f"{seen.name}: round"
    times, images = measure(cases, plan.rounds, lambda done: say(f"{title} {done} of {plan.rounds}"), plan.seconds)
    rows = []
    for setting in settings:
        fast, slow = (f"{setting} {isa}" for isa in isas)
        same = bool(np.array_equal(images[fast].depth, images[slow].depth))
        rows.append(row(seen, setting, images[fast], true, {"simd": times[fast], "lane": times[slow]}, same))
    front = pareto_front(
        [
            [
                row["evaluations"],
                math.inf if row["p95"] is None else row["p95"],
                row["false_hits"] + row["false_misses"],
            ]
            for row in rows
        ]
    )
    return [{**row, "front": index in front} for index, row in enumerate(rows)]


def truth(seen: View, size: tuple[int, int]) -> Truth:
    march = om.March(max_distance=seen.max_distance).resolve(om.compile(seen.shape), seen.camera.eye)
    return find_truth(om.Scene(seen.shape), seen.camera, size, march, planes=("depth", "status"))


def picture(
    seen: View,
    size: tuple[int, int],
    isa: str,
    method: Literal["auto", "plain"],
    finish: Literal["secant"] | None,
    tolerance: float,
) -> om.Image:
    march = om.March(method, pixel_tolerance=tolerance, finish=finish, max_distance=seen.max_distance)
    return om.render(seen.shape, seen.camera, size, march=march, planes=("depth", "status"), threads=1, isa=isa)


def row(
    seen: View,
    setting: tuple[str, str | None, float],
    image: om.Image,
    true: Truth,
    times: dict[str, Times],
    same: bool,
) -> Row:
    method, finish, tolerance = setting
    counts = evaluations(image)
    errors = vars(depth_errors(image.depth, image.status, true.depth))
    return {
        **seen.facts,
        "method": method,
        "finish": finish,
        "tolerance": tolerance,
        "evaluations": counts["primary"] + counts["cones"],
        **{name: None if value == math.inf else value for name, value in errors.items()},
        "truth": str(true),
        "same_bits": same,
        **{name: {"cpu": taken.cpu, "wall": taken.wall} for name, taken in times.items()},
    }


def run(plan: Plan) -> dict[str, Any]:
    """Return the rows of all scenes, on what machine they were measured, and how."""
    description = machine.describe(None)
    machine.warn_when_busy(description)
    others = machine.OtherWork()
    views = [view("A"), view("B"), view("C", plan.balls)]
    rows = [found for seen in views for found in scene(seen, plan)]
    description["busy_processors_during"] = others.busy_processors()
    settings = {"rounds": plan.rounds, "seconds": plan.seconds, "size": plan.size, "isa": om.isas()[0]}
    return {"machine": description, "settings": {**settings, "quick": plan is QUICK}, "rows": rows}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small pictures, one round: a check, not a measurement")
    parser.add_argument("--out", type=Path, metavar="FILE", help="default: results/trade-<date>-<processor>.json")
    chosen = parser.parse_args()
    result = run(QUICK if chosen.quick else FULL)
    print("\n\n".join(["", *trade_tables.blocks(result).values()]))
    if chosen.quick and not chosen.out:
        return
    out = chosen.out or machine.result_file(result["machine"], "trade-")
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"\n{out}")


if __name__ == "__main__":
    main()
