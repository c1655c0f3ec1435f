"""Time octomarch against what its users could pick instead: Dr.Jit, Numba, JAX, Warp, Taichi, numpy; one thread each.

``python benchmarks/compare.py`` (or ``make bench-peers``) makes the virtual environment of the peers in
build/peers-venv, starts every contender in a process of its own, lets each render once per round in an order that moves
on, prints tables and keeps everything in benchmarks/results/peers-*.json. README.md says what exactly is rendered.
octomarch itself must be installed. tables.py comes after it.
"""

import argparse
import json
import os
import sys
from pathlib import Path
from typing import Any

import machine
import peer_tables
from peers import environment
from peers.registry import everybody
from peers.rounds import Entry, compare
from peers.tasks import Light, Mode, Task
from scenes import EPSILON, MAX_STEPS, SCENES, spheres

HERE = Path(__file__).resolve().parent
TABLE_N = 200


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    keys = [contender.key for contender in everybody()]
    parser.add_argument("--contenders", nargs="+", choices=keys, default=keys, metavar="KEY", help=", ".join(keys))
    parser.add_argument("--scenes", nargs="+", choices=["A", "B", "C"], default=["A", "B", "C"])
    parser.add_argument("--modes", nargs="+", choices=["depth", "shaded"], default=["depth", "shaded"])
    parser.add_argument(
        "--n", nargs="*", type=int, default=[10, 50, 1000, 10_000, 100_000], help="sizes of C besides 200, depth alone"
    )
    parser.add_argument(
        "--size", nargs=2, type=int, default=[640, 480], metavar=("W", "H"), help="multiples of 8 and 4"
    )
    parser.add_argument("--repeat", type=int, default=7, metavar="N", help="rounds, ≥ 3 (default: 7)")
    parser.add_argument("--repeat-n", type=int, default=3, metavar="N", help="rounds for --n (default: 3)")
    parser.add_argument("--limit", type=float, default=20.0, metavar="S", help="seconds that a picture may take")
    parser.add_argument("--venv", type=Path, default=HERE.parent / "build" / "peers-venv", metavar="DIR")
    parser.add_argument("--out", type=Path, metavar="FILE", help="default: results/peers-<date>-<processor>.json")
    chosen = parser.parse_args()
    if min(chosen.repeat, chosen.repeat_n) < 3:
        parser.error("--repeat and --repeat-n must be at least 3")
    return chosen


def task_of(scene: str, mode: Mode, n: int, size: tuple[int, int]) -> Task:
    found = spheres(n) if scene == "C" else SCENES[scene]()
    return Task(
        scene,
        mode,
        found.eye,
        *size,
        n=n,
        fov=found.fov,
        max_steps=MAX_STEPS,
        epsilon=EPSILON,
        max_distance=found.max_distance,
    )


def entries_of(chosen: argparse.Namespace) -> list[Entry]:
    """Return who takes part, with why not where a package is missing."""
    missing = environment.make(chosen.venv)
    cpu, patience = max(os.sched_getaffinity(0)), 120 + 10 * chosen.limit
    entries = []
    for contender in everybody():
        if contender.key in chosen.contenders:
            own = contender.own_environment
            python = environment.python_of(chosen.venv) if own else Path(sys.executable)
            absent = next((missing[name] for name in contender.packages if own and name in missing), None)
            entries.append(Entry(contender, python, cpu, patience, absent))
    return entries


def plan(chosen: argparse.Namespace) -> list[tuple[str, Mode, int]]:
    """Return scene, mode and number of balls of every picture: those of the tables, then C of other sizes."""
    tables: list[tuple[str, Mode, int]] = [
        (scene, mode, TABLE_N if scene == "C" else 0) for scene in chosen.scenes for mode in chosen.modes
    ]
    sizes = sorted({n for n in chosen.n if n != TABLE_N}) if "C" in chosen.scenes else []
    return tables + [("C", "depth", n) for n in sizes]


def settings_of(chosen: argparse.Namespace) -> dict[str, Any]:
    return vars(Light()) | {
        "size": chosen.size,
        "max_steps": MAX_STEPS,
        "epsilon": EPSILON,
        "table_n": TABLE_N,
        "limit_seconds": chosen.limit,
    }


def as_contender(entry: Entry) -> dict[str, Any]:
    """Return what is kept of a contender besides its times."""
    return {
        "key": entry.contender.key,
        "label": entry.contender.label,
        "flags": entry.contender.flags,
        "versions": entry.greeting.get("versions", {}),
        "import_seconds": entry.greeting.get("import_seconds"),
    }


def main() -> None:
    chosen = arguments()
    entries = entries_of(chosen)
    description = machine.describe(None)
    machine.warn_when_busy(description)
    others = machine.OtherWork()
    rows: list[dict[str, Any]] = []
    milliseconds: dict[str, Any] = {}
    for scene, mode, n in plan(chosen):
        tabled = n in (0, TABLE_N)
        some = [entry for entry in entries if tabled or entry.contender.in_sweep]
        task = task_of(scene, mode, n, tuple(chosen.size))
        found, times = compare(some, task, chosen.repeat if tabled else chosen.repeat_n, chosen.limit)
        rows += found
        milliseconds[f"{scene}/{n}/{mode}"] = times
    for entry in entries:
        entry.close()
    description["busy_processors_during"] = others.busy_processors()
    description["busy_processors_after"] = machine.busy_processors()
    result = {
        "machine": description,
        "settings": settings_of(chosen),
        "contenders": [as_contender(entry) for entry in entries],
        "rows": rows,
        "milliseconds": milliseconds,
    }
    out = chosen.out or machine.result_file(description, "peers-")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{description['processor']['model']}, {description['date']}\n\n{peer_tables.tables(result)}\n\n{out}")


if __name__ == "__main__":
    main()
