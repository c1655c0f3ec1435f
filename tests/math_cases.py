"""What test_math_accuracy.py and benchmarks/ulp.py measure: functions of expressions, in units of the last place (ulp).

Each has arguments where it is easy and where it is hard; the truth is mpmath's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.floating[Any]]
Arguments = tuple[Array, ...]
Maker = Callable[[np.random.Generator, type, int], Arguments]
"""Makes arguments of a precision, about so many of each kind."""

PRECISE = 240
"""Bits that mpmath works with; it adds what the reduction of large angles needs."""


@dataclass(frozen=True)
class Case:
    """A function, where it is tried, and the largest error allowed there: docs/accuracy.md's, rounded up."""

    ours: Callable[..., om.Expression]
    truth: Callable[..., mpmath.mpf]
    arguments: Maker
    limit: float


def of_every_size(rng: np.random.Generator, dtype: type, count: int) -> Array:
    """Return normal numbers with evenly spread exponents, both signs."""
    info = np.finfo(dtype)
    exponents = rng.integers(info.minexp, info.maxexp, count)
    return np.ldexp(rng.uniform(1, 2, count).astype(dtype), exponents) * rng.choice(np.array([-1, 1], dtype), count)


def ever_closer(rng: np.random.Generator, dtype: type, count: int) -> NDArray[np.float64]:
    """Return numbers in (0, 1] down to the last place of 1, evenly by their exponents."""
    return 2.0 ** -rng.uniform(0, np.finfo(dtype).nmant + 1, count)


def slopes(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return tangents: small ones and of every size."""
    return (np.concatenate([rng.uniform(-4, 4, count).astype(dtype), of_every_size(rng, dtype, count)]),)


def exponents(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return exponents to e, from where the result is 0 to just before it overflows, and small ones."""
    info = np.finfo(dtype)
    least, most = (bits * np.log(2) for bits in (info.minexp - info.nmant - 1, info.maxexp))
    all_results = rng.uniform(least, most * (1 - 1e-7), count)
    small = rng.uniform(-1, 1, count) * ever_closer(rng, dtype, count)
    return (np.concatenate([all_results, small]).astype(dtype),)


def positive(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return numbers of every size, numbers around 1, and numbers ever closer to it."""
    around = rng.uniform(0.5, 2, count)
    near = 1 + rng.uniform(-0.5, 0.5, count) * ever_closer(rng, dtype, count)
    return (np.concatenate([np.abs(of_every_size(rng, dtype, count)), np.concatenate([around, near]).astype(dtype)]),)


def angles(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return small angles, angles of every size, and neighbours of multiples of π/2, where cancellation is worst."""
    multiples = (np.floor(2 ** rng.uniform(0, 60, count)) * (np.pi / 2)).astype(dtype)
    neighbours = np.nextafter(multiples, rng.choice(np.array([-np.inf, np.inf], dtype), count))
    hardest = np.array([16367173 * 2.0**72 if dtype is np.float32 else 6381956970095103 * 2.0**797], dtype)
    small = rng.uniform(-10, 10, count).astype(dtype)
    return (np.concatenate([small, multiples, neighbours, hardest, of_every_size(rng, dtype, count)]),)


def cosines(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return numbers over [−1, 1], and numbers ever closer to its ends and to 0."""
    signs = rng.choice([-1, 1], count)
    away = ever_closer(rng, dtype, count)
    return (np.concatenate([rng.uniform(-1, 1, count), signs * (1 - away), signs * away]).astype(dtype),)


def points_of_the_plane(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return pairs y, x: around the origin, near the diagonals, and of every size."""
    y, x = rng.uniform(-2, 2, (2, count))
    near = x * (1 + rng.uniform(-0.5, 0.5, count) * ever_closer(rng, dtype, count))
    ys = np.concatenate([y.astype(dtype), near.astype(dtype), of_every_size(rng, dtype, count)])
    return ys, np.concatenate([x.astype(dtype), x.astype(dtype), of_every_size(rng, dtype, count)])


def powers(rng: np.random.Generator, dtype: type, count: int) -> Arguments:
    """Return bases of every size and near 1, with exponents that take them to results of every size.

    A quarter of the exponents is whole, with negative bases.
    """
    (bases,) = positive(rng, dtype, count)
    bases = bases[bases != 1]
    info = np.finfo(dtype)
    logs = np.log2(bases.astype(np.float64))
    exact = rng.uniform(info.minexp, info.maxexp - 0.01, bases.size) / logs
    whole = (rng.random(bases.size) < 0.25) & (np.abs(np.round(exact) * logs) < info.maxexp - 1)
    return np.where(whole, -bases, bases), np.where(whole, np.round(exact), exact).astype(dtype)


CASES = {
    "exp": Case(om.exp, mpmath.exp, exponents, 0.8),
    "log": Case(om.log, mpmath.log, positive, 1.0),
    "sin": Case(om.sin, mpmath.sin, angles, 0.9),
    "cos": Case(om.cos, mpmath.cos, angles, 0.9),
    "tan": Case(om.tan, mpmath.tan, angles, 2.5),
    "asin": Case(om.asin, mpmath.asin, cosines, 1.25),
    "acos": Case(om.acos, mpmath.acos, cosines, 1.25),
    "atan": Case(om.atan, mpmath.atan, slopes, 1.0),
    "atan2": Case(om.atan2, mpmath.atan2, points_of_the_plane, 1.0),
    "power": Case(om.power, mpmath.power, powers, 1.5),
}


def evaluated(function: Callable[..., om.Expression], arguments: Arguments, isa: str | None = None) -> Array:
    """Return a function's values, in the precision of the arguments."""
    dtype = arguments[0].dtype
    points = np.zeros((arguments[0].size, 3), dtype)
    points[:, : len(arguments)] = np.stack(arguments, axis=-1)
    operands = om.coordinates()[: len(arguments)]
    return om.field(function(*operands), lipschitz=1).distance(points, precision=dtype.name, isa=isa)


def ulps(found: Array, truths: list[mpmath.mpf]) -> NDArray[np.float64]:
    """Return distances from the truth, in units of the last place that the truth has in the precision of `found`."""
    info = np.finfo(found.dtype)
    errors = np.empty(found.size)
    for i, (number, truth) in enumerate(zip(found.tolist(), truths, strict=True)):
        _, exponent = mpmath.frexp(truth)
        ulp = mpmath.ldexp(1, max(int(exponent), info.minexp + 1) - info.nmant - 1)
        errors[i] = abs(mpmath.mpf(number) - truth) / ulp
    return errors


def errors(case: Case, arguments: Arguments) -> NDArray[np.float64]:
    """Return the errors of a function in ulp; infinite where its value is not finite."""
    found = evaluated(case.ours, arguments)
    with mpmath.workprec(PRECISE):
        truths = [
            case.truth(*map(mpmath.mpf, numbers)) for numbers in zip(*(a.tolist() for a in arguments), strict=True)
        ]
        return np.where(np.isfinite(found), ulps(np.nan_to_num(found), truths), np.inf)
