"""Measure what octomarch's own choices cost: methods, instruction sets, threads, sizes, features, gradients, building.

``python benchmarks/sweep.py`` (or ``make bench``) runs every sweep of sweeps/, prints tables and keeps everything in
benchmarks/results/sweep-*.json. README.md says what is measured. octomarch itself must be installed. tables.py comes
after it.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import machine
import sweep_tables
from sweeps import balls, building, features, gradients, isas, methods, resolution, threads
from sweeps.plan import FULL, QUICK, Plan, Row, say

SWEEPS: dict[str, Callable[[Plan], list[Row]]] = {
    "methods": methods.measure,
    "isas": isas.measure,
    "threads": threads.measure,
    "balls": balls.measure,
    "resolution": resolution.measure,
    "features": features.measure,
    "gradients": gradients.measure,
    "building": building.measure,
}


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--only", nargs="+", choices=SWEEPS, default=list(SWEEPS), metavar="SWEEP", help=", ".join(SWEEPS)
    )
    parser.add_argument("--quick", action="store_true", help="small pictures, one round: a check, not a measurement")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="default: results/sweep-<date>-<processor>.json, for a whole run"
    )
    return parser.parse_args()


def run(names: list[str], plan: Plan) -> dict[str, Any]:
    """Return the rows of every sweep, on what machine they were measured, and how."""
    description = machine.describe(None)
    machine.warn_when_busy(description)
    others = machine.OtherWork()
    rows, seconds = {}, {}
    for name in names:
        start = time.perf_counter()
        rows[name] = SWEEPS[name](plan)
        seconds[name] = round(time.perf_counter() - start, 1)
        say(f"{name}: {seconds[name]} s\n")
    description["busy_processors_during"] = others.busy_processors()
    settings = {**vars(plan), "quick": plan is QUICK, "seconds_of_sweeps": seconds}
    return {"machine": description, "settings": settings, "rows": rows}


def main() -> None:
    chosen = arguments()
    result = run(chosen.only, QUICK if chosen.quick else FULL)
    complete = not chosen.quick and set(chosen.only) == set(SWEEPS)
    print("\n\n".join(sweep_tables.blocks(result).values()))
    if not (chosen.out or complete):
        return
    out = chosen.out or machine.result_file(result["machine"], "sweep-")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"\n{out}")


if __name__ == "__main__":
    main()
