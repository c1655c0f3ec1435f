"""Measure the largest errors of the functions that expressions are made of: the table of docs/accuracy.md.

``python benchmarks/ulp.py`` tries the arguments of tests/math_cases.py, many more of them than the tests, against
mpmath in both precisions. With ``--all-floats`` functions of one argument are tried on every finite float32 instead,
against the C library in double, whose own error is a billionth of what is measured; that takes minutes a function.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from math_cases import CASES, Case, errors, evaluated

IN_DOUBLE = {
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
}
CHUNK = 1 << 20


def sampled(case: Case, precision: str, count: int) -> tuple[float, list[float]]:
    """Return the largest error among `count` arguments of each kind, and where it is."""
    arguments = case.arguments(np.random.default_rng(), np.dtype(precision).type, count)
    found = errors(case, arguments)
    worst = int(found.argmax())
    return float(found[worst]), [operand[worst].item() for operand in arguments]


def float_errors(found: NDArray[np.float32], truth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return errors in ulp of float32; infinite where only one of both is a number, none where both overflow."""
    rounded = truth.astype(np.float32)
    _, exponent = np.frexp(truth)
    ulp = np.ldexp(1.0, np.maximum(exponent, -125) - 24)
    alike = (found == rounded) | (np.isnan(found) & np.isnan(rounded))
    finite = np.isfinite(found) & np.isfinite(rounded)
    return np.where(finite, np.abs(found - truth) / ulp, np.where(alike, 0, np.inf))


def all_floats(name: str) -> tuple[float, list[float]]:
    """Return the largest error of a function among all finite floats, and where it is."""
    largest, where = 0.0, 0.0
    for start in range(0, 1 << 32, CHUNK):
        x = np.arange(start, start + CHUNK, dtype=np.uint32).view(np.float32)
        x = x[np.isfinite(x)]
        if x.size == 0:
            continue
        with np.errstate(all="ignore"):
            found = float_errors(evaluated(CASES[name].ours, (x,)), IN_DOUBLE[name](x.astype(np.float64)))
        worst = int(found.argmax())
        if found[worst] > largest:
            largest, where = float(found[worst]), x[worst].item()
    return largest, [where]


def main() -> None:
    parser = argparse.ArgumentParser(description="Largest errors of the functions of expressions, in ulp.")
    parser.add_argument("functions", nargs="*", help=f"of {', '.join(CASES)}; all by default")
    parser.add_argument("--count", type=int, default=100_000, help="arguments of each kind")
    parser.add_argument("--all-floats", action="store_true", help="every float32, for functions of one argument")
    options = parser.parse_args()
    print("| function | precision | largest error (ulp) | at |\n|---|---|---|---|")
    for name in options.functions or CASES:
        for precision in ("float32", "float64"):
            if options.all_floats:
                if precision == "float64" or name not in IN_DOUBLE:
                    continue
                largest, where = all_floats(name)
            else:
                largest, where = sampled(CASES[name], precision, options.count)
            print(f"| {name} | {precision} | {largest:.3f} | {', '.join(map(repr, where))} |", flush=True)


if __name__ == "__main__":
    main()
