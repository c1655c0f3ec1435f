"""Everybody's rounds: who starts, what a picture costs each, how far it is off. compare.py comes before and after."""

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from peers.client import Client, GoneError
from peers.octomarch_engine import truth
from peers.registry import Contender
from peers.tasks import Mode, Task

TRUTH_COSTS = 10.0  # times what octomarch's own picture does


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

    def close(self) -> None:
        if self.client:
            self.client.close()
            self.client = None

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
        # More than the slowest round, lest the spread of long pictures looks like compilation.
        "compile_seconds": max(row["first_cpu_seconds"] - max(times["cpu"]) / 1e3, 0.0),
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
