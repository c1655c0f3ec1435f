"""Hypothesis strategies of expressions, each with what numpy makes of it, and how far another evaluation may be off.

A `Tracked` value carries, beside the numbers in double, a bound of the error of evaluations in another precision, in
unit roundoffs of that precision, by the rules of first-order error analysis (N. J. Higham, "Accuracy and Stability of
Numerical Algorithms", 2002, chapter 3). Where an error decides (at jumps and kinks of slopes without bound) it is
infinite, so that nothing is asked there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]

FUNCTION_ROUNDINGS = 4
"""Error of a transcendental function, in unit roundoffs of its result: those in ops/math.hpp are within 1.5 units in
the last place, which are up to two roundoffs each."""
LARGEST = 1e30
"""Beyond this float32 overflows in the next products."""
NOISE_SLOPE = 3.75
NOISE_ROUNDINGS = 64
"""The terms of noise's fade reach 15 before they cancel, and are rounded three times each."""
SMALLEST = 1e-30
"""Below this float32 loses digits in the next products: a number so small is as good as 0."""


@dataclass(frozen=True)
class Tracked:
    """Numbers, and the errors of other evaluations in unit roundoffs `u`."""

    value: Array
    error: Array
    u: float

    def made(self, value: Array, error: Array, roundings: float = 1.0) -> Tracked:
        with np.errstate(all="ignore"):
            total = error + roundings * np.abs(value) + SMALLEST / self.u
            lost = (np.abs(value) > LARGEST) | ~np.isfinite(total)
        return Tracked(value, np.where(lost, np.inf, total), self.u)

    def sure(self, distance: Array) -> NDArray[np.bool_]:
        """Tell where an error cannot decide on which side of a jump at `distance` the number lies."""
        return np.abs(distance) > 4 * self.u * self.error


def tracked(value: Array, u: float) -> Tracked:
    return Tracked(value, np.zeros_like(value), u)


@dataclass(frozen=True)
class Sample:
    """An expression, and the same for numpy: a function of the tracked coordinates."""

    expression: om.Expression
    numpy: Callable[[Tracked, Tracked, Tracked], Tracked]
    text: str

    def at(self, points: Array, u: float) -> Tracked:
        with np.errstate(all="ignore"):
            return self.numpy(*(tracked(points[:, i].copy(), u) for i in range(3)))


def _unary(name: str, build: Callable, rule: Callable[[Tracked], Tracked]) -> Callable[[Sample], Sample]:
    def applied(a: Sample) -> Sample:
        return Sample(build(a.expression), lambda x, y, z: rule(a.numpy(x, y, z)), f"{name}({a.text})")

    return applied


def _binary(name: str, build: Callable, rule: Callable[[Tracked, Tracked], Tracked]) -> Callable[..., Sample]:
    def applied(a: Sample, b: Sample) -> Sample:
        def numpy(x: Tracked, y: Tracked, z: Tracked) -> Tracked:
            return rule(a.numpy(x, y, z), b.numpy(x, y, z))

        return Sample(build(a.expression, b.expression), numpy, f"{name}({a.text}, {b.text})")

    return applied


def _smooth(function: Callable, slope: Callable) -> Callable[[Tracked], Tracked]:
    def rule(a: Tracked) -> Tracked:
        # the slope may be larger within the error: twice covers all but the steepest, which are looked at apart
        nearby = np.maximum(np.abs(slope(a.value - 4 * a.u * a.error)), np.abs(slope(a.value + 4 * a.u * a.error)))
        steepness = np.maximum(np.abs(slope(a.value)), nearby)
        return a.made(function(a.value), np.where(a.error == 0, 0, steepness * a.error), FUNCTION_ROUNDINGS)

    return rule


def _floor(a: Tracked) -> Tracked:
    sure = a.sure(a.value - np.round(a.value)) | (a.error <= SMALLEST / a.u)
    return a.made(np.floor(a.value), np.where(sure, 0, np.inf), 0)


def _divide(a: Tracked, b: Tracked) -> Tracked:
    quotient = a.value / b.value
    error = (a.error + np.abs(quotient) * b.error) / np.abs(b.value)
    return a.made(quotient, np.where(b.sure(b.value), 2 * error, np.inf))


def _mod(a: Tracked, b: Tracked) -> Tracked:
    ratio = _divide(a, b)
    whole = np.floor(ratio.value)
    # the product's rounding counts, not only that of the difference
    error = a.error + np.abs(whole) * b.error + np.abs(whole * b.value) + np.abs(a.value)
    return a.made(a.value - b.value * whole, np.where(ratio.sure(ratio.value - np.round(ratio.value)), error, np.inf))


def _less(a: Tracked, b: Tracked) -> Tracked:
    both = Tracked(a.value, a.error + b.error, a.u)
    sure = both.sure(a.value - b.value) | (both.error == 0)
    return a.made((a.value < b.value).astype(float), np.where(sure, 0, np.inf), 0)


def _atan2(y: Tracked, x: Tracked) -> Tracked:
    squared = x.value**2 + y.value**2
    error = (np.abs(x.value) * y.error + np.abs(y.value) * x.error) / squared
    sure = (x.sure(x.value) & (x.value > 0)) | y.sure(y.value)
    return y.made(np.arctan2(y.value, x.value), np.where(sure, 2 * error, np.inf), FUNCTION_ROUNDINGS)


def _where(condition: Sample, a: Sample, b: Sample) -> Sample:
    def numpy(x: Tracked, y: Tracked, z: Tracked) -> Tracked:
        test, first, second = (sample.numpy(x, y, z) for sample in (condition, a, b))
        chosen = test.value != 0
        error = np.where(chosen, first.error, second.error)
        sure = test.sure(test.value) | (test.error <= SMALLEST / test.u)
        return test.made(np.where(chosen, first.value, second.value), np.where(sure, error, np.inf), 0)

    built = om.where(condition.expression, a.expression, b.expression)
    return Sample(built, numpy, f"where({condition.text}, {a.text}, {b.text})")


def gradient_noise(points: Array, seed: int) -> Array:
    """Return noise at points (n, 3) as docs/semantics.md defines it, with lattices in whole numbers; s = `seed`."""
    corner = np.floor(points).astype(np.int64)
    f = points - corner
    fade = f**3 * (f * (6 * f - 15) + 10)

    def permuted(n: NDArray[np.int64]) -> NDArray[np.int64]:
        n = n % 289
        return (34 * n + 1) * n % 289

    total = np.zeros(len(points))
    for offset in np.ndindex(2, 2, 2):
        i, j, k = (corner + offset).T
        index = permuted(permuted(permuted(k + seed) + j) + i) % 12
        plane, signs = index // 4, np.stack([1 - 2 * (index // 2 % 2), 1 - 2 * (index % 2)])
        r = f - offset
        along = signs[0] * np.choose(plane, [r[:, 0], r[:, 0], r[:, 1]])
        along += signs[1] * np.choose(plane, [r[:, 1], r[:, 2], r[:, 2]])
        total += np.prod(np.where(offset, fade, 1 - fade), axis=1) * along
    return total


def _noise(a: Sample, b: Sample, c: Sample) -> Sample:
    def numpy(x: Tracked, y: Tracked, z: Tracked) -> Tracked:
        first, second, third = (sample.numpy(x, y, z) for sample in (a, b, c))
        points = np.stack([first.value, second.value, third.value], axis=-1)
        inside = np.isfinite(points).all(axis=1) & (np.abs(points) < 1e4).all(axis=1)
        value = np.where(inside, gradient_noise(np.where(inside[:, None], points, 0), 0), np.nan)
        error = NOISE_SLOPE * (first.error + second.error + third.error) + NOISE_ROUNDINGS
        return first.made(value, np.where(inside, error, np.inf))

    built = om.noise(a.expression, b.expression, c.expression)
    return Sample(built, numpy, f"noise({a.text}, {b.text}, {c.text})")


def _power(a: Tracked, b: Tracked) -> Tracked:
    value = a.value**b.value
    logarithm = np.log(a.value)
    relative = np.abs(b.value / a.value) * a.error + np.abs(logarithm) * b.error
    return a.made(
        value, np.where(a.sure(a.value) & (a.value > 0), 2 * np.abs(value) * relative, np.inf), 2 * FUNCTION_ROUNDINGS
    )


def _less_equal(a: Tracked, b: Tracked) -> Tracked:
    fails = _less(b, a)
    return Tracked(1 - fails.value, fails.error, fails.u)


def _sqrt(a: Tracked) -> Tracked:
    root = np.sqrt(a.value)
    return a.made(root, np.where(a.sure(a.value), a.error / root, np.where(a.error == 0, 0, np.inf)))


UNARY = {
    "negate": _unary("-", lambda a: -a, lambda a: a.made(-a.value, a.error, 0)),
    "abs": _unary("abs", abs, lambda a: a.made(np.abs(a.value), a.error, 0)),
    "sqrt": _unary("sqrt", om.sqrt, _sqrt),
    "floor": _unary("floor", om.floor, _floor),
    "exp": _unary("exp", om.exp, _smooth(np.exp, np.exp)),
    "log": _unary("log", om.log, _smooth(np.log, lambda x: np.where(x > 0, 1 / x, np.inf))),
    "sin": _unary("sin", om.sin, _smooth(np.sin, np.ones_like)),
    "cos": _unary("cos", om.cos, _smooth(np.cos, np.ones_like)),
    "atan": _unary("atan", om.atan, _smooth(np.arctan, np.ones_like)),
    "tan": _unary("tan", om.tan, _smooth(np.tan, lambda x: 1 + np.tan(x) ** 2)),
    "asin": _unary("asin", om.asin, _smooth(np.arcsin, lambda x: 1 / np.sqrt(1 - x * x))),
    "acos": _unary("acos", om.acos, _smooth(np.arccos, lambda x: 1 / np.sqrt(1 - x * x))),
}
BINARY = {
    "add": _binary("+", lambda a, b: a + b, lambda a, b: a.made(a.value + b.value, a.error + b.error)),
    "subtract": _binary("-", lambda a, b: a - b, lambda a, b: a.made(a.value - b.value, a.error + b.error)),
    "multiply": _binary(
        "*",
        lambda a, b: a * b,
        lambda a, b: a.made(a.value * b.value, 2 * (np.abs(a.value) * b.error + np.abs(b.value) * a.error)),
    ),
    "divide": _binary("/", lambda a, b: a / b, _divide),
    "mod": _binary("mod", lambda a, b: a % b, _mod),
    "atan2": _binary("atan2", om.atan2, _atan2),
    "less": _binary("<", lambda a, b: a < b, _less),
    "less_equal": _binary("<=", lambda a, b: a <= b, _less_equal),
    "pow": _binary("**", lambda a, b: a**b, _power),
    "minimum": _binary(
        "min", om.minimum, lambda a, b: a.made(np.minimum(a.value, b.value), np.maximum(a.error, b.error), 0)
    ),
    "maximum": _binary(
        "max", om.maximum, lambda a, b: a.made(np.maximum(a.value, b.value), np.maximum(a.error, b.error), 0)
    ),
}

TERNARY = {"where": _where, "noise": _noise}

_X, _Y, _Z = om.coordinates()
coordinate = st.sampled_from(
    [
        Sample(_X, lambda x, y, z: x, "x"),
        Sample(_Y, lambda x, y, z: y, "y"),
        Sample(_Z, lambda x, y, z: z, "z"),
    ]
)


def _constant(value: float) -> Sample:
    expression = om.minimum(value)
    # a rounding, where float32 does not hold the number
    return Sample(expression, lambda x, y, z: x.made(np.full_like(x.value, value), np.zeros_like(x.value)), str(value))


constant = st.sampled_from([0.25, 0.5, 1.0, 1.5, 2.0, -1.0, 3.0, 0.3, -0.7, 7.1]).map(_constant)


def expression(operations: int = 12, kinds: tuple[str, ...] = (*UNARY, *BINARY, *TERNARY)) -> st.SearchStrategy[Sample]:
    """Expressions over shared operands, made by up to `operations` operations of the given kinds."""

    @st.composite
    def built(draw: st.DrawFn) -> Sample:
        pool = draw(st.lists(st.one_of(coordinate, coordinate, constant), min_size=2, max_size=4))
        operand = st.integers(0, 10**6)
        for kind in draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=operations)):
            count = 1 if kind in UNARY else 3 if kind in TERNARY else 2
            # the latest more often, so that expressions grow deep
            chosen = [pool[-1 - min(draw(operand) % len(pool), draw(operand) % len(pool))] for _ in range(count)]
            make = UNARY.get(kind) or BINARY.get(kind) or TERNARY[kind]
            pool.append(make(*chosen))
        return pool[-1]

    return built()
