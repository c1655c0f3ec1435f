"""Certified brackets against ball arithmetic of 128 bits: python-flint's arb, with each field written out anew.

A bracket is right if the field is positive at all t before it and ≤ 0 at its end; a miss, if it is positive everywhere.
"""

from collections.abc import Callable

import numpy as np
import pytest
from flint import arb, ctx

import octomarch as om
from octomarch.reference import Verdict

Function = Callable[[arb, arb, arb], arb]

TWIST = om.box((1.0, 2.0, 0.5)).twist(40, axis="y")
FARTHEST = 12.0
NEAR = 1e-7
"""So near a root arb is asked at points alone: balls would have to be as many as are short."""


def length(*numbers: arb) -> arb:
    """Return √(a² + b² + …); of a ball that holds 0, arb's own root is no number."""
    squared = sum((a * a for a in numbers), arb(0))
    return max(squared.lower(), arb(0)).sqrt().union(squared.upper().sqrt())


def smooth_minimum(a: arb, b: arb, k: float) -> arb:
    both = (arb(k) - abs(a - b)).max(arb(0))
    return a.min(b) - both * both / (4 * arb(k))


def exact(number: float) -> arb:
    """Return a float as the number that it is."""
    return arb(number)


def blended(x: arb, y: arb, z: arb) -> arb:
    ring = length(length(x, z) - 1, y) - exact(0.3)
    return smooth_minimum(ring, length(x - exact(0.4), y - exact(0.5), z) - exact(0.6), 0.25)


def twisted(x: arb, y: arb, z: arb) -> arb:
    """Return TWIST's field: that of the box at the turned point, cut to the cylinder of its corners."""
    rate, radius, _ = (exact(number) for number in TWIST._node.parameters)
    across = length(x, z)
    share = radius / across.max(radius)
    u, v = x * share, z * share
    c, s = (rate * y).cos(), (rate * y).sin()
    q = [abs(a) - exact(h) for a, h in ((c * u - s * v, 0.5), (y, 1.0), (s * u + c * v, 0.25))]
    outside = length(*(a.max(arb(0)) for a in q))
    inside = q[0].max(q[1]).max(q[2]).min(arb(0))
    return (outside + inside).max(across - radius)


def gyroid(x: arb, y: arb, z: arb) -> arb:
    wave = (2 * x).sin() * (2 * y).cos() + (2 * y).sin() * (2 * z).cos() + (2 * z).sin() * (2 * x).cos()
    return (abs(wave) - exact(0.2)).max(length(x, y, z) - 2)


def melted(x: arb, y: arb, z: arb) -> arb:
    a, b = length(x + 1, y, z) - exact(0.75), length(x - 1, y, z) - exact(0.75)
    return a.min(b) - exact(0.2) * (1 + (-abs(a - b) / exact(0.2)).exp()).log()


def stretched(x: arb, y: arb, z: arb) -> arb:
    """Return the field of the ball of radius 1 times the least factor: radii 1.5, 0.5 and 1."""
    return (length(x / exact(1.5), y / exact(0.5), z) - 1) * exact(0.5)


def expressions() -> tuple[om.Shape, Function]:
    x, y, z = om.coordinates()
    wave = om.sin(2 * x) * om.cos(2 * y) + om.sin(2 * y) * om.cos(2 * z) + om.sin(2 * z) * om.cos(2 * x)
    return om.field(om.maximum(abs(wave) - 0.2, om.length(x, y, z) - 2), lipschitz=6), gyroid


FIELDS: dict[str, tuple[om.Shape, Function]] = {
    "blended": (om.torus(1, 0.3).union(om.sphere(0.6).translate(0.4, 0.5, 0), smooth=0.25), blended),
    "twisted": (TWIST, twisted),
    "gyroid": expressions(),
    "melted": (om.metaballs(om.sphere(0.75).translate(-1, 0, 0), om.sphere(0.75).translate(1, 0, 0), k=0.2), melted),
    "stretched": (om.sphere(1.0).stretch((1.5, 0.5, 1.0)), stretched),
}


@pytest.fixture(autouse=True)
def _precision():
    before, ctx.prec = ctx.prec, 128
    yield
    ctx.prec = before


def rays(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return rays from a sphere of radius 5 around to points near the middle, of directions of various lengths."""
    rng = np.random.default_rng(11)
    origins = rng.normal(size=(count, 3))
    origins *= 5 / np.linalg.norm(origins, axis=1)[:, None]
    aims = rng.uniform(-1.5, 1.5, (count, 3)) - origins
    return origins, aims * rng.uniform(0.2, 2, (count, 1))


def positive_between(field: Callable[[arb], arb], first: float, last: float) -> bool:
    """Tell whether the field is proven positive from first to last, cutting until balls decide."""
    pieces = [(first, last)]
    while pieces:
        lo, hi = pieces.pop()
        if field(arb(lo).union(arb(hi))) > 0:
            continue
        if hi - lo < NEAR / 64:
            return False
        middle = (lo + hi) / 2
        pieces += [(middle, hi), (lo, middle)]
    return True


@pytest.mark.parametrize("name", FIELDS)
def test_brackets_and_misses_are_true(name: str):
    shape, function = FIELDS[name]
    origins, directions = rays(60)
    found = om.reference.certified(shape, origins, directions, max_distance=FARTHEST)
    assert set(found.status.tolist()) == {Verdict.HIT, Verdict.MISS}
    for o, d, lo, hi, status in zip(origins, directions, found.t_lo, found.t_hi, found.status, strict=True):

        def field(t: arb, o: np.ndarray = o, d: np.ndarray = d) -> arb:
            return function(*(exact(a) + t * exact(b) for a, b in zip(o.tolist(), d.tolist(), strict=True)))

        if status == Verdict.MISS:
            assert positive_between(field, 0.0, FARTHEST / float(np.linalg.norm(d)))
            continue
        assert hi - lo <= 1e-10 * hi
        assert field(exact(hi)) <= 0
        assert positive_between(field, 0.0, lo * (1 - NEAR))
        near = [field(exact(t)) for t in np.linspace(lo * (1 - NEAR), lo, 50, endpoint=False).tolist()]
        assert all(value > 0 for value in near)
