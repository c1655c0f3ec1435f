"""What each way of stepping takes, and how far its depth is off: time, evaluations, errors against the truth."""

from functools import partial
from typing import get_args

import octomarch as om
from octomarch.march import Method
from peers.octomarch_engine import truth
from peers.rounds import error_of
from sweeps.plan import Case, Plan, Row, timed
from sweeps.views import View, evaluations, view


def measure(plan: Plan) -> list[Row]:
    """Return a row for each scene and method; depth alone, one thread, all else as it comes."""
    return [row for name in "ABC" for row in _scene(view(name, plan.balls if name == "C" else 0), plan)]


def _scene(seen: View, plan: Plan) -> list[Row]:
    true = truth(seen.task(plan.size))

    def facts_of(image: om.Image) -> Row:
        return {"evaluations": evaluations(image), "error": vars(error_of(image.depth, true))}

    cases = [
        Case(method, partial(seen.render, plan.size, method=method), {**seen.facts, "method": method})
        for method in get_args(Method)
    ]
    return timed(cases, plan, f"methods, scene {seen.name}", facts_of)
