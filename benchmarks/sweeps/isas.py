"""What instruction sets and precisions take: SIMD against one lane, float64 against float32."""

from functools import partial
from typing import get_args

import octomarch as om
from octomarch._validate import Precision
from peers.octomarch_engine import truth
from peers.rounds import error_of
from sweeps.plan import Case, Plan, Row, timed
from sweeps.views import MODES, evaluations, view


def measure(plan: Plan) -> list[Row]:
    """Return a row for each scene, mode, instruction set and precision; one thread."""
    rows = []
    for seen in map(view, "AB"):
        true = truth(seen.task(plan.size))
        for mode in MODES:

            def facts_of(image: om.Image, true: object = true) -> Row:
                error = vars(error_of(image.depth, true)) if "depth" in image.planes else None
                return {"evaluations": evaluations(image), "error": error}

            cases = [
                Case(
                    f"{isa}/{precision}",
                    partial(seen.render, plan.size, mode, isa=isa, precision=precision),
                    {**seen.facts, "mode": mode, "isa": isa, "precision": precision},
                )
                for isa in om.isas()
                for precision in get_args(Precision)
            ]
            rows += timed(cases, plan, f"instruction sets, scene {seen.name}, {mode}", facts_of)
    return rows
