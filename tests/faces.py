"""Points on surfaces with their normals, on edges with the normals beside them, and where no direction leads away.

Points lie at coordinates that floats hold: there the secant finish ends, and there several formulas tie.
"""

import numpy as np

import octomarch as om
from limits import RING

X, Y, Z = np.eye(3)
ANGLE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
DIAMOND = [(0, -1), (1, 0), (0, 1), (-1, 0)]

ANGLE_FACES = [((1, 0, 7), -Y), ((2, 0.5, 0), X), ((1.5, 1, 0), Y), ((1, 1.5, 0), X), ((0.5, 2, 0), Y), ((0, 1, 3), -X)]

FACES = {
    "box": (om.box(2.0), [(p * s, p * s) for p in np.eye(3) for s in (1, -1)]),
    "box off the middle": (
        om.box(2.0),
        [((s, 0.5, -0.25), (s, 0, 0)) for s in (1, -1)] + [((0.5, -0.25, s), (0, 0, s)) for s in (1, -1)],
    ),
    "moved box": (om.box((1, 2, 4), center=(2, 0, 1)), [((2.5, 0, 1), X), ((2, -1, 1), -Y), ((2, 0, 3), Z)]),
    "box, outside only": (om.box(2.0, form="exterior"), [((1, 0.5, 0), X), ((0, -1, 0.25), -Y)]),
    "box, largest excess": (om.box(2.0, form="maximum"), [((1, 0.5, 0), X), ((0, -1, 0.25), -Y)]),
    "room": (~om.box(4.0), [((2, 0, 0), -X), ((0, -2, 1), Y)]),
    "turned box": (om.box((2, 4, 6)).rotate(90, "z"), [((2, 0, 0), X), ((0, -1, 0), -Y), ((0, 0, 3), Z)]),
    "plane": (om.plane((0, -1, 0), (0, 1, 0)), [((5, 1, -7), -Y)]),
    "sphere": (om.sphere(1.0), [(p * s, p * s) for p in np.eye(3) for s in (1, -1)]),
    "cylinder": (om.cylinder(1.0), [((0, 5, 1), Z), ((-1, 0, 0), -X)]),
    "can": (om.cylinder(1.0, 2), [((1, 0, 0), X), ((0, 0, -1), -Z), ((0, 1, 0), Y), ((0.5, -1, 0), -Y)]),
    "can along x": (om.cylinder(1.0, 2, axis="x"), [((1, 0, 0), X), ((0, 1, 0), Y), ((-1, 0.5, 0), -X)]),
    "torus": (om.torus(1, 0.25), [((1.25, 0, 0), X), ((0.75, 0, 0), -X), ((0, 0.25, 1), Y), ((0, -0.25, -1), -Y)]),
    "capsule": (
        om.capsule((0, -1, 0), (0, 1, 0), 0.5),
        [((0.5, 1, 0), X), ((0.5, -1, 0), X), ((0, 1.5, 0), Y), ((0, -1.5, 0), -Y), ((0, 0, -0.5), -Z)],
    ),
    "capped cone": (om.capped_cone(2, 1, 2), [((0, 1, 0), Y), ((0.5, 1, 0), Y), ((1, -1, 1), -Y)]),
    "pyramid": (om.pyramid(2, 2), [((0, -1, 0), -Y), ((0.5, -1, 0.25), -Y)]),
    "prism": (om.hexagonal_prism(1.0, 2.0), [((0, 1, 0), Y), ((0.25, -1, 0.25), -Y)]),
    "link": (
        om.link(2.0, 0.5, 0.25),
        [((0.75, 0.5, 0), X), ((0.75, 1, 0), X), ((0, 1.75, 0), Y), ((0.25, 0, 0), -X), ((-0.5, 0.5, 0.25), Z)],
    ),
    "circle": (om.circle(1.0), [((1, 0, 5), X), ((0, -1, 0), -Y)]),
    "rectangle": (om.rectangle((2, 4)), [((1, 0.5, 9), X), ((0, -2, 0), -Y), ((0, 2, 1), Y)]),
    "polygon": (om.polygon(ANGLE), ANGLE_FACES),
    "polygon, clockwise": (om.polygon(ANGLE[::-1]), ANGLE_FACES),
    "polygon with a hole": (
        om.polygon(RING),
        [((1, 0, 0), X), ((0.25, 1, 0), Y), ((0.5, 0, 0), -X), ((0, 0.5, 0), -Y), ((-0.5, 0, 0), X), ((0, -0.5, 0), Y)],
    ),
    "segment": (om.segment((-1, 0), (1, 0), 0.5), [((0, 0.5, 0), Y), ((1.5, 0, 0), X), ((-1, -0.5, 3), -Y)]),
    "extruded": (om.circle(1.0).extrude(2), [((0, 0, 1), Z), ((0.5, 0, -1), -Z), ((1, 0, 0.5), X)]),
    "revolved": (om.rectangle((2, 2)).revolve(2), [((3, 0, 0), X), ((0, 0, -1), Z), ((2, 1, 0), Y), ((0, -1, 2), -Y)]),
    "rounded": (om.box(1.0).round(0.5), [((1, 0, 0), X), ((0.25, -1, 0), -Y)]),
    "rounded box": (om.rounded_box(2.0, 0.5), [((1, 0, 0), X), ((0.25, -1, 0), -Y)]),
    "shell": (om.box(2.0).shell(0.5), [((1.25, 0, 0), X), ((0.75, 0, 0.125), -X), ((0, -1.25, 0), -Y)]),
    "elongated": (om.sphere(1.0).elongate((0, 2, 0)), [((1, 0, 0), X), ((1, 1, 0), X), ((0, 2, 0), Y)]),
    "mirrored": (om.plane(X).mirror("x"), [((0, 2, 0), X), ((0, -1, 1), X)]),
    "mirrored box": (
        om.box(1.0, center=(1, 0, 0)).mirror("x"),
        [((1.5, 0, 0), X), ((-0.5, 0, 0), X), ((-1.5, 0, 0), -X)],
    ),
    "stretched ball": (om.sphere(1.0).stretch((2, 1, 4)), [((2, 0, 0), X / 2), ((0, -1, 0), -Y), ((0, 0, 4), Z / 4)]),
    "twisted": (om.box((2, 1, 2)).twist(90), [((1, 0, 0), X), ((0, 0, -1), -Z), ((0.25, 0.5, 0), Y)]),
    "bent": (om.box((2, 1, 2)).bend(90), [((0, 0.5, 0.25), Y), ((0, 0, 1), Z)]),
    "tile": (
        om.box(0.5, center=(0.5, 0, 0)).tile((1, 0, 0)),
        [((-0.25, 0, 0), X), ((5.25, 0, 0), -X), ((-2.5, 0.25, 0), Y)],
    ),
    "repeat": (om.box(1.0).repeat(2), [((1.5, 0, 0), -X), ((0, -2.5, 0), -Y), ((4, 4, 4.5), Z)]),
    "repeat that leans": (om.box(0.5, center=(0.25, 0, 0)).repeat((2, 0, 0)), [((2, 0, 0), -X), ((-1.5, 0, 0), X)]),
    "wall and floor": (om.plane(Y) | om.box(2.0, center=(0, 1, 0)), [((1, 1, 0), X), ((3, 0, 0), Y), ((0, 2, 0), Y)]),
    "dug floor": (om.plane(Y) - om.box(2.0), [((0, -1, 0), Y), ((1, -0.5, 0), -X), ((-1, -0.5, 0.5), X)]),
    "cut ball": (om.sphere(2.0) & om.plane(X), [((0, 0.5, 0), X), ((0, -1, 1), X), ((-2, 0, 0), -X)]),
    "plane through the centre": (om.sphere(1.0) - om.plane(-Y, (0, 0.5, 0)), [((0, 0.5, 0), Y), ((0.25, 0.5, 0), Y)]),
    "point on a ball": (om.sphere(1.0) | om.sphere(0.0, center=X), [(X, X)]),
    "ball at a point": (om.sphere(0.0, center=X) | om.sphere(1.0), [(X, X)]),
    "ball about a point": (om.sphere(1.0) & ~om.sphere(0.0, center=-Y), [(-Y, -Y)]),
    "point cut out of a ball": (om.sphere(1.0) - om.sphere(0.0, center=Z), [(Z, Z)]),
}
"""Shape, and points with the gradient that the field has there: exactly 0 is its value."""

SLANTED = {
    "octahedron": (
        om.octahedron(3.0),
        [((1, 1, 1), (1, 1, 1)), ((-1, 1, -1), (-1, 1, -1)), ((0.5, -2, 0.5), (1, -1, 1))],
    ),
    "pyramid": (
        om.pyramid(2.0, 2.0),
        [((0.5, 0, 0), (2, 1, 0)), ((0, 0, -0.5), (0, 1, -2)), ((-0.5, 0, 0.25), (-2, 1, 0))],
    ),
    "cone": (om.cone(1.0, 2.0), [((0.5, 0, 0), (2, 1, 0)), ((0, -0.5, -0.75), (0, 1, -2))]),
    "prism": (om.hexagonal_prism(2.0, 1.0), [((3**0.5, 0, 0), X), ((-(3**0.5), 0.25, 0.5), -X)]),
    "diamond": (om.polygon(DIAMOND), [((0.5, 0.5, 0), (1, 1, 0)), ((-0.25, -0.75, 4), (-1, -1, 0))]),
    "thin blade": (om.polygon([(0, 0), (4, 0), (0, 2**-12)]), [((2, 0, 0), -Y), ((2, 2**-13, 0), (2**-14, 1, 0))]),
}
"""The same, up to rounding, for unit normals."""

CORNERS = {
    "octahedron": (om.octahedron(1.0), [(1, 0, 0), (0, 0, -1), (0.5, 0.5, 0)]),
    "pyramid": (om.pyramid(2.0, 2.0), [(0, 1, 0), (1, -1, 1), (1, -1, 0), (0.5, 0, 0.5)]),
    "capped cone": (om.capped_cone(2, 1, 2), [(1, 1, 0), (2, -1, 0)]),
    "diamond": (om.polygon(DIAMOND), [(0, -1, 0), (1, 0, 2), (0, 1, 0), (-1, 0, 0)]),
    "angle": (om.polygon(ANGLE), [(0, 0, 0), (2, 0, 0), (1, 2, 0)]),
    "prism": (om.triangular_prism(2.0, 2.0, axis="z"), [(0, 2, 0), (0, 2, 1), (0, 0, -1)]),
}
"""Points where faces of a convex solid, or of a right angle, meet: a little way along the gradient lies outside."""

EDGES = {
    "box edge": (om.box(2.0), (1, -1, 0), (X, -Y)),
    "box corner": (om.box(2.0), (1, 1, -1), (X, Y, -Z)),
    "box middle": (om.box(2.0), (0, 0, 0), (X, Y, Z, -X, -Y, -Z)),
    "box diagonal": (om.box(2.0), (0.5, 0.5, 0), (X, Y)),
    "box corner, largest excess": (om.box(2.0, form="maximum"), (1, 1, -1), (X, Y, -Z)),
    "polygon corner": (om.polygon(ANGLE), (2, 0, 0), (X, -Y)),
    "polygon notch": (om.polygon(ANGLE), (1, 1, 0), (X, Y)),
    "extruded rim": (om.circle(1.0).extrude(2), (0, 1, 1), (Y, Z)),
    "middle of a mirror": (om.box(1.0, center=(1, 0, 0)).mirror("x"), (0, 0, 0), (X, -X)),
    "middle of a wall": (om.plane(X).shell(1.0), (0, 0, 0), (X, -X)),
    "can rim": (om.cylinder(1.0, 2), (0, 1, 1), (Y, Z)),
    "can middle": (om.cylinder(1.0, 2), (0, 0, 0), (Y, -Y)),
    "two planes": (om.plane(X) | om.plane(Y), (0, 0, 0), (X, Y)),
    "wedge": (om.plane(X) & om.plane(Y), (0, 0, 1), (X, Y)),
    "notch": (om.plane(X) - om.plane(Y), (0, 0, 1), (X, -Y)),
    "border of cells": (om.sphere(0.5).repeat((2, 0, 0)), (1, 0, 0), (X, -X)),
    "border of leaning cells": (om.box(0.5, center=(0.5, 0, 0)).repeat((2, 0, 0)), (1.5, 0, 0), (X, -X)),
}
"""A point where faces meet, and their normals: the gradient is one of them."""

CENTRES = {
    "sphere": (om.sphere(1.0, center=(1, 2, 3)), (1, 2, 3)),
    "cylinder": (om.cylinder(1.0, axis="z"), (0, 0, 5)),
    "torus circle": (om.torus(1, 0.25), (0, 0, 1)),
    "torus middle": (om.torus(1, 0.25), (0, 0, 0)),
    "capsule segment": (om.capsule(-Y, Y, 0.5), (0, 0.5, 0)),
    "ball as capsule": (om.capsule(Y, Y, 0.5), Y),
    "line": (om.cylinder(0.0), Y),
    "stick": (om.cylinder(0.0, 2.0), (0, 0.5, 0)),
    "middle of a box that is 0 inside": (om.box(2.0, form="exterior"), (0.25, 0.5, 0)),
    "ellipsoid": (om.ellipsoid((1, 2, 3), center=X), X),
    "link circle": (om.link(2.0, 0.5, 0.25), (0.5, 0.25, 0)),
    "long can": (om.circle(1.0).extrude(4), (0, 0, 0.5)),
    "flat segment": (om.segment((-1, 0), (1, 0), 0.5), (0.5, 0, 0)),
    "twisted ball": (om.sphere(1.0).twist(90), (0, 0, 0)),
}
"""A point from which no direction leads away from the surface."""
