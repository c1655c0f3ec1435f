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
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import machine
import peer_tables
from peers import environment
from peers.client import Client, GoneError
from peers.octomarch_engine import truth
from peers.registry import Contender, everybody
from peers.tasks import Mode, Task
from scenes import EPSILON, MAX_STEPS, SCENES, spheres

HERE = Path(__file__).resolve().parent
QUIET = 0.1  # processors that other work may keep busy
TRUTH_COSTS = 10.0  # times what octomarch's own picture does
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


@dataclass
class Entry:
    """A contender through the whole run: its process, while it has one, and what its pictures have cost."""

    contender: Contender
    python: Path
    cpu: int
    patience: float
    absent: str | None = None
    client: Client | None = None
    greeting: dict[str, Any] = field(default_factory=dict)
    seconds: dict[tuple[str, Mode], tuple[int, float]] = field(default_factory=dict)

    def start(self) -> Client:
        """Return the process; a new one where the last scene was the end of it."""
        if self.absent:
            raise GoneError(self.absent)
        if self.client is None:
            self.client = Client(self.contender, self.python, self.cpu, self.patience)
            self.greeting = self.client.greeting
        return self.client

    def ask(self, do: str, **request: Any) -> dict[str, Any]:
        try:
            return self.start().ask(do, **request)
        except GoneError:
            self.client = None
            raise

    def expected(self, task: Task) -> float:
        """Return the seconds that a picture should take, by what a smaller one of the scene took: as n grows."""
        n, seconds = self.seconds.get((task.scene, task.mode), (task.n, 0.0))
        return seconds * task.n / n if n else seconds


@dataclass(frozen=True)
class Error:
    """A picture against the truth: |Δt| where both have a hit, or the difference of luminance, over all pixels."""

    p50: float
    p95: float
    p99: float
    false_hits: int
    false_misses: int


def error_of(picture: Any, true: Any) -> Error:
    hit, expected = np.isfinite(picture), np.isfinite(true)
    both = hit & expected
    difference = np.abs(picture[both].astype(np.float64) - true[both])
    p50, p95, p99 = (float(p) for p in np.percentile(difference, [50, 95, 99])) if difference.size else (0.0,) * 3
    return Error(p50, p95, p99, int((hit & ~expected).sum()), int((~hit & expected).sum()))


def prepare(entries: list[Entry], task: Task, limit: float) -> tuple[list[Entry], list[dict[str, Any]], dict[str, Any]]:
    """Let everybody render a first time; return who goes on, rows of those who do not, and pictures by key."""
    ready, rows, pictures = [], [], {}
    for entry in entries:
        row = {"scene": task.scene, "n": task.n, "mode": task.mode, "contender": entry.contender.key}
        if (expected := entry.expected(task)) > limit:
            reason = f"not run: a picture would take about {expected:.0f} s, the limit is {limit:.0f} s"
            rows.append(row | {"status": "skipped", "reason": reason})
            continue
        try:
            file = entry.start().picture
            first = entry.ask("prepare", task=task.to_json(), picture=str(file))
            pictures[entry.contender.key] = np.load(file)
            warm = entry.ask("round")["wall"] / 1e3
        except GoneError as gone:
            rows.append(row | {"status": "failed", "reason": str(gone)})
            continue
        entry.seconds[task.scene, task.mode] = task.n, warm
        if warm > limit:
            rows.append(row | {"status": "skipped", "reason": f"{warm:.0f} s a picture, the limit is {limit:.0f} s"})
            continue
        rows.append(row | {"status": "ok", **first})
        ready.append(entry)
    return ready, rows, pictures


def rounds(entries: list[Entry], repeat: int, title: str) -> dict[str, dict[str, list[float]]]:
    """Return milliseconds by key. A contender that ends in the middle has fewer rounds than others, or none."""
    times: dict[str, dict[str, list[float]]] = {entry.contender.key: {"wall": [], "cpu": []} for entry in entries}
    for index in range(repeat):
        shift = index % max(len(entries), 1)
        for entry in entries[shift:] + entries[:shift]:
            try:
                answer = entry.ask("round")
            except GoneError as gone:
                print(f"\n{entry.contender.key}: {gone}", file=sys.stderr)
                continue
            for clock, values in times[entry.contender.key].items():
                values.append(answer[clock])
        print(f"\r{title}: round {index + 1} of {repeat}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return times


def summary(row: dict[str, Any], times: dict[str, list[float]], error: Error | None) -> dict[str, Any]:
    if len(times["cpu"]) < 3:
        return row | {"status": "failed", "reason": "it ended in the middle of the rounds"}
    low, median, high = (float(p) for p in np.percentile(times["cpu"], [25, 50, 75]))
    return row | {
        "compile_seconds": max(row["first_cpu_seconds"] - median / 1e3, 0.0),
        "median": median,
        "quartiles": [low, high],
        "fastest": min(times["cpu"]),
        "median_wall": float(np.median(times["wall"])),
        "rounds": len(times["cpu"]),
        "error": None if error is None else vars(error),
    }


def compare(entries: list[Entry], task: Task, repeat: int, limit: float) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Return rows and milliseconds of one task."""
    title = f"{task.scene}{task.n or ''} {task.mode}"
    ready, rows, pictures = prepare(entries, task, limit)
    own = [e.seconds[task.scene, task.mode][1] for e in ready if not e.contender.own_environment]
    true = truth(task) if own and min(own) * TRUTH_COSTS < 3 * limit else None
    times = rounds(ready, repeat, title)
    finished = []
    for row in rows:
        key = row["contender"]
        if row["status"] == "ok":
            row = summary(row, times[key], None if true is None else error_of(pictures[key], true))
        finished.append(row)
    return finished, times


def main() -> None:
    chosen = arguments()
    missing = environment.make(chosen.venv)
    description = machine.describe(None)
    if (busy := description["busy_processors_before"]) and busy > QUIET:
        print(f"Other work keeps {busy} processors busy: these figures will not be worth keeping.", file=sys.stderr)
    cpu, patience, size = max(os.sched_getaffinity(0)), 120 + 10 * chosen.limit, tuple(chosen.size)
    entries = [
        Entry(
            contender,
            environment.python_of(chosen.venv) if contender.own_environment else Path(sys.executable),
            cpu,
            patience,
            next((missing[name] for name in contender.packages if contender.own_environment and name in missing), None),
        )
        for contender in everybody()
        if contender.key in chosen.contenders
    ]
    pictures = [(scene, mode, TABLE_N if scene == "C" else 0) for scene in chosen.scenes for mode in chosen.modes]
    sweep = sorted({n for n in chosen.n if n != TABLE_N}) if "C" in chosen.scenes else []
    rows: list[dict[str, Any]] = []
    milliseconds: dict[str, Any] = {}
    for scene, mode, n in pictures + [("C", "depth", n) for n in sweep]:
        table = n in (0, TABLE_N)
        some = [entry for entry in entries if table or entry.contender.in_sweep]
        task = task_of(scene, mode, n, size)
        found, times = compare(some, task, chosen.repeat if table else chosen.repeat_n, chosen.limit)
        rows += found
        milliseconds[f"{scene}/{n}/{mode}"] = times
    for entry in entries:
        if entry.client:
            entry.client.close()
    description["busy_processors_after"] = machine.busy_processors()
    result = {
        "machine": description,
        "settings": vars(task_of("A", "shaded", 0, size).light)
        | {"size": size, "max_steps": MAX_STEPS, "epsilon": EPSILON, "table_n": TABLE_N, "limit_seconds": chosen.limit},
        "contenders": [
            {
                "key": entry.contender.key,
                "label": entry.contender.label,
                "flags": entry.contender.flags,
                "versions": entry.greeting.get("versions", {}),
                "import_seconds": entry.greeting.get("import_seconds"),
            }
            for entry in entries
        ],
        "rows": rows,
        "milliseconds": milliseconds,
    }
    out = chosen.out or machine.result_file(description, "peers-")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{description['processor']['model']}, {description['date']}\n\n{peer_tables.tables(result)}\n\n{out}")


if __name__ == "__main__":
    main()
