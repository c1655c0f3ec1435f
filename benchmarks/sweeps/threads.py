"""What more threads gain, up to as many as there are processors."""

import os
from functools import partial

from sweeps.plan import Case, Plan, Row, timed
from sweeps.views import view


def numbers(processors: int) -> list[int]:
    """Return how many threads to try: all numbers up to 8, then powers of two, and all processors."""
    return sorted({n for n in range(1, processors + 1) if n <= 8 or n & (n - 1) == 0 or n == processors})


def measure(plan: Plan) -> list[Row]:
    """Return a row for each scene and number of threads; full shading."""
    rows = []
    for name in "ABC":
        seen = view(name, plan.balls if name == "C" else 0)
        cases = [
            Case(str(n), partial(seen.render, plan.size, "shaded", threads=n), {**seen.facts, "threads": n})
            for n in numbers(len(os.sched_getaffinity(0)))
        ]
        rows += timed(cases, plan, f"threads, scene {name}", lambda _: {})
    return rows
