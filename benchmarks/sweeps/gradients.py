"""What an exact gradient takes beside a distance, at the points of a picture's surface."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

import octomarch as om
from sweeps.plan import Case, Plan, Row, timed
from sweeps.views import View, view


def surface_points(seen: View, size: tuple[int, int]) -> NDArray[np.float64]:
    """Return the points that a picture shows, row by row."""
    march = om.March(max_distance=seen.max_distance)
    image = om.render(seen.shape, seen.camera, size, march=march, planes=("position", "status"))
    return np.asarray(image.position[image.status == om.Status.HIT], np.float64)


def measure(plan: Plan) -> list[Row]:
    """Return rows of distances and of gradients for each scene and instruction set; float32, one thread."""
    rows = []
    for seen in map(view, "AB"):
        points = surface_points(seen, plan.size)
        cases = [
            Case(
                f"{isa}/{asked}",
                partial(query, points, precision="float32", threads=1, isa=isa),
                {**seen.facts, "isa": isa, "asked": asked, "points": len(points)},
            )
            for isa in om.isas()
            for asked, query in (("distance", seen.shape.distance), ("gradient", seen.shape.gradient))
        ]
        rows += timed(cases, plan, f"gradients, scene {seen.name}", lambda _: {})
    return rows
