"""What operators and composed shapes mean, by the shapes that they must equal and the formulas that define them."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]

ROUNDING = 1e-13  # of float64 for coordinates of a few units and some dozen operations
POINTS = np.random.default_rng(31).normal(scale=2.5, size=(800, 3))
BODY = om.box((1, 2, 3))


# Corner-anchored repetition -------------------------------------------------------------------------------------------


def cell_points(p: Array, period: tuple[float, ...], scale: float, offset: tuple[float, ...]) -> Array:
    """Return mod(A p + N, M) as shaders write it, for any sign; axes of period 0 stay as they are."""
    q = scale * p + offset
    m = np.array(period)
    return np.where(m > 0, np.mod(q, np.where(m > 0, m, 1)), q)


TILES = {
    "frac": ((1, 1, 1), 1, (0, 0, 0)),
    "frac of y": ((0, 1, 0), 1, (0, 0, 0)),
    "frac of x and y": ((1, 1, 0), 1, (0, 0, 0)),
    "period": ((2, 3, 1.5), 1, (0, 0, 0)),
    "scaled": ((1, 1, 1), 4, (0, 0, 0)),
    "scaled and moved": ((2, 0, 3), 0.75, (0.25, 1, -5.5)),
}


@pytest.mark.parametrize("name", TILES)
def test_tile_is_the_formula_where_content_is_its_own_mirror_image(name: str):
    """Below zero too, where the remainder that C computes would mirror the cells."""
    period, scale, offset = TILES[name]
    middle = np.array(period) / 2
    content = (om.sphere(0.4) | om.box((0.7, 0.3, 0.5))).translate(middle)
    q = cell_points(POINTS, period, scale, offset)
    expected = content.distance(q) / scale
    tiled = content.tile(period, scale, offset)
    assert_allclose(tiled.distance(POINTS), expected, rtol=0, atol=10 * ROUNDING)
    assert "repeat_neighbour" not in str(om.compile(tiled))


@pytest.mark.parametrize("name", TILES)
def test_tile_is_never_above_the_formula_and_has_its_solid(name: str):
    """Content that leans to one side: the formula overestimates near the next cell, tile() does not."""
    period, scale, offset = TILES[name]
    content = om.box((0.3, 0.4, 0.3), center=(0.7, 0.25, 0.2))
    expected = content.distance(cell_points(POINTS, period, scale, offset)) / scale
    tiled = content.tile(period, scale, offset)
    found = tiled.distance(POINTS)
    assert (found <= expected + 10 * ROUNDING).all()
    assert (found < expected - 0.01).mean() > 0.05, "the neighbour matters: the test tests nothing"
    clear = np.abs(expected) > 10 * ROUNDING
    assert_array_equal((found < 0)[clear], (expected < 0)[clear])
    assert "repeat_neighbour" in str(om.compile(tiled))


def test_tile_is_repeat_moved_by_half_a_cell():
    assert BODY.tile(4.0) == BODY.translate(-2, -2, -2).repeat(4.0).translate(2, 2, 2)
    assert BODY.tile((None, 4, 0)) == BODY.tile((0, 4, 0))
    assert BODY.tile((4, 0, 4), offset=0.5) == BODY.tile((4, 0, 4), offset=(0.5, 0, 0.5))
    assert BODY.translate(2, 2, 2).tile(4.0) == BODY.repeat(4.0).translate(2, 2, 2)


@given(
    period=st.tuples(*[st.floats(0.5, 3)] * 3),
    scale=st.floats(0.25, 4),
    offset=st.tuples(*[st.floats(-5, 5)] * 3),
)
def test_tiles_lie_in_their_cells(period: tuple[float, ...], scale: float, offset: tuple[float, ...]):
    content = om.sphere(0.2, center=np.array(period) / 2)
    cells = np.array(list(itertools.product(range(-3, 3), repeat=3)))
    centres = ((cells + 0.5) * period - np.array(offset)) / scale
    assert_allclose(content.tile(period, scale, offset).distance(centres), -0.2 / scale, rtol=1e-9)


# Shapes made of others ------------------------------------------------------------------------------------------------

SAME: dict[str, tuple[om.Shape, om.Shape]] = {
    "cone": (om.cone(1, 2), om.capped_cone(1, 0, 2)),
    "straight cone": (om.capped_cone(0.5, 0.5, 2), om.cylinder(0.5, 2)),
    "cone upside down": (om.capped_cone(1, 0.5, 2), om.capped_cone(0.5, 1, 2, axis=(0, -1, 0))),
    "ball as ellipsoid": (om.ellipsoid((2, 2, 2)), om.sphere(2.0)),
    "circle as ellipse": (om.ellipse((2, 2)), om.circle(2.0)),
    "circle": (om.circle(0.7), om.cylinder(0.7, axis="z")),
    "square as polygon": (om.regular_polygon(4, 2**0.5), om.rectangle(2).rotate(45, "z")),
    "can as extruded circle": (om.circle(1.0).extrude(2), om.cylinder(1.0, 2, axis="z")),
    "box as extruded rectangle": (om.rectangle((1, 2)).extrude(3), BODY),
    "can as turned rectangle": (om.rectangle((2, 2)).revolve(), om.cylinder(1.0, 2)),
    "ring as turned circle": (om.circle(0.25).revolve(1.0), om.torus(1, 0.25)),
    "cone as turned triangle": (om.polygon([(0, -1), (1, -1), (0, 1), (-1, -1)]).revolve(), om.cone(1, 2)),
    "pill": (om.sphere(0.5).elongate((0, 2, 0)), om.capsule((0, -1, 0), (0, 1, 0), 0.5)),
    "round box as grown box": (om.rounded_box((1, 2, 3), 0.25), om.box((0.5, 1.5, 2.5)).round(0.25)),
    "prism along z": (om.triangular_prism(1, 2, axis="z"), om.regular_polygon(3, 1).extrude(2)),
    "prism along -y": (om.hexagonal_prism(1, 2, axis=(0, -1, 0)), om.hexagonal_prism(1, 2)),
    "one metaball": (om.metaballs(BODY, k=0.3), BODY),
    "metaballs of no width": (om.metaballs(BODY, om.sphere(1.0), k=0), BODY | om.sphere(1.0)),
    "metaballs of one place": (om.metaballs(BODY, BODY, k=0.5), BODY.round(0.5 * np.log(2))),
    "mirrored twice": (om.sphere(1.0, center=(1, 1, 0)).mirror("xy"), om.sphere(1.0, center=(1, 1, 0)).mirror("yx")),
    "equal stretch": (BODY.stretch((2, 2, 2)), BODY.scale(2)),
    "stretched box": (om.box(1.0).stretch((1, 1, 1)), om.box(1.0)),
    "no twist": (BODY.twist(0), BODY),
    "no bend": (BODY.bend(0), BODY),
    "no growth": (BODY.round(0), BODY),
    "no elongation": (BODY.elongate((0, 0, 0)), BODY),
}


@pytest.mark.parametrize("name", SAME)
def test_shapes_that_are_the_same_have_the_same_field(name: str, isa: str):
    found, expected = (shape.distance(POINTS, isa=isa) for shape in SAME[name])
    assert_allclose(found, expected, rtol=0, atol=ROUNDING)


def test_what_changes_nothing_is_the_same_shape():
    assert BODY.twist(0) == BODY.bend(0) == BODY.round(0) == BODY.elongate((0, 0, 0)) == BODY.stretch((1, 1, 1)) == BODY
    assert om.metaballs(BODY, k=1) == BODY
    assert BODY.stretch((2, 2, 2)) == BODY.scale(2)


def test_mirror_is_the_union_of_both_halves():
    half = om.capsule((0.5, -1, 0), (2, 1, 0.5), 0.4)
    other = om.capsule((-0.5, -1, 0), (-2, 1, 0.5), 0.4)
    assert_allclose(half.mirror("x").distance(POINTS), (half | other).distance(POINTS), rtol=0, atol=ROUNDING)


def test_mirror_leaves_only_the_side_that_it_mirrors():
    ball = om.sphere(0.5, center=(-1, 0, 0))
    assert float(ball.mirror("x").distance([-1, 0, 0])) > 0
    assert float(ball.mirror("x").distance([1, 0, 0])) > 0


def test_metaballs_do_not_depend_on_their_order_but_for_rounding():
    balls = [om.sphere(0.3 + 0.1 * i, center=(0.5 * i, 0.3 * i * (-1) ** i, 0)) for i in range(5)]
    first, second = (om.metaballs(*order, k=0.2).distance(POINTS) for order in (balls, balls[::-1]))
    assert_allclose(first, second, rtol=0, atol=ROUNDING)


def test_twist_turns_right_handed_and_bend_hangs_down():
    arm = om.box((2, 4, 0.1))
    turned = arm.twist(90)
    up, side = turned.distance([[0.5, 1, 0], [0, 1, -0.5]])  # a quarter turn about y takes x to -z
    assert up > 0 > side
    beam = om.box((2, 0.1, 1)).bend(45)
    level, hanging = beam.distance([[0.9, 0, 0], [0.7, -0.43, 0]])
    assert level > 0 > hanging


def test_polygons_are_their_own_mirror_image_to_the_last_bit():
    for sides in range(3, 12):
        corners = np.array(om.regular_polygon(sides, 0.7)._node.parameters).reshape(-1, 2)
        assert {(-x, y) for x, y in corners.tolist()} == {tuple(corner) for corner in corners.tolist()}
    points = np.array(om.star(5, 1.0, 0.3)._node.parameters).reshape(-1, 2)
    assert points[0].tolist() == [0, 1]
    assert_allclose(np.hypot(*points.T), [1.0, 0.3] * 5)
    square = np.array(om.regular_polygon(4, 1.0)._node.parameters).reshape(-1, 2)
    assert square.tolist() == [[0, 1], [1, 0], [0, -1], [-1, 0]]


MIRRORED = {
    "hexagon": (om.regular_polygon(6, 0.4), {"x", "y"}),
    "triangle": (om.regular_polygon(3, 0.4), {"x"}),
    "triangle, clockwise": (om.polygon([(0, 0.4), (0.3, -0.2), (-0.3, -0.2)]), {"x"}),
    "triangle from another corner": (om.polygon([(0.3, -0.2), (0, 0.4), (-0.3, -0.2)]), {"x"}),
    "pentagon": (om.regular_polygon(5, 0.4), {"x"}),
    "star of six": (om.star(6, 0.4, 0.2), {"x", "y"}),
    "kite": (om.polygon([(0.4, 0), (0, 0.2), (-0.3, 0), (0, -0.2)]), {"y"}),
    "none": (om.polygon([(0.4, 0), (0, 0.2), (-0.3, 0.1)]), set()),
    "turned by half, not mirrored": (om.polygon([(0.4, 0.1), (0, 0.3), (-0.4, -0.1), (0, -0.3)]), set()),
}


@pytest.mark.parametrize("name", MIRRORED)
def test_polygons_that_are_mirror_images_need_no_neighbouring_cells(name: str):
    shape, axes = MIRRORED[name]
    for axis, period in (("x", (1, 0, 0)), ("y", (0, 1, 0))):
        neighbours = "repeat_neighbour" in str(om.compile(shape.repeat(period)))
        assert neighbours == (axis not in axes)
    prism = shape.extrude(0.5).rotate(90, "x")  # y becomes z
    assert ("repeat_neighbour" in str(om.compile(prism.repeat((0, 0, 1))))) == ("y" not in axes)


FLAT = om.circle(1.0)


@pytest.mark.parametrize(
    "shape",
    [
        FLAT | om.star(5, 1, 0.5),
        FLAT.union(om.rectangle((1, 3)), smooth=0.2) - om.ellipse((0.5, 0.2)),
        om.segment((0, 0), (1, 1), 0.25),
        om.metaballs(FLAT, FLAT.translate(1, 0, 0), k=0.1),
        FLAT.shell(0.1).round(0.05).scale(2).mirror("xy"),
        om.polygon([(0, 0), (1, 0), (0, 1)]).rotate(33, "z").stretch((1, 2, 1)).elongate((1, 0, 0)),
        om.rectangle(0.5).repeat((1, 1, None), counts=(3, None, None)),
        om.regular_polygon(5, 1).tile((3, 0, 0)),
        om.plane((1, 2, 0)) & FLAT,
        FLAT.paint(om.Material(0.5)),
        FLAT.displace(0.1 * om.sin(om.coordinates()[0]), lipschitz=0.1),
        om.field(om.coordinates()[0], lipschitz=1),
    ],
)
def test_what_stays_in_its_plane_is_flat(shape: om.Shape):
    cut = shape.extrude(2.0)
    assert_array_equal(shape.distance(POINTS), shape.distance(POINTS * [1, 1, 0]))
    assert (cut.distance(POINTS) >= np.abs(POINTS[:, 2]) - 1 - ROUNDING).all()
    turned = shape.revolve(0.5)
    radius = np.hypot(POINTS[:, 0], POINTS[:, 2]) - 0.5
    assert_allclose(
        turned.distance(POINTS),
        shape.distance(np.stack([radius, POINTS[:, 1], 0 * radius], -1)),
        rtol=0,
        atol=10 * ROUNDING,
    )


@pytest.mark.parametrize(
    "shape",
    [
        om.sphere(1.0),
        om.box(1.0),
        om.cylinder(1.0, axis="y"),
        om.plane((0, 0, 1)),
        FLAT.extrude(1.0),
        FLAT.rotate(10, "x"),
        FLAT.repeat((0, 0, 2)),
        FLAT | om.sphere(1.0),
        om.field(om.coordinates()[2], lipschitz=1),
        FLAT.displace(0.1 * om.sin(om.coordinates()[2]), lipschitz=0.1),
    ],
)
def test_what_leaves_its_plane_is_not_flat(shape: om.Shape):
    for operator in (lambda: shape.extrude(1.0), lambda: shape.revolve()):
        with pytest.raises(ValueError, match="shape must be flat, the same at every z, got"):
            operator()


# Walls that fill space ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("build", [om.gyroid, om.schwarz_p, om.diamond])
def test_surfaces_repeat_with_their_period_and_have_their_thickness(build):
    shape = build(2.0, 0.1)
    here = shape.distance(POINTS)
    for axis in np.eye(3):
        assert_allclose(shape.distance(POINTS + 2 * axis), here, rtol=0, atol=10 * ROUNDING)
    assert_allclose(shape.scale(3).distance(POINTS), build(6.0, 0.3).distance(POINTS), rtol=0, atol=10 * ROUNDING)
    normals = shape.gradient(POINTS)
    ahead = shape.distance(POINTS - 0.2 * normals)
    assert (ahead >= here - 0.2 - ROUNDING).all()


FILLED = {om.gyroid: 0.276, om.schwarz_p: 0.552, om.diamond: 0.26}
THICKEST = {om.gyroid: 1.22475, om.schwarz_p: 1.73206, om.diamond: 1.22475}


@pytest.mark.parametrize("build", FILLED)
def test_surfaces_are_as_thick_as_documented(build):
    """The slope on the surface lies between 1 over the documented factor and 1, and reaches both."""
    points = np.random.default_rng(3).uniform(0, 1, (4000, 3))
    assert (build(1.0, FILLED[build]).distance(points) < 0).all()
    assert (build(1.0, 0.97 * FILLED[build]).distance(points) > 0).any()
    field = build(1.0, 0.0)
    for _ in range(20):  # Newton's way to the surface, from the side on which it is
        gradient = field.gradient(points)
        square = np.maximum((gradient**2).sum(axis=1), 0.1)
        points = points - (field.distance(points) / square)[:, None] * gradient
    slope = np.linalg.norm(field.gradient(points), axis=1)[field.distance(points) < 1e-9]
    assert len(slope) > 3000
    assert slope.max() == pytest.approx(1, abs=0.01)
    assert slope.min() == pytest.approx(1 / THICKEST[build], abs=0.01)
    assert slope.min() >= 1 / THICKEST[build]
