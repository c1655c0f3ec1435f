"""The scalar reference's solids, flat shapes and operators, against distances from first principles and the formulas
that define them. Primitives that have a closed form are in test_reference.py.
"""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import octomarch as om
import solid_oracles as oracle

Array = NDArray[np.float64]
Oracle = Callable[[Array], Array]

ROUNDING = 1e-13  # of float64 for coordinates of a few units and a dozen operations
ROUNDING32 = 1e-5  # the same for float32
POINTS = np.random.default_rng(23).normal(scale=1.5, size=(600, 3))


def ring(sides: int, radius: float) -> list[tuple[float, float]]:
    angles = 2 * np.pi * np.arange(sides) / sides
    return [(radius * np.sin(a), radius * np.cos(a)) for a in angles]


def prism(corners: list[tuple[float, float]], height: float) -> Oracle:
    """Stand a polygon (x, z) up along y."""
    top = [(x, height / 2, z) for x, z in corners]
    bottom = [(x, -height / 2, z) for x, z in corners]
    walls = [[top[i], top[i - 1], bottom[i - 1], bottom[i]] for i in range(len(corners))]
    return lambda p: oracle.convex(p, [top, bottom, *walls])


def octahedron(radius: float) -> Oracle:
    x, y, z = np.eye(3) * radius
    return lambda p: oracle.convex(p, [[sx * x, sy * y, sz * z] for sx in (1, -1) for sy in (1, -1) for sz in (1, -1)])


def pyramid(edge: float, height: float) -> Oracle:
    base = [(sx * edge / 2, -height / 2, sz * edge / 2) for sx, sz in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    tip = (0, height / 2, 0)
    return lambda p: oracle.convex(p, [base, *([base[i], base[i - 1], tip] for i in range(4))])


def cone(bottom: float, top: float, height: float) -> Oracle:
    h = height / 2
    return lambda p: oracle.revolution(p, [(bottom, -h), (top, h), (-top, h), (-bottom, -h)])


SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
ARROW = [(0, 1), (1, -1), (0, -0.25), (-1, -1)]
BOW = [(-1, -1), (1, 1), (1, -1), (-1, 1)]
STAR = [((1.0, 0.4)[i % 2] * np.sin(i * np.pi / 5), (1.0, 0.4)[i % 2] * np.cos(i * np.pi / 5)) for i in range(10)]

SOLIDS: dict[str, tuple[om.Shape, Oracle]] = {
    "cone": (om.cone(0.8, 1.5), cone(0.8, 0, 1.5)),
    "flat cone": (om.cone(2.0, 0.25), cone(2.0, 0, 0.25)),
    "capped cone": (om.capped_cone(0.5, 1.0, 1.2), cone(0.5, 1.0, 1.2)),
    "capped cone, wide below": (om.capped_cone(1.5, 0.25, 0.5), cone(1.5, 0.25, 0.5)),
    "capped cone, as a cylinder": (om.capped_cone(0.7, 0.7, 2), cone(0.7, 0.7, 2)),
    "cone along x": (om.cone(0.8, 1.5, axis="x"), lambda p: cone(0.8, 0, 1.5)(p[..., [1, 0, 2]])),
    "cone down": (om.cone(0.8, 1.5, axis=(0, -3, 0)), lambda p: cone(0.8, 0, 1.5)(p * [1, -1, 1])),
    "octahedron": (om.octahedron(1.2), octahedron(1.2)),
    "pyramid": (om.pyramid(1.6, 2.0), pyramid(1.6, 2.0)),
    "flat pyramid": (om.pyramid(3.0, 0.5), pyramid(3.0, 0.5)),
    "steep pyramid": (om.pyramid(0.5, 3.0), pyramid(0.5, 3.0)),
    "hexagonal prism": (om.hexagonal_prism(1.0, 0.8), prism(ring(6, 1.0), 0.8)),
    "triangular prism": (om.triangular_prism(1.2, 1.0), prism(ring(3, 1.2), 1.0)),
    "triangular prism along z": (
        om.triangular_prism(1.2, 1.0, axis="z"),
        lambda p: prism(ring(3, 1.2), 1.0)(p[..., [0, 2, 1]]),
    ),
    "triangular prism along x": (
        om.triangular_prism(1.2, 1.0, axis="x"),
        lambda p: prism(ring(3, 1.2), 1.0)(p[..., [2, 0, 1]]),
    ),
    "rounded box": (
        om.rounded_box((1, 2, 3), 0.25),
        lambda p: box(p, np.array([0.25, 0.75, 1.25])) - 0.25,
    ),
    "square": (om.polygon(SQUARE), lambda p: oracle.polygon(p, SQUARE)),
    "arrow": (om.polygon(ARROW), lambda p: oracle.polygon(p, ARROW)),
    "arrow the other way round": (om.polygon(ARROW[::-1]), lambda p: oracle.polygon(p, ARROW)),
    "crossing edges": (om.polygon(BOW), lambda p: oracle.polygon(p, BOW)),
    "corners on one line": (om.polygon([*SQUARE, (-1, 0.5)]), lambda p: oracle.polygon(p, SQUARE)),
    "a corner twice": (om.polygon([*SQUARE, (-1, 1)]), lambda p: oracle.polygon(p, SQUARE)),
    "hexagon": (om.regular_polygon(6, 0.9), lambda p: oracle.polygon(p, ring(6, 0.9))),
    "star": (om.star(5, 1.0, 0.4), lambda p: oracle.polygon(p, STAR)),
    "rectangle": (om.rectangle((1, 3)), lambda p: oracle.polygon(p, np.array(SQUARE) * [0.5, 1.5])),
    "segment": (
        om.segment((-1, 0.5), (1, -1), 0.3),
        lambda p: oracle.to_segment(p[..., :2], (-1, 0.5), (1, -1)) - 0.3,
    ),
    "extruded arrow": (
        om.polygon(ARROW).extrude(1.5),
        lambda p: corner(np.stack([oracle.polygon(p, ARROW), np.abs(p[..., 2]) - 0.75], -1)),
    ),
    "revolved square": (
        om.rectangle((0.5, 1)).revolve(1.0),
        lambda p: oracle.revolution(p, [(0.75, -0.5), (1.25, -0.5), (1.25, 0.5), (0.75, 0.5)]),
    ),
}


def corner(q: Array) -> Array:
    return oracle.norm(np.maximum(q, 0)) + np.minimum(q.max(axis=-1), 0)


def box(p: Array, half: Array) -> Array:
    return corner(np.abs(p) - half)


@pytest.mark.parametrize("name", SOLIDS)
def test_distance_is_that_to_the_surface(name: str):
    shape, distance = SOLIDS[name]
    assert_allclose(om.reference.distance(shape, POINTS), distance(POINTS), rtol=0, atol=ROUNDING)
    values = om.reference.distance(shape, POINTS, dtype="float32")
    assert values.dtype == np.float32
    assert_allclose(values, distance(POINTS), rtol=0, atol=ROUNDING32)


def test_link_is_a_tube_about_its_centre_line():
    t = np.linspace(-np.pi / 2, np.pi / 2, 4001)
    round_end = np.stack([0.8 * np.sin(t), 0.6 + 0.8 * np.cos(t), 0 * t], -1)
    straight = np.minimum(
        oracle.to_segment(POINTS, (0.8, -0.6, 0), (0.8, 0.6, 0)),
        oracle.to_segment(POINTS, (-0.8, -0.6, 0), (-0.8, 0.6, 0)),
    )
    ends = np.minimum(oracle.sampled(POINTS, round_end), oracle.sampled(POINTS, round_end * [1, -1, 1]))
    spacing = 0.8 * np.pi / 4000  # of the samples: half of it squared, over twice the distance, is the error
    found = om.reference.distance(om.link(1.2, 0.8, 0.2), POINTS)
    far = np.minimum(straight, ends) > 0.05
    assert_allclose(found[far], (np.minimum(straight, ends) - 0.2)[far], rtol=0, atol=spacing**2 / 0.4)


def test_ellipsoid_is_a_bound_between_the_documented_limits():
    radii = np.array([1.5, 0.5, 1.0])
    rng = np.random.default_rng(5)
    on_sphere = rng.normal(size=(20_000, 3))
    surface = on_sphere / oracle.norm(on_sphere)[:, None] * radii
    points = POINTS[:150]
    to_sample = oracle.norm(points[:, None] - surface).min(axis=1)
    found = om.reference.distance(om.ellipsoid(radii), points)
    assert_allclose(found, 0.5 * (oracle.norm(points / radii) - 1), atol=ROUNDING)
    assert (np.abs(found) <= to_sample).all()
    far = to_sample > 0.3  # where the samples, about 0.02 apart, give the distance to a few thousandths
    assert far.sum() > 50
    assert (np.abs(found) >= 0.99 * to_sample / 3)[far].all()
    flat = om.reference.distance(om.ellipse((1.5, 0.5)), points)
    assert_allclose(flat, 0.5 * (oracle.norm(points[:, :2] / [1.5, 0.5]) - 1), atol=ROUNDING)


# Operators, as they are defined ---------------------------------------------------------------------------------------

BODY = om.box((1, 2, 3))
HALF = np.array([0.5, 1, 1.5])


def body(p: Array) -> Array:
    return box(p, HALF)


def turned(u: Array, v: Array, angle: Array) -> tuple[Array, Array]:
    return np.cos(angle) * u - np.sin(angle) * v, np.sin(angle) * u + np.cos(angle) * v


def pulled(u: Array, v: Array, radius: float) -> tuple[Array, Array, Array]:
    """Bring (u, v) to within a radius; return its own radius as well."""
    own = np.hypot(u, v)
    factor = np.minimum(radius / np.maximum(own, 1e-300), 1)
    return u * factor, v * factor, own


def twisted(p: Array, rate: float, axis: int) -> Array:
    radius = float(np.hypot(*np.delete(HALF, axis)))
    first, second = {0: (1, 2), 1: (0, 2), 2: (0, 1)}[axis]
    u, v, own = pulled(p[..., first], p[..., second], radius)
    q = p.copy()
    q[..., first], q[..., second] = turned(u, v, rate * p[..., axis])
    return np.maximum(body(q), own - radius)


def bent(p: Array, rate: float) -> Array:
    radius = float(np.hypot(0.5, 1))
    x, y, own = pulled(p[..., 0], p[..., 1], radius)
    x, y = turned(x, y, rate * x)
    return np.maximum(body(np.stack([x, y, p[..., 2]], -1)), own - radius)


def melted(fields: list[Array], k: float) -> Array:
    return -k * np.logaddexp.reduce([-field / k for field in fields])


X, Y, Z = om.coordinates()
OPERATORS: dict[str, tuple[om.Shape, Oracle]] = {
    "exterior": (om.box((1, 2, 3), form="exterior"), lambda p: np.maximum(body(p), 0)),
    "maximum": (om.box((1, 2, 3), form="maximum"), lambda p: (np.abs(p) - HALF).max(axis=-1)),
    "round": (BODY.round(0.25), lambda p: body(p) - 0.25),
    "shell": (BODY.shell(0.25), lambda p: np.abs(body(p)) - 0.125),
    "stretch": (BODY.stretch((2, 0.5, 1.5)), lambda p: 0.5 * body(p / [2, 0.5, 1.5])),
    "elongate": (
        om.sphere(1.0).elongate((1, 0, 2)),
        lambda p: oracle.norm(p - np.clip(p, [-0.5, 0, -1], [0.5, 0, 1])) - 1,
    ),
    "mirror": (
        BODY.translate(1, 0.2, 0).mirror("xy"),
        lambda p: body(np.abs(p) * [1, 1, 0] + p * [0, 0, 1] - [1, 0.2, 0]),
    ),
    "twist": (BODY.twist(40), lambda p: twisted(p, np.radians(40), 1)),
    "twist about x": (BODY.twist(-25, "x"), lambda p: twisted(p, -np.radians(25), 0)),
    "twist about z": (BODY.twist(70, "z"), lambda p: twisted(p, np.radians(70), 2)),
    "bend": (BODY.bend(30), lambda p: bent(p, np.radians(30))),
    "displace": (
        BODY.displace(0.1 * om.sin(3 * X) * om.cos(2 * Y), lipschitz=0.4),
        lambda p: body(p) + 0.1 * np.sin(3 * p[..., 0]) * np.cos(2 * p[..., 1]),
    ),
    "metaballs": (
        om.metaballs(BODY, om.sphere(0.8, center=(1, 0, 0)), om.sphere(0.5, center=(0, 1, 1)), k=0.2),
        lambda p: melted([body(p), oracle.norm(p - [1, 0, 0]) - 0.8, oracle.norm(p - [0, 1, 1]) - 0.5], 0.2),
    ),
    "metaballs of no width": (
        om.metaballs(BODY, om.sphere(1.2), k=0),
        lambda p: np.minimum(body(p), oracle.norm(p) - 1.2),
    ),
    "gyroid": (
        om.gyroid(2.0, 0.1),
        lambda p: level(p, lambda x, y, z: np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)),
    ),
    "schwarz_p": (om.schwarz_p(2.0, 0.1), lambda p: level(p, lambda x, y, z: np.cos(x) + np.cos(y) + np.cos(z))),
    "diamond": (
        om.diamond(2.0, 0.1),
        lambda p: level(
            p,
            lambda x, y, z: (
                np.sin(x) * np.sin(y) * np.sin(z)
                + np.sin(x) * np.cos(y) * np.cos(z)
                + np.cos(x) * np.sin(y) * np.cos(z)
                + np.cos(x) * np.cos(y) * np.sin(z)
            ),
        ),
    ),
}


def level(p: Array, function: Callable[..., Array]) -> Array:
    """Return the wall of thickness 0.1 about a surface of period 2, over the bound √3 of its slope."""
    return np.abs(function(*np.moveaxis(np.pi * p, -1, 0)) / (np.pi * np.sqrt(3))) - 0.05


@pytest.mark.parametrize("name", OPERATORS)
def test_operators_do_what_they_say(name: str):
    shape, formula = OPERATORS[name]
    assert_allclose(om.reference.distance(shape, POINTS), formula(POINTS), rtol=0, atol=10 * ROUNDING)


@pytest.mark.parametrize("name", [*SOLIDS, *OPERATORS])
def test_gradient_is_the_limit_of_differences(name: str):
    shape, _ = (SOLIDS | OPERATORS)[name]
    points, h = POINTS[:200], 1e-6  # of the step, its cube and the rounding over it are both near 1e-10
    ahead, behind = (
        np.stack([om.reference.distance(shape, points + step * axis) for axis in np.eye(3)], -1) for step in (h, -h)
    )
    here = om.reference.distance(shape, points)[:, None]
    smooth = (np.abs(ahead + behind - 2 * here) < 1e-9).all(axis=1)  # no crease, no small curvature, within the step
    assert smooth.mean() > 0.9
    found = om.reference.gradient(shape, points)
    assert_allclose(found[smooth], ((ahead - behind) / (2 * h))[smooth], rtol=0, atol=1e-6)
