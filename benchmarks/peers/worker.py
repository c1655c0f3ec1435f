"""One contender in a process of its own: it prepares a task and renders it as often as it is told to.

``python -m peers.worker SPECIFICATION CPU``, with a specification as registry.py makes it. Requests are lines of JSON
on standard input, answers on standard output; what the library prints goes to standard error. compare.py asks.
"""

import gc
import importlib
import importlib.metadata
import json
import os
import sys
import time
from collections.abc import Callable
from typing import Any, TextIO

import numpy as np

from peers.tasks import Task


class Worker:
    """Answers requests; `render` is what "prepare" has made."""

    def __init__(self, module: str, options: dict[str, Any]) -> None:
        self.module = importlib.import_module(f"peers.{module}")
        self.options = options
        self.render: Callable[[], Any] | None = None

    def prepare(self, task: dict[str, Any], picture: str) -> dict[str, Any]:
        """Render a first time: what a library compiles is compiled here."""
        self.render = None
        gc.collect()
        wall, cpu = time.perf_counter(), time.process_time()
        self.render = self.module.prepare(Task.from_json(task), **self.options)
        pixels = self.render()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        np.save(picture, pixels)
        return {"first_seconds": wall, "first_cpu_seconds": cpu}

    def round(self) -> dict[str, Any]:
        if self.render is None:
            raise RuntimeError("nothing is prepared")
        wall, cpu = time.perf_counter_ns(), time.process_time_ns()
        self.render()
        cpu, wall = time.process_time_ns() - cpu, time.perf_counter_ns() - wall
        return {"wall": wall / 1e6, "cpu": cpu / 1e6}


def serve(worker: Worker, requests: TextIO, answer: Callable[[dict[str, Any]], None]) -> None:
    for line in requests:
        request = json.loads(line)
        try:
            answer(getattr(worker, request.pop("do"))(**request))
        except Exception as error:
            answer({"error": first_line(error)})


def first_line(error: BaseException) -> str:
    """Return kind and first line of an error: of the one behind it all, where others were raised from it."""
    while error.__cause__:
        error = error.__cause__
    lines = str(error).strip().splitlines()
    return f"{type(error).__name__}: {lines[0][:300]}" if lines else type(error).__name__


def main() -> None:
    replies = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # libraries greet on standard output

    def answer(reply: dict[str, Any]) -> None:
        replies.write(json.dumps(reply) + "\n")
        replies.flush()

    specification = json.loads(sys.argv[1])
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {int(sys.argv[2])})
    begin = time.perf_counter()
    try:
        worker = Worker(specification["module"], specification["options"])
    except Exception as error:
        answer({"error": first_line(error)})
        return
    seconds = time.perf_counter() - begin
    gc.disable()
    versions = {name: importlib.metadata.version(name) for name in specification["packages"]}
    versions |= getattr(worker.module, "VERSIONS", {})
    answer({"import_seconds": seconds, "versions": versions})
    serve(worker, sys.stdin, answer)


if __name__ == "__main__":
    main()
