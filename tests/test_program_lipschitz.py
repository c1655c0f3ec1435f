"""The bound of each field's slope: never exceeded, no larger than need be, and enough for a march to miss nothing."""

import math

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

import octomarch as om
from strategies import POINTS, Sample, nested

Array = NDArray[np.float64]

X, Y, Z = om.coordinates()
BOX = om.box((1, 2, 3))
BALL = om.sphere(0.5)


def steepest(shape: om.Shape, points: Array, rounding: Array | float) -> float:
    """Return the largest difference quotient over many lengths, less what rounding adds."""
    rng = np.random.default_rng(4)
    largest = 0.0
    for length in (1e-6, 1e-3, 0.1, 3.0):
        steps = rng.normal(size=points.shape)
        others = points + steps / np.linalg.norm(steps, axis=1)[:, None] * length
        rise = np.abs(shape.distance(points) - shape.distance(others)) - rounding
        largest = max(largest, float((rise / np.linalg.norm(points - others, axis=1)).max()))
    return largest


@given(sample=nested())
def test_lipschitz_bound_is_never_exceeded(sample: Sample):
    lipschitz = om.compile(sample.shape).lipschitz
    size = np.linalg.norm(POINTS, axis=1) + sample.extent + 3
    rounding = 1e-14 * sample.levels * sample.gain * size
    assert steepest(sample.shape, POINTS, rounding) <= lipschitz * (1 + 1e-12)
    gradients = np.linalg.norm(sample.shape.gradient(POINTS), axis=1)
    assert gradients.max() <= lipschitz + 1e-13 * sample.levels * sample.gain


def sheared(shear: float) -> float:
    """Return the largest singular value of a shear."""
    return (shear + math.sqrt(shear**2 + 4)) / 2


ANGLE = om.polygon([(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)])
BOUNDS = {
    "exact": (om.octahedron(1.0) | om.pyramid(1, 1).translate(2, 0, 0), 1),
    "cheaper box": (om.box(1.0, form="maximum"), 1),
    "stretched": (BALL.stretch((1, 3, 0.5)), 1),
    "elongated": (ANGLE.extrude(1).elongate((1, 1, 1)), 1),
    "mirrored": (BOX.translate(0.2, 0, 0).rotate(30, "z").mirror("xyz"), 1),
    "grown wall": (BOX.shell(0.3).round(0.1), 1),
    "flat": (ANGLE.shell(0.1), 1),
    "extruded": (ANGLE.extrude(1), 1),
    "revolved": (ANGLE.rotate(20, "z").revolve(0.5), 1),
    "melted": (om.metaballs(BOX, BALL.translate(1, 0, 0), ANGLE.extrude(1), k=0.3), 1),
    "gyroid": (om.gyroid(1.5, 0.1), 1),
    "schwarz_p": (om.schwarz_p(1.5, 0.1), 1),
    "diamond": (om.diamond(1.5, 0.1), 1),
    "tile": (om.cone(0.4, 0.8, center=(0.5, 0.5, 0.5)).tile(1.0, scale=1.5, offset=0.3), 1),
    "twisted": (om.box((2, 2, 2)).twist(60), sheared(math.radians(60) * math.sqrt(2))),
    "twisted about x": (om.box((2, 2, 2)).twist(-30, "x"), sheared(math.radians(30) * math.sqrt(2))),
    "twisted and scaled": (om.box((2, 2, 2)).twist(60).scale(0.75), sheared(math.radians(60) * math.sqrt(2))),
    "bent": (om.box((2, 0.5, 2)).bend(40), 1 + math.radians(40) * math.hypot(1, 0.25)),
    "waved": (om.plane().displace(0.1 * om.sin(5 * X) * om.cos(5 * Z), lipschitz=0.5), 1.5),
    "found": (om.sphere(1.0).displace(0.1 * om.sin(5 * Y)), 1.5),
    "field": (om.field(3 * X - 4 * Y, lipschitz=5), 5),
    "field in a box": (om.field(0.5 * X, lipschitz=0.5, bounds=((-1, -1, -1), (1, 1, 1))), 1),
    "of two": (om.field(2 * X, lipschitz=2) & om.sphere(1.0), 2),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_lipschitz_bound_is_what_it_should_be_and_nearly_reached(name: str):
    shape, expected = BOUNDS[name]
    lipschitz = om.compile(shape).lipschitz
    assert lipschitz == pytest.approx(expected, rel=1e-12)
    points = np.random.default_rng(8).normal(scale=1.2, size=(4000, 3))
    reached = steepest(shape, points, 1e-13)
    assert 0.6 * lipschitz <= reached <= lipschitz * (1 + 1e-12)


# No false miss --------------------------------------------------------------------------------------------------------

SCENES = {name: shape for name, (shape, _) in BOUNDS.items() if name not in {"field", "field in a box"}} | {
    "ellipsoid": om.ellipsoid((1.5, 0.3, 0.6)).rotate(30, (1, 1, 0)),
    "star": om.star(7, 1.2, 0.5).extrude(0.4).rotate(50, (1, 2, 0)),
    "strongly twisted": om.box((1, 3, 0.2)).twist(180),
    "bent ring": om.torus(0.8, 0.2).bend(60),
    "repeat that leans": om.cone(0.4, 0.9).rotate(35, (1, 2, 0)).repeat((1.5, None, 1.5)),
    "tiles of a stretched ball": om.ellipsoid((0.4, 0.2, 0.1), center=(0.5, 0.3, 0.6)).tile(1.0),
    "drop": om.metaballs(om.sphere(0.5), om.sphere(0.3, center=(0.9, 0, 0)), k=0.2) - om.box(0.5).twist(90),
}
STEP = 2e-3


def first_crossing(shape: om.Shape, origins: Array, directions: Array, reach: float) -> Array:
    """Return where rays first enter the solid, to within STEP: steps that no bound decides; +inf where they do not."""
    t = np.arange(0, reach, STEP)
    result = np.full(len(origins), np.inf)
    for i, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
        inside = np.flatnonzero(shape.distance(origin + t[:, None] * direction) < 0)
        if len(inside):
            result[i] = t[inside[0]]
    return result


@pytest.mark.parametrize("name", SCENES)
def test_a_march_misses_nothing_that_small_steps_find(name: str, isa: str):
    """Not even once: rays end before or at the first point inside, and what the march calls a miss has none."""
    shape, reach = SCENES[name], 8.0
    rng = np.random.default_rng(12)
    origins = rng.normal(size=(300, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1)[:, None]
    aims = rng.normal(scale=0.7, size=(300, 3)) - origins
    directions = aims / np.linalg.norm(aims, axis=1)[:, None]
    outside = shape.distance(origins) > 0.01
    assert outside.sum() > 50
    origins, directions = origins[outside], directions[outside]
    march = om.March(epsilon=1e-5, max_distance=reach, max_steps=4000)
    hits = shape.raycast(origins, directions, march=march, isa=isa)
    crossing = first_crossing(shape, origins, directions, reach)
    entered = np.isfinite(crossing)
    assert entered.sum() > 20
    assert_array_equal(hits.status[entered], om.Status.HIT)
    assert (hits.t[entered] <= crossing[entered] + 1e-9).all()
    grazed = (hits.status == om.Status.HIT) & ~entered
    within = 1e-5 * om.compile(shape).lipschitz * (1 + 1e-9)  # what counts as a hit
    assert np.abs(shape.distance(hits.position[grazed])).max(initial=0) <= within
