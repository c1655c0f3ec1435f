"""What a scene takes as it grows: scene C with 10 to 100,000 balls, its first picture and those that follow."""

import gc
import math
import time
from dataclasses import replace
from functools import partial

import octomarch as om
from sweeps.plan import Plan, Row, say
from sweeps.views import View, evaluations, view
from timing import Times

TURN = math.radians(5)  # about the vertical axis, to a picture of much the same by other rays


def measure(plan: Plan) -> list[Row]:
    """Return a row for each number of balls and picture; depth alone, one thread.

    ``first`` is a picture of a shape that was not seen before, its compilation included; ``again`` is the same picture
    of the same shape, ``turned`` one from a little to the side. ``whole`` runs the whole program at every step, and is
    left out where a smaller scene tells that it would take too long.
    """
    rows: list[Row] = []
    expected = 0.0
    for n in plan.counts:
        found = _scene(n, plan, with_whole=expected * n <= plan.whole_limit * 1e3)
        milliseconds = next((min(row["wall"]) for row in found if row["picture"] == "whole"), math.inf)
        expected = milliseconds / n
        rows += found
    return rows


def _scene(n: int, plan: Plan, with_whole: bool) -> list[Row]:
    times: dict[str, Times] = {}
    facts: dict[str, Row] = {}
    start = time.perf_counter()
    for index in range(plan.rounds_of_counts):
        if index and time.perf_counter() - start > plan.seconds_of_counts:
            break
        say(f"{n:,} balls: round {index + 1} of {plan.rounds_of_counts}")
        facts |= _round(n, plan, with_whole, times)
        gc.collect()  # nothing of the shape may be left when the next round makes it
    return [{**facts[picture], "cpu": found.cpu, "wall": found.wall} for picture, found in times.items()]


def _round(n: int, plan: Plan, with_whole: bool, times: dict[str, Times]) -> dict[str, Row]:
    """Make the shape, time its pictures, and return what was counted. No image is kept: each knows its shape."""
    facts: dict[str, Row] = {}
    start = time.perf_counter()
    for picture, run in _pictures(view("C", n), plan.size, with_whole).items():
        if facts and time.perf_counter() - start > plan.seconds_of_counts:
            break
        image = times.setdefault(picture, Times()).add(run)
        cells = {name: image.stats[name] for name in ("cells", "cell_bytes")}
        facts[picture] = {"n": n, "picture": picture, "evaluations": evaluations(image), **cells}
    return facts


def _pictures(seen: View, size: tuple[int, int], with_whole: bool) -> dict[str, partial[om.Image]]:
    """Return the pictures of a shape in the order in which they are rendered."""
    beside = replace(seen, camera=_turned(seen.camera))
    found = {"first": partial(seen.render, size), "again": partial(seen.render, size)}
    found["turned"] = partial(beside.render, size)
    if with_whole:
        found["whole"] = partial(seen.render, size, prune=False)
    return found


def _turned(camera: om.Camera) -> om.Camera:
    x, y, z = camera.eye
    sine, cosine = math.sin(TURN), math.cos(TURN)
    return replace(camera, eye=(cosine * x + sine * z, y, cosine * z - sine * x))
