"""What the compiler knows of a whole field, without running it: where the solid can be, how steep it is, what it is
made of.
"""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import octomarch as om
from strategies import POINTS, Sample, nested, primitive, rotated, translated, vector

BOX = om.box((1, 2, 3))
BALL = om.sphere(0.5)

# Bounds --------------------------------------------------------------------------------------------------------------


def just_outside(lo: np.ndarray, hi: np.ndarray, extent: float) -> np.ndarray:
    """Return points close to a box: within reach of what it should have held, on each side that has an end."""
    rng = np.random.default_rng(2)
    inner_lo, inner_hi = np.maximum(lo, -extent - 1), np.minimum(hi, extent + 1)
    sides = []
    for axis, (bound, sign) in itertools.product(range(3), ((lo, -1), (hi, 1))):
        if np.isfinite(bound[axis]):
            points = rng.uniform(np.minimum(inner_lo, inner_hi), np.maximum(inner_lo, inner_hi), (300, 3))
            points[:, axis] = bound[axis] + sign * rng.exponential(0.05, 300)
            sides.append(points)
    return np.concatenate(sides) if sides else np.empty((0, 3))


def check_bounds(shape: om.Shape, extent: float) -> None:
    lo, hi = (np.array(corner) for corner in om.compile(shape).bounds)
    slack = 1e-12 * (1 + extent)
    outside = just_outside(lo, hi, extent)
    field = om.reference.distance(shape, outside)
    assert (field >= -slack).all(), (outside[field.argmin()], lo, hi)


@given(sample=nested())
def test_bounds_hold_the_solid(sample: Sample):
    check_bounds(sample.shape, min(sample.extent, 20))


def bar(width: float) -> om.Shape:
    """Return a square bar as four half-spaces: its field is far below the distance along its diagonals."""
    walls = ((x, 0, 0) for x in (-1, 1)), ((0, y, 0) for y in (-1, 1))
    return om.intersection(*(om.plane(normal, np.array(normal) * width / 2) for axis in walls for normal in axis))


EDGEWISE = bar(1.0).rotate(45, "z")
BLENDS = {
    "balls": om.sphere(1.0).union(om.sphere(1.0, center=(0.1, 0, 0)), smooth=1.0),
    "many": om.union(*(om.box(1.0, center=(x, 0, 0)) for x in (0, 0.1, 0.2, 0.3)), smooth=0.8),
    "a heap": om.union(*(om.sphere(1.0, center=(x / 100, 0, 0)) for x in range(40)), smooth=1.0),
    "a melted heap": om.metaballs(*(om.sphere(1.0, center=(x / 100, 0, 0)) for x in range(40)), k=0.3),
    "corners": bar(1.0).union(bar(1.01), smooth=0.5) & om.box(8.0),
    "turned corners": EDGEWISE.union(bar(1.01).rotate(45, "z"), smooth=0.5) & om.box(8.0),
    "turned twice": bar(1.0)
    .rotate(45, "z")
    .rotate(45, "x")
    .union(bar(1.0).rotate(45, "z").rotate(45.5, "x"), smooth=1),
    "what is empty but for the blend": (om.sphere(0.5) & om.sphere(0.5, center=(1.2, 0, 0))).union(
        om.sphere(0.5, center=(0, 0, 1.2)) & om.sphere(0.5, center=(1.2, 0, 1.2)), smooth=2
    ),
    "melted": om.metaballs(bar(1.0), bar(1.01), k=0.3) & om.box(8.0),
    "melted and turned": om.metaballs(EDGEWISE, bar(1.01).rotate(45, "z"), om.sphere(0.7), k=0.3) & om.box(8.0),
    "grown corners": EDGEWISE.round(0.5) & om.box(8.0),
    "walls about corners": EDGEWISE.shell(0.5) & om.box(8.0),
    "stretched corners": EDGEWISE.stretch((1, 3, 1)).union(bar(1.01), smooth=0.5) & om.box(8.0),
    "twisted blend": (bar(1.0) & om.box(4.0)).union(om.sphere(0.8), smooth=0.5).twist(45),
    "waved corners": EDGEWISE.displace(0.3 * om.sin(2 * om.coordinates()[1]), lipschitz=0.6) & om.box(8.0),
    "scaled": EDGEWISE.union(bar(1.01).rotate(45, "z"), smooth=0.5).scale(3) & om.box(20.0),
}


@pytest.mark.parametrize("name", BLENDS)
def test_bounds_hold_what_blends_add(name: str):
    check_bounds(BLENDS[name], 5.0)


@given(sample=nested())
def test_bounds_hold_what_rays_hit(sample: Sample):
    program = om.compile(sample.shape)
    lo, hi = (np.array(corner) for corner in program.bounds)
    hits = sample.shape.raycast(POINTS * 3, -POINTS, march=om.March(epsilon=1e-6, max_steps=64))
    found = hits.position[hits.status == om.Status.HIT]
    tolerance = 1e-5 * (1 + sample.extent)  # sideways of a ray that grazes within epsilon
    assert (found >= lo - tolerance).all()
    assert (found <= hi + tolerance).all()


BOUNDS = {
    "ball": (om.sphere(1.0, center=(1, 2, 3)), (0, 1, 2), (2, 3, 4)),
    "can": (om.cylinder(1.0, 4, axis="x"), (-2, -1, -1), (2, 1, 1)),
    "cylinder": (om.cylinder(1.0), (-1, -math.inf, -1), (1, math.inf, 1)),
    "torus": (om.torus(2, 0.5), (-2.5, -0.5, -2.5), (2.5, 0.5, 2.5)),
    "floor": (om.plane(point=(0, -1, 0)), (-math.inf,) * 3, (math.inf, -1, math.inf)),
    "cut floor": (om.plane() & om.box((4, 6, 4)), (-2, -3, -2), (2, 0, 2)),
    "complement": (~om.sphere(1.0), (-math.inf,) * 3, (math.inf,) * 3),
    "blend": (om.sphere(1.0).union(om.sphere(1.0), smooth=0.5), (-1.125,) * 3, (1.125,) * 3),
    "blend of three": (om.union(*[om.sphere(1.0)] * 3, smooth=0.5), (-1.25,) * 3, (1.25,) * 3),
    "blend of many": (om.union(*[om.sphere(1.0)] * 1000, smooth=0.5), (-1.5,) * 3, (1.5,) * 3),
    "row": (om.sphere(0.5).repeat((2, None, None), 4), (-3.5, -0.5, -0.5), (3.5, 0.5, 0.5)),
    "grid": (om.sphere(0.5).repeat((2, None, 2)), (-math.inf, -0.5, -math.inf), (math.inf, 0.5, math.inf)),
    "scaled and moved": (BOX.scale(2).translate(1, 0, 0), (0, -2, -3), (2, 2, 3)),
    "cone along x": (om.cone(1, 2, axis="x"), (-1, -1, -1), (1, 1, 1)),
    "octahedron": (om.octahedron(2), (-2, -2, -2), (2, 2, 2)),
    "samples": (om.grid(np.ones((2, 3, 4)), ((-1, 0, 2), (3, 1, 4))), (-1, 0, 2), (3, 1, 4)),
    "pyramid": (om.pyramid(2, 3), (-1, -1.5, -1), (1, 1.5, 1)),
    "ellipsoid": (om.ellipsoid((1, 2, 3)), (-1, -2, -3), (1, 2, 3)),
    "link": (om.link(2, 0.5, 0.25), (-0.75, -1.75, -0.25), (0.75, 1.75, 0.25)),
    "rounded box": (om.rounded_box((1, 2, 3), 0.25), (-0.5, -1, -1.5), (0.5, 1, 1.5)),
    "box, outside only": (om.box((1, 2, 3), form="exterior"), (-0.5, -1, -1.5), (0.5, 1, 1.5)),
    "polygon": (om.polygon([(0, 0), (2, 1), (-1, 3)]), (-1, 0, -math.inf), (2, 3, math.inf)),
    "extruded": (om.polygon([(0, 0), (2, 1), (-1, 3)]).extrude(4), (-1, 0, -2), (2, 3, 2)),
    "revolved": (om.rectangle((1, 2)).revolve(2), (-2.5, -1, -2.5), (2.5, 1, 2.5)),
    "grown": (BOX.round(0.5), (-1, -1.5, -2), (1, 1.5, 2)),
    "wall": (BOX.shell(0.5), (-0.75, -1.25, -1.75), (0.75, 1.25, 1.75)),
    "stretched": (BOX.stretch((2, 1, 0.5)), (-1, -1, -0.75), (1, 1, 0.75)),
    "elongated": (BOX.elongate((2, 0, 1)), (-1.5, -1, -2), (1.5, 1, 2)),
    "mirrored": (om.sphere(0.5, center=(2, 1, 0)).mirror("xy"), (-2.5, -1.5, -0.5), (2.5, 1.5, 0.5)),
    "twisted": (om.box((6, 2, 8)).twist(45), (-5, -1, -5), (5, 1, 5)),
    "bent": (om.box((6, 8, 2)).bend(45), (-5, -5, -1), (5, 5, 1)),
    "melted": (om.metaballs(BALL, BALL, k=1 / math.log(2)), (-1.5,) * 3, (1.5,) * 3),
    "waved": (BALL.displace(0.25 * om.sin(om.coordinates()[0])), (-0.75,) * 3, (0.75,) * 3),
    "tiles": (om.sphere(0.5, center=(1, 1, 1)).tile((2, 0, 2)), (-math.inf, 0.5, -math.inf), (math.inf, 1.5, math.inf)),
    "drilled": (BOX - om.cylinder(0.25), (-0.5, -1, -1.5), (0.5, 1, 1.5)),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_bounds_are_tight_where_they_can_be(name: str):
    shape, lo, hi = BOUNDS[name]
    assert om.compile(shape).bounds == (lo, hi)


def test_focus_leaves_out_what_has_no_end():
    floor = om.plane(point=(0, -1, 0))
    assert om.compile(floor | om.sphere(1.0)).focus == ((-1, -1, -1), (1, 1, 1))
    assert om.compile(floor).focus is None
    assert om.compile(om.sphere(1.0) & om.sphere(1.0, center=(5, 0, 0))).focus is None


# Ids -----------------------------------------------------------------------------------------------------------------

RED, BLUE = om.Material((1, 0, 0)), om.Material((0, 0, 1))
PLAIN = om.Material()


def test_innermost_paint_wins_and_materials_count_as_they_appear():
    shape = om.union(BALL.paint(BLUE).paint(RED), BOX, om.torus(1, 0.25).paint(RED), om.cylinder(0.1).paint(BLUE))
    program = om.compile(shape)
    assert program.materials == [BLUE, PLAIN, RED]
    assert program.objects == [("sphere", 0), ("box", 1), ("torus", 2), ("cylinder", 0)]
    assert om.compile(shape.paint(RED)).materials == [BLUE, RED]


def test_objects_are_placed_primitives():
    twice = BALL | BALL.translate(2, 0, 0) | BALL
    assert om.compile(twice).objects == [("sphere", 0), ("sphere", 0)]
    both = BALL.paint(RED) | BALL.paint(BLUE)
    assert om.compile(both).objects == [("sphere", 0), ("sphere", 1)]


def test_ids_of_one_object_cost_one_instruction():
    assert om.compile(BALL).attribute_instructions == 1
    assert om.compile(BOX.rotate(20).paint(RED)).attribute_instructions == 1


PAIR = BALL.paint(RED) | om.sphere(0.25, center=(1, 0, 0)).paint(BLUE)
IDS = {  # shape, and two rays straight down: the first meets what is red, the second what is blue
    "union": (BALL.paint(RED) | BOX.translate(3, 0, 0).paint(BLUE), (0, 0), (3, 1)),
    "intersection": (om.sphere(0.6).paint(RED) & om.box(1.0).paint(BLUE), (0.45, 0), (0, 0)),
    "difference": (BOX.paint(RED) - BALL.translate(0, 1, 0).paint(BLUE), (0, 1), (0.1, 0)),
    "blend": (BALL.paint(RED).union(BOX.translate(1, 0, 0).paint(BLUE), smooth=0.5), (-0.3, 0), (1, 0)),
    "cut blend": (BOX.paint(RED).difference(BALL.translate(0, 1, 0).paint(BLUE), smooth=0.1), (0, 1), (0, 0)),
    "complement": (~BALL.paint(RED) & om.plane().paint(BLUE), (0.2, 0.1), (2, 0)),
    "placed": (PAIR.translate(-1, 0, 0).scale(2).rotate(90), (0, 2), (0, 0)),
    "repeat": (PAIR.repeat((3, 0, 3)), (3, 6), (-2, -3)),
    "paint outside paint": ((BALL.paint(RED) | BOX.translate(3, 0, 0)).paint(BLUE), (0, 0), (3, 1)),
}


@pytest.mark.parametrize("name", IDS)
def test_ids_are_those_of_the_part_that_is_met(name: str, isa: str, precision: str):
    shape, *rays = IDS[name]
    program = om.compile(shape)
    origins = [(x, 5.0, z) for x, z in rays]
    hits = shape.raycast(origins, [0, -1, 0], precision=precision, isa=isa)
    assert [program.materials[i] for i in hits.material_id] == [RED, BLUE]
    assert [program.objects[i][1] for i in hits.object_id] == hits.material_id.tolist()


placed = st.builds(
    lambda inner, turn, offset: translated(rotated(inner, turn, "x"), offset),
    primitive,
    st.sampled_from([0.0, 90.0, 37.0]),
    vector,
)


@given(
    parts=st.lists(placed, min_size=2, max_size=5),
    kinds=st.lists(st.sampled_from([om.union, om.intersection, om.difference]), min_size=4, max_size=4),
)
def test_a_hit_lies_on_the_surface_of_the_object_it_names(isa: str, parts: list[Sample], kinds: list):
    """Whatever the operators, each primitive with a paint of its own: no tie can make this fail."""
    paints = [om.Material(0.125 * i) for i in range(len(parts))]
    whole = parts[0].shape.paint(paints[0])
    for part, paint, kind in zip(parts[1:], paints[1:], kinds, strict=False):
        whole = kind(whole, part.shape.paint(paint))
    march = om.March(epsilon=1e-6)
    hits = whole.raycast(POINTS * 3, -POINTS, march=march, isa=isa)
    program = om.compile(whole)
    for i in np.flatnonzero(hits.status == om.Status.HIT):
        part = parts[paints.index(program.materials[hits.material_id[i]])]
        assert abs(part.shape.distance(hits.position[i])) <= 1e-6 * (1 + 1e-6) * program.lipschitz
        assert program.objects[hits.object_id[i]][1] == hits.material_id[i]
