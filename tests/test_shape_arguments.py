"""Bad arguments of shapes and operators: refused at once, by a message that names the argument and the value."""

import numpy as np
import pytest

import octomarch as om

BALL = om.sphere(1.0)
CUBE = om.box(1.5)
FLAT = om.circle(1.0)
NAN, INF = float("nan"), float("inf")
X, Y, Z = om.coordinates()

LENGTHS = [  # ≥ 0 and finite
    (lambda v: om.sphere(v), "radius"),
    (lambda v: om.box(v), "size"),
    (lambda v: om.box((1, v, 1)), "size"),
    (lambda v: om.box(v, form="maximum"), "size"),
    (lambda v: om.rounded_box(v, 0.1), "size|radius"),
    (lambda v: om.rounded_box(1, v), "radius"),
    (lambda v: om.cylinder(v), "radius"),
    (lambda v: om.cylinder(1, v), "height"),
    (lambda v: om.cone(v, 1), "radius"),
    (lambda v: om.cone(1, v), "height"),
    (lambda v: om.capped_cone(v, 1, 1), "radius_bottom"),
    (lambda v: om.capped_cone(1, v, 1), "radius_top"),
    (lambda v: om.capped_cone(1, 1, v), "height"),
    (lambda v: om.torus(v, 1), "radius"),
    (lambda v: om.torus(1, v), "tube_radius"),
    (lambda v: om.capsule((0, 0, 0), (1, 0, 0), v), "radius"),
    (lambda v: om.octahedron(v), "radius"),
    (lambda v: om.pyramid(v, 1), "edge"),
    (lambda v: om.pyramid(1, v), "height"),
    (lambda v: om.hexagonal_prism(v, 1), "radius"),
    (lambda v: om.hexagonal_prism(1, v), "height"),
    (lambda v: om.triangular_prism(v, 1), "radius"),
    (lambda v: om.triangular_prism(1, v), "height"),
    (lambda v: om.link(v, 1, 1), "length"),
    (lambda v: om.link(1, v, 1), "radius"),
    (lambda v: om.link(1, 1, v), "tube_radius"),
    (lambda v: om.circle(v), "radius"),
    (lambda v: om.rectangle(v), "size"),
    (lambda v: om.rectangle((1, v)), "size"),
    (lambda v: om.regular_polygon(5, v), "radius"),
    (lambda v: om.star(5, v, 1), "outer"),
    (lambda v: om.star(5, 1, v), "inner"),
    (lambda v: om.segment((0, 0), (1, 0), v), "radius"),
    (lambda v: om.gyroid(1, v), "thickness"),
    (lambda v: om.schwarz_p(1, v), "thickness"),
    (lambda v: om.diamond(1, v), "thickness"),
    (lambda v: om.union(BALL, CUBE, smooth=v), "smooth"),
    (lambda v: om.metaballs(BALL, CUBE, k=v), "k"),
    (lambda v: BALL.repeat(v), "period"),
    (lambda v: BALL.tile(v), "period"),
    (lambda v: BALL.tile((1, v, None)), "period"),
    (lambda v: BALL.round(v), "radius"),
    (lambda v: BALL.shell(v), "thickness"),
    (lambda v: BALL.elongate((v, 0, 0)), "lengths"),
    (lambda v: BALL.displace(X, lipschitz=v), "lipschitz"),
    (lambda v: FLAT.extrude(v), "height"),
    (lambda v: FLAT.revolve(v), "offset"),
]
FACTORS = [  # > 0 and finite
    (lambda v: BALL.scale(v), "factor"),
    (lambda v: BALL.stretch((1, v, 1)), "factors"),
    (lambda v: BALL.tile(1, scale=v), "scale"),
    (lambda v: om.ellipsoid((1, v, 1)), "radii"),
    (lambda v: om.ellipse((1, v)), "radii"),
    (lambda v: om.gyroid(v, 0.1), "period"),
    (lambda v: om.schwarz_p(v, 0.1), "period"),
    (lambda v: om.diamond(v, 0.1), "period"),
]
NUMBERS = [  # finite
    (lambda v: om.sphere(1, center=(0, v, 0)), "center"),
    (lambda v: om.cone(1, 1, center=(0, v, 0)), "center"),
    (lambda v: om.ellipsoid((1, 1, 1), center=(0, v, 0)), "center"),
    (lambda v: om.octahedron(1, center=(0, v, 0)), "center"),
    (lambda v: om.pyramid(1, 1, center=(0, v, 0)), "center"),
    (lambda v: om.hexagonal_prism(1, 1, center=(0, v, 0)), "center"),
    (lambda v: om.link(1, 1, 1, center=(0, v, 0)), "center"),
    (lambda v: om.rounded_box(1, 0.1, center=(0, v, 0)), "center"),
    (lambda v: om.circle(1, center=(v, 0)), "center"),
    (lambda v: om.ellipse((1, 1), center=(v, 0)), "center"),
    (lambda v: om.rectangle(1, center=(v, 0)), "center"),
    (lambda v: om.star(5, 1, 1, center=(v, 0)), "center"),
    (lambda v: om.polygon([(0, 0), (1, v), (0, 1)]), r"corners\[1\]"),
    (lambda v: om.segment((0, v), (1, 0), 1), "a"),
    (lambda v: om.segment((0, 0), (1, v), 1), "b"),
    (lambda v: om.plane(normal=(0, v, 0)), "normal"),
    (lambda v: om.plane(point=(0, v, 0)), "point"),
    (lambda v: om.capsule((0, v, 0), (1, 0, 0), 1), "a"),
    (lambda v: om.capsule((0, 0, 0), (v, 0, 0), 1), "b"),
    (lambda v: BALL.translate(v), "offset|x"),
    (lambda v: BALL.tile(1, offset=v), "offset"),
    (lambda v: BALL.tile(1, offset=(0, v, 0)), "offset"),
    (lambda v: BALL.rotate(v), "degrees"),
    (lambda v: BALL.rotate(30, (0, v, 0)), "axis"),
    (lambda v: BALL.twist(v), "degrees"),
    (lambda v: BALL.bend(v), "degrees"),
    (lambda v: om.cylinder(1, axis=(0, v, 0)), "axis"),
    (lambda v: om.cone(1, 1, axis=(0, v, 0)), "axis"),
    (lambda v: om.triangular_prism(1, 1, axis=(0, v, 0)), "axis"),
]


@pytest.mark.parametrize(("build", "argument"), [*LENGTHS, *FACTORS])
@pytest.mark.parametrize("value", [NAN, INF, -INF, -1.0], ids=str)
def test_values_outside_their_domain_are_named(build, argument, value):
    with pytest.raises(ValueError, match=f"^({argument})") as error:
        build(value)
    assert str(value).split(".")[0] in str(error.value)


@pytest.mark.parametrize(("build", "argument"), FACTORS)
def test_factors_of_zero_are_named(build, argument):
    with pytest.raises(ValueError, match=f"^({argument}).*> 0.*got"):
        build(0.0)


@pytest.mark.parametrize(("build", "argument"), NUMBERS)
@pytest.mark.parametrize("value", [NAN, INF], ids=str)
def test_values_that_are_not_finite_are_named(build, argument, value):
    with pytest.raises(ValueError, match=f"^({argument})"):
        build(value)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: om.plane(normal=(0, 0, 0)), "normal"),
        (lambda: om.cylinder(1, axis=(0, 0, 0)), "axis"),
        (lambda: om.cone(1, 1, axis=(0, 0, 0)), "axis"),
        (lambda: om.hexagonal_prism(1, 1, axis=(0, 0, 0)), "axis"),
        (lambda: om.cylinder(1, axis="w"), "axis must be 'x', 'y', 'z' or three numbers, got 'w'"),
        (lambda: om.box((1, 2)), r"size must be three numbers, got \(1, 2\)"),
        (lambda: om.box(np.ones((3, 3))), r"size must be three numbers, got an array of shape \(3, 3\)"),
        (lambda: om.box(1, form="round"), "form must be one of 'exact', 'exterior', 'maximum', got 'round'"),
        (
            lambda: om.rounded_box((1, 2, 3), 0.51),
            r"radius must be at most half .* of size, 0\.5, got 0\.51",
        ),
        (lambda: om.rectangle((1, 2, 3)), r"size must be two numbers, got \(1, 2, 3\)"),
        (lambda: om.circle(1, center=(0, 0, 0)), r"center must be two numbers, got \(0, 0, 0\)"),
        (lambda: om.polygon([(0, 0), (1, 1)]), "corners must be three points or more, got 2"),
        (lambda: om.polygon(np.ones((4, 3))), r"corners\[0\] must be two numbers, got array"),
        (lambda: om.polygon([]), "corners must be three points or more, got 0"),
        (lambda: om.regular_polygon(2, 1), r"sides must lie in \[3, 4096\], got 2"),
        (lambda: om.star(1, 1, 0.5), r"points must lie in \[2, 4096\], got 1"),
        (lambda: om.segment((-1e308, 0), (1e308, 0), 1), "b must be near enough"),
        (lambda: om.gyroid(5e-324, 0.1), "period must be large enough"),
        (lambda: BALL.repeat((1, 2)), "period must be one number, or three"),
        (lambda: BALL.repeat(1, (1, 2)), "counts must be one integer or three"),
        (lambda: BALL.repeat(1, -1), "counts must lie in"),
        (lambda: BALL.repeat(0), "period"),
        (lambda: BALL.tile(0), "period"),
        (lambda: BALL.tile((None, None, None)), "period"),
        (lambda: BALL.tile((1, 2)), "period must be one number, or three"),
        (lambda: BALL.tile(1, scale=5e-324), "scale must be large enough"),
        (lambda: BALL.mirror(""), "axes must be letters of 'xyz', each once, got ''"),
        (lambda: BALL.mirror("xx"), "axes must be letters of 'xyz', each once, got 'xx'"),
        (lambda: BALL.mirror("w"), "axes must be letters of 'xyz', each once, got 'w'"),
        (lambda: BALL.twist(30, "w"), "axis must be one of 'x', 'y', 'z', got 'w'"),
        (lambda: om.plane().twist(30), "shape must be bounded across the axis that it is twisted about, got plane"),
        (lambda: om.cylinder(1, axis="x").twist(30), "shape must be bounded across the axis"),
        (lambda: (~BALL).twist(30), "shape must be bounded across the axis"),
        (lambda: om.plane().bend(30), "shape must be bounded in x and y, got plane"),
        (lambda: BALL.extrude(1), "shape must be flat, the same at every z, got sphere"),
        (lambda: BALL.revolve(1), "shape must be flat, the same at every z, got sphere"),
        (lambda: BALL.displace(X * X), "lipschitz must be given"),
        (lambda: BALL.displace(om.normals()[0]), "expression must be without the normal"),
        (lambda: om.union(), "shapes"),
        (lambda: om.metaballs(k=1), "shapes"),
    ],
)
def test_impossible_values_are_refused(build, message):
    with pytest.raises(ValueError, match=message):
        build()


WRONG = ["a", None, 1j, True, [1.0], BALL]


@pytest.mark.parametrize("value", WRONG, ids=repr)
@pytest.mark.parametrize(
    ("build", "argument"),
    [
        (lambda v: om.sphere(v), "radius"),
        (lambda v: om.rounded_box(1, v), "radius"),
        (lambda v: om.cone(v, 1), "radius"),
        (lambda v: om.capped_cone(1, v, 1), "radius_top"),
        (lambda v: om.torus(1, v), "tube_radius"),
        (lambda v: om.octahedron(v), "radius"),
        (lambda v: om.pyramid(1, v), "height"),
        (lambda v: om.hexagonal_prism(1, v), "height"),
        (lambda v: om.link(v, 1, 1), "length"),
        (lambda v: om.circle(v), "radius"),
        (lambda v: om.star(v, 1, 1), "points"),
        (lambda v: om.star(5, v, 1), "outer"),
        (lambda v: om.regular_polygon(v, 1), "sides"),
        (lambda v: om.gyroid(v, 1), "period"),
        (lambda v: om.gyroid(1, v), "thickness"),
        (lambda v: om.plane(point=(0, v, 0)), "point"),
        (lambda v: BALL.rotate(v), "degrees"),
        (lambda v: BALL.scale(v), "factor"),
        (lambda v: BALL.stretch(v), "factors"),
        (lambda v: BALL.mirror(v), "axes"),
        (lambda v: BALL.elongate(v), "lengths"),
        (lambda v: BALL.twist(v), "degrees"),
        (lambda v: BALL.twist(30, v), "axis"),
        (lambda v: BALL.bend(v), "degrees"),
        (lambda v: BALL.round(v), "radius"),
        (lambda v: BALL.shell(v), "thickness"),
        (lambda v: BALL.tile(1, scale=v), "scale"),
        (lambda v: FLAT.extrude(v), "height"),
        (lambda v: FLAT.revolve(v), "offset"),
        (lambda v: BALL.union(CUBE, smooth=v), "smooth"),
        (lambda v: om.metaballs(BALL, CUBE, k=v), "k"),
        (lambda v: BALL.translate(0, v), "y"),
        (lambda v: BALL.paint(v), "material"),
    ],
)
def test_wrong_types_are_named(build, argument, value):
    if (argument in ("axes", "axis") and value == "a") or (argument in ("factors", "lengths") and value == [1.0]):
        return  # of the right type, and of a wrong value
    with pytest.raises(TypeError, match=f"^{argument}"):
        build(value)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: om.metaballs(BALL, 1, k=1), r"shapes must be om\.Shape, got 1"),
        (lambda: om.polygon("abc"), r"corners must be pairs \(x, y\), got 'abc'"),
        (lambda: om.polygon([1, 2, 3]), r"corners\[0\] must be two numbers, got 1"),
        (lambda: om.polygon(3), r"corners must be pairs \(x, y\), got 3"),
        (lambda: om.ellipsoid(2), "radii must be three numbers, got 2"),
        (lambda: om.ellipse(2), "radii must be two numbers, got 2"),
        (lambda: BALL.tile(1, offset="a"), "offset must be three numbers, got 'a'"),
        (lambda: BALL.tile("a"), r"period must be (a|three) numbers?, got 'a'"),
        (lambda: BALL.displace("a"), "expression must be a number or an om.Expression, got 'a'"),
        (lambda: BALL.displace(X, lipschitz="a"), "lipschitz must be a number, got 'a'"),
        (lambda: om.box(1, form=3), "form must be one of"),
        (lambda: om.metaballs(BALL, CUBE), "k"),
    ],
)
def test_wrong_kinds_are_refused(build, message):
    with pytest.raises(TypeError, match=message):
        build()
