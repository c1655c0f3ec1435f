"""How often each method evaluates the field on the scenes of cases.py, and how often it is wrong.

``python benchmarks/evaluations.py`` prints a table and keeps it in benchmarks/results/evaluations.json. Costs are
counts, so the table is the same on every machine. The truth is proven by interval arithmetic (`octomarch.reference`).
tables.py comes after it.
"""

import argparse
import json
from pathlib import Path
from typing import Any, get_args

import numpy as np

import evaluation_tables
import octomarch as om
from cases import CASES
from octomarch.march import Method
from octomarch.reference import Brackets, Verdict

SIZE = (320, 240)
EPSILON = 1e-4
FAR = 100.0
METHODS = tuple(method for method in get_args(Method) if method != "fixed")


def measure(name: str, method: Method, truth: Brackets, size: tuple[int, int]) -> dict[str, Any]:
    """Return a row; rays whose truth is not decided count for no error."""
    shape, camera = CASES[name]()
    march = om.March(method, epsilon=EPSILON, pixel_tolerance=0, max_distance=FAR)
    image = om.render(shape, camera, size, march=march, planes=("depth", "status"), precision="float64")
    hit, miss = image.status == om.Status.HIT, image.status == om.Status.MISS
    both = hit & (truth.status == Verdict.HIT)
    error = np.abs(image.depth[both] - (truth.t_lo[both] + truth.t_hi[both]) / 2)
    rays = image.stats["rays"]
    return {
        "case": name,
        "method": method,
        "primary": image.stats["stages"]["primary"]["evaluations"] / rays,
        "cones": image.stats["stages"]["cones"]["evaluations"] / rays,
        "false_misses": int((miss & np.isin(truth.status, [Verdict.HIT, Verdict.INSIDE])).sum()),
        "false_hits": int((hit & (truth.status == Verdict.MISS)).sum()),
        "undecided": int((image.status == om.Status.STEP_LIMIT).sum()),
        "p95": float(np.percentile(error, 95)),
    }


def run(size: tuple[int, int]) -> dict[str, Any]:
    """Return the rows of all scenes and methods."""
    rows = []
    for name, case in CASES.items():
        truth = om.reference.certified_picture(*case(), size, FAR)
        rows += [measure(name, method, truth, size) for method in METHODS]
    return {"size": size, "epsilon": EPSILON, "rows": rows}


def main() -> None:
    root = Path(__file__).parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, nargs=2, metavar=("W", "H"), default=SIZE)
    parser.add_argument("--out", type=Path, metavar="FILE", default=root / "results" / "evaluations.json")
    chosen = parser.parse_args()
    result = run(tuple(chosen.size))
    print(evaluation_tables.table(result))
    chosen.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
