"""Where formulas of the reference meet their limits: shapes without width, gradients on faces, edges and corners."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]
Face = tuple[tuple[float, float, float], tuple[float, float, float]]  # a point, and the direction of its normal

ROUNDING = 1e-13  # of float64 for coordinates of a few units and some dozen operations
POINTS = np.random.default_rng(11).normal(scale=1.5, size=(300, 3))
CORNERS = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
BRICK = om.box((0.8, 0.4, 0.6))

SAME: dict[str, tuple[om.Shape, om.Shape]] = {
    "prism over a rectangle": (om.rectangle((1, 2)).extrude(3), om.box((1, 2, 3))),
    "turned rectangle": (om.rectangle((1, 2)).revolve(), om.cylinder(0.5, 2)),
    "turned circle": (om.circle(0.3).revolve(1.0), om.torus(1, 0.3)),
    "drawn ball": (om.sphere(0.5).elongate((2, 0, 0)), om.capsule((-1, 0, 0), (1, 0, 0), 0.5)),
    "drawn box": (om.box((1, 1, 1)).elongate((0, 1, 2)), om.box((1, 2, 3))),
    "straight cone": (om.capped_cone(0.5, 0.5, 2), om.cylinder(0.5, 2)),
    "mirrored": (
        BRICK.translate(0.5, 0.3, 0).mirror("y"),
        BRICK.translate(0.5, 0.3, 0) | BRICK.translate(0.5, -0.3, 0),
    ),
    "two balls": (om.metaballs(om.sphere(1.0), om.sphere(1.0), k=0.5), om.sphere(1.0).round(0.5 * np.log(2))),
    "flat pyramid": (om.pyramid(2, 0), om.box((2, 0, 2))),
    "needle": (om.pyramid(0, 2), om.capsule((0, -1, 0), (0, 1, 0), 0)),
    "pyramid without size": (om.pyramid(0, 0), om.sphere(0)),
    "octahedron without size": (om.octahedron(0), om.sphere(0)),
    "cone without height": (om.capped_cone(0.5, 1, 0), om.cylinder(1, 0)),
    "cone without width": (om.capped_cone(0, 0, 2), om.capsule((0, -1, 0), (0, 1, 0), 0)),
    "rectangle without height": (om.rectangle((2, 0)).extrude(0), om.capsule((-1, 0, 0), (1, 0, 0), 0)),
}


@pytest.mark.parametrize("name", SAME)
def test_what_is_the_same_shape_has_the_same_distance(name: str):
    found, expected = (om.reference.distance(shape, POINTS) for shape in SAME[name])
    assert_allclose(found, expected, rtol=0, atol=ROUNDING)


def test_twist_leaves_what_is_round_about_its_axis():
    can = om.cylinder(0.5, 2)
    found, expected = (om.reference.distance(shape, POINTS) for shape in (can.twist(200), can))
    near = np.hypot(POINTS[:, 0], POINTS[:, 2]) < 0.5
    assert near.any()
    assert_allclose(found[near], expected[near], rtol=0, atol=ROUNDING)
    assert (found <= expected + ROUNDING).all()  # it is a bound where points are drawn to the axis


FACES: dict[str, tuple[om.Shape, list[Face]]] = {
    "octahedron": (om.octahedron(3.0), [((1, 1, 1), (1, 1, 1)), ((-1, 1, -1), (-1, 1, -1))]),
    "pyramid": (om.pyramid(2.0, 2.0), [((0.5, 0, 0), (2, 1, 0)), ((0, 0, -0.5), (0, 1, -2)), ((0, -1, 0), (0, -1, 0))]),
    "capped cone": (
        om.capped_cone(2, 1, 2),
        [((1.5, 0, 0), (2, 1, 0)), ((0, 1, 0), (0, 1, 0)), ((1, -1, 0), (0, -1, 0))],
    ),
    "polygon": (om.polygon(CORNERS), [((1, 0, 7), (0, -1, 0)), ((1, 1.5, 0), (1, 0, 0)), ((0, 1, 0), (-1, 0, 0))]),
    "clockwise": (om.polygon(CORNERS[::-1]), [((1, 0, 7), (0, -1, 0)), ((1, 1.5, 0), (1, 0, 0))]),
    "rectangle": (om.rectangle((2, 2)), [((1, 0.5, 9), (1, 0, 0)), ((0, -1, 0), (0, -1, 0))]),
    "box exterior": (om.box(2.0, form="exterior"), [((1, 0.5, 0), (1, 0, 0)), ((0, -1, 0.2), (0, -1, 0))]),
    "box maximum": (om.box(2.0, form="maximum"), [((1, 0.5, 0), (1, 0, 0)), ((0, -1, 0.2), (0, -1, 0))]),
    "extrude": (
        om.circle(1.0).extrude(2),
        [((0, 0, 1), (0, 0, 1)), ((0, 0, -1), (0, 0, -1)), ((1, 0, 0.5), (1, 0, 0))],
    ),
    "revolve": (
        om.rectangle((2, 2)).revolve(2),
        [((3, 0, 0), (1, 0, 0)), ((0, 0, -1), (0, 0, 1)), ((2, 1, 0), (0, 1, 0))],
    ),
    "shell": (om.box(2.0).shell(0.5), [((1.25, 0, 0), (1, 0, 0)), ((0.75, 0, 0.1), (-1, 0, 0))]),
    "elongate": (
        om.sphere(1.0).elongate((0, 2, 0)),
        [((1, 0, 0), (1, 0, 0)), ((1, 1, 0), (1, 0, 0)), ((0, 2, 0), (0, 1, 0))],
    ),
    "mirror": (om.plane((1, 0, 0)).mirror("x"), [((0, 2, 0), (1, 0, 0)), ((-3, 0, 0), (-1, 0, 0))]),
}


@pytest.mark.parametrize("name", FACES)
def test_gradient_on_a_face_is_its_normal(name: str):
    shape, faces = FACES[name]
    points, normals = (np.array(column, np.float64) for column in zip(*faces, strict=True))
    expected = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    assert_allclose(om.reference.gradient(shape, points), expected, atol=ROUNDING)


@pytest.mark.parametrize(
    ("shape", "points"),
    [
        (om.octahedron(1.0), [(0.5, 0.5, 0), (1, 0, 0), (0, 0, -1)]),
        (om.pyramid(2.0, 2.0), [(0, 1, 0), (1, -1, 1), (1, -1, 0)]),
        (om.capped_cone(2, 1, 2), [(1, 1, 0), (2, -1, 0)]),
        (om.polygon(CORNERS), [(0, 0, 0), (1, 1, 0), (2, 0, 5)]),
        (om.box(2.0, form="maximum"), [(1, 1, 1), (-1, 1, 0), (0, 0, 0)]),
    ],
    ids=lambda argument: argument._node.kind if isinstance(argument, om.Shape) else "",
)
def test_gradient_on_edges_and_corners_is_that_of_a_side(shape: om.Shape, points: list[tuple[float, ...]]):
    assert_allclose(np.linalg.norm(om.reference.gradient(shape, points), axis=1), 1)


def test_nothing_leads_out_of_the_middle_of_a_box_that_is_0_inside():
    shape = om.box(2.0, form="exterior")
    assert_array_equal(om.reference.distance(shape, [0.2, 0.5, 0]), 0)
    assert_array_equal(om.reference.gradient(shape, [0.2, 0.5, 0]), 0)
