"""Shapes in GLSL, node by node: their distances and materials in a browser's WebGL, against those of the engine.

Tolerances are in units of what the numbers on the way may come to. Browsers compute sines, exponentials and the like to
about 2⁻¹⁵ only; the rest rounds as float32 does.
"""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import every_node
import octomarch as om
import painted
from octomarch import _core
from octomarch.glsl import functions
from octomarch.glsl.writer import WRITE
from sample_primitives import PRIMITIVES, primitive
from samples import Sample
from strategies import GENERIC, POINTS, grown, nested
from webgl import WebGl

ROUNDING = 1e-6
"""Sixteen units of roundoff of float32."""
FUNCTIONS = 2e-4
"""What sines and others of a browser may be off by."""
SOLID = 1e-18
"""Larger than what stands for inside and outside of a solid."""

UNKNOWN = {"grid"}
"""Kinds of shapes that shaders cannot hold; they are told."""
TIES = 0.02
"""Share of points that may have another material: those at which roundings choose between operands."""

X, Y, Z = om.coordinates()
CLOUD = np.random.default_rng(5).uniform(-2, 2, (1000, 3)).astype(np.float32)
NESTED = settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])


def distances(webgl: WebGl, shape: om.Shape, points: NDArray[Any]) -> NDArray[np.float64]:
    return webgl.values(functions(shape), "vec4(field(p), 0, 0, 0)", points)[:, 0].astype(np.float64)


def materials(webgl: WebGl, shape: om.Shape, points: NDArray[Any], normals: NDArray[Any]) -> NDArray[np.float32]:
    source = functions(shape)
    colors = webgl.values(source, "vec4(surface(p, n).color, surface(p, n).roughness)", points, normals)
    rest = "vec4(surface(p, n).specular, surface(p, n).metallic, surface(p, n).reflectivity, 0)"
    return np.concatenate([colors, webgl.values(source, rest, points, normals)[:, :3]], axis=1)


def engine_materials(shape: om.Shape, points: NDArray[Any], normals: NDArray[Any]) -> NDArray[np.float64]:
    program = om.compile(shape)._native
    return _core.material(program, points.astype(np.float64), normals.astype(np.float64), "float64", 0, "")


def normals_at(shape: om.Shape, points: NDArray[Any]) -> NDArray[np.float32]:
    gradient = shape.gradient(points)
    length = np.linalg.norm(gradient, axis=1, keepdims=True)
    return np.divide(gradient, length, out=np.zeros_like(gradient), where=length > 0).astype(np.float32)


def kinds_in(shape: om.Shape) -> set[str]:
    return {node.kind for node in _core.children_first([shape._node])}


def check(webgl: WebGl, sample: Sample) -> None:
    assume(not UNKNOWN & kinds_in(sample.shape))
    points = POINTS.astype(np.float32)
    size = np.abs(points).max(axis=1) + sample.extent + 1
    tolerance = size * sample.gain * (sample.levels + 2) * ROUNDING + (sample.gain > 1) * FUNCTIONS * (
        1 + sample.extent
    )
    difference = np.abs(distances(webgl, sample.shape, points) - sample.shape.distance(points))
    assert (difference <= tolerance).all()


def test_every_kind_of_shape_is_known():
    shapes = {node.kind for node in _core.children_first([every_node.everything().scene.shape._node])}
    of_shapes = {kind for kind in shapes if kind in _core.node_kinds()} & sorts("shape")
    assert of_shapes == sorts("shape"), "tests/every_node.py lacks a kind"
    assert set(WRITE) == sorts("shape") - UNKNOWN


def sorts(sort: str) -> set[str]:
    """Return the kinds of nodes of that sort among those of the shot that has all."""
    nodes = _core.children_first([every_node.everything().scene.shape._node])
    return {node.kind for node in nodes if node.sort == sort}


@pytest.mark.parametrize("number", range(len(every_node.shapes())))
def test_every_node_has_the_distances_of_the_engine(webgl: WebGl, number: int):
    shape = every_node.shapes()[number]
    unknown = UNKNOWN & kinds_in(shape)
    if unknown:
        with pytest.raises(om.SceneError, match=f"a shape of the kind '{unknown.pop()}' cannot be part of a shader"):
            functions(shape)
        return
    np.testing.assert_allclose(distances(webgl, shape, CLOUD), shape.distance(CLOUD), atol=FUNCTIONS + SOLID)


@pytest.mark.parametrize("number", range(len(every_node.materials())))
def test_every_expression_has_the_values_of_the_engine(webgl: WebGl, number: int):
    shape = om.sphere(1.0).paint(every_node.materials()[number])
    normals = normals_at(shape, CLOUD)
    found, expected = materials(webgl, shape, CLOUD, normals), engine_materials(shape, CLOUD, normals)
    np.testing.assert_allclose(found, expected, atol=FUNCTIONS, rtol=FUNCTIONS)


@pytest.mark.parametrize("name", sorted(PRIMITIVES.keys() - UNKNOWN))
def test_primitives_at_random(webgl: WebGl, name: str):
    @settings(max_examples=4)
    @given(PRIMITIVES[name])
    def run(sample: Sample) -> None:
        check(webgl, sample)

    run()


@NESTED
@given(nested())
def test_nested_shapes_at_random(webgl: WebGl, sample: Sample):
    check(webgl, sample)


PAINTS = [
    om.Material((0.9, 0.1, 0.2)),
    om.Material((0.5 + 0.2 * X, 0.5 + 0.2 * Y, 0.5 - 0.1 * Z), roughness=om.clamp(X * X, 0, 1)),
    om.Material(tuple(0.5 + 0.5 * component for component in om.normals()), metallic=0.4),
]


def painted_shapes() -> st.SearchStrategy[Sample]:
    """Return shapes of two operators over primitives, most of which are painted."""

    def paint(sample: Sample, number: int) -> Sample:
        return sample if number == len(PAINTS) else replace(sample, shape=sample.shape.paint(PAINTS[number]))

    leaves = st.builds(paint, primitive, st.integers(0, len(PAINTS)))
    return grown(st.one_of(leaves, grown(leaves)))


@NESTED
@given(painted_shapes())
def test_paint_of_random_shapes(webgl: WebGl, sample: Sample):
    assume(not UNKNOWN & kinds_in(sample.shape))
    points = POINTS[GENERIC].astype(np.float32)
    normals = normals_at(sample.shape, points)
    found = materials(webgl, sample.shape, points, normals)
    expected = engine_materials(sample.shape, points, normals)
    astray = (np.abs(found - expected) > 10 * FUNCTIONS).any(axis=1)
    assert astray.mean() <= TIES


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param(shape, id=f"{table}: {name}")
        for table in ("BLENDS", "PLACES", "NORMALS")
        for name, (shape, _) in getattr(painted, table).items()
    ],
)
def test_paint_goes_where_the_engine_takes_it(webgl: WebGl, shape: om.Shape):
    normals = normals_at(shape, CLOUD)
    found, expected = materials(webgl, shape, CLOUD, normals), engine_materials(shape, CLOUD, normals)
    np.testing.assert_allclose(found, expected, atol=3 * FUNCTIONS)


def expressions() -> dict[str, Any]:
    """Return an expression for each operation, of arguments within its range and beyond."""
    odd = om.where(X > 0, Y, Z)
    return {
        "arithmetic": X - (Y - (Z + 1) * (X / (Y * Y + 1))) / 3 - -2 * (-X),
        "comparisons": (X < Y) * 1.0 + (X <= Z) * 2.0 + om.where((X > 0) & (Y > 0) | ~(Z > 0), X, -Y),
        "functions": om.sqrt(abs(X)) + om.exp(-abs(Y)) + om.log(1 + Z * Z) + om.atan(X) + om.atan2(Y, X),
        "angles": om.sin(X) + om.cos(Y) * om.tan(Z / 2),
        "inverse": om.asin(om.clamp(X, -1, 1)) + om.acos(om.clamp(Y / 2, -1, 1)),
        "whole": om.floor(X) + om.ceil(Y) + om.mod(X, 0.7) + om.mod(Y, -0.3) + om.fract(Z) + om.sign(X),
        "powers": X**3 + om.power(abs(Y), Z) + Z**-2.0 * 0.0 + om.power(om.floor(X) - 0.5, om.floor(Y)),
        "choices": om.minimum(X, om.maximum(Y, odd)) + om.mix(X, Y, 0.3) + om.smoothstep(-1, 1, Z),
        "shared": sum((odd * odd + n) / (1 + odd * odd) for n in range(3)),
        "noise": om.noise(X, Y, Z, seed=3) + om.fractal_noise(X, Y, Z, octaves=3, seed=9),
        "pictures": om.image_texture(np.linspace(0, 1, 36).reshape(3, 4, 3), wrap="clamp").components[1],
    }


@pytest.mark.parametrize("name", expressions())
def test_expressions_have_the_values_of_the_engine(webgl: WebGl, name: str):
    expression = expressions()[name]
    near_edges = np.abs(CLOUD[:, :, np.newaxis] - np.arange(-20, 21) * 0.1).min(axis=(1, 2)) < 1e-4
    points = CLOUD[~near_edges]
    found = distances(webgl, om.field(expression, lipschitz=1), points)
    np.testing.assert_allclose(found, expression.evaluate(points), atol=5 * FUNCTIONS, rtol=FUNCTIONS)  # five, added up


def test_coordinates_count_from_the_anchor_of_what_is_far_away(webgl: WebGl):
    shape = (om.sphere(1.0) - om.box(1.2)).rotate(20).translate(1e7, 0, -1e7)
    anchor = np.array(om.compile(shape).anchor)
    np.testing.assert_allclose(distances(webgl, shape, CLOUD), shape.distance(CLOUD + anchor), atol=1e-5)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_solids_keep_their_inside_at_any_scale(webgl: WebGl, scale: float):
    shape = om.solid(X * X + Y * Y + Z * Z <= 1).scale(scale)
    points = CLOUD * np.float32(scale)
    np.testing.assert_array_equal(distances(webgl, shape, points) <= 0, shape.distance(points) <= 0)


def test_what_stands_in_several_places_is_written_once():
    part = (om.sphere(1.0) | om.box(1.5)).rotate(20)
    shape = part
    for step in range(1, 20):  # written out it would be a million parts
        shape = shape.translate(step, 0, 0) | shape.translate(0, step, 0)
    source = functions(shape)
    assert len(source) < 20_000
    assert source.count("= sphere(") == 1


def test_deep_shapes_need_no_deep_stack():
    shape = om.sphere(1.0)
    for step in range(900):
        shape = shape.round(1e-3) if step % 2 else shape.shell(0.01)
    assert functions(shape).count("\n") > 900


def test_names_say_what_a_line_is():
    part = om.box(2.0).rotate(30) - om.cylinder(0.5, axis="x").translate(0, 0.25, 0)
    body = functions(part).split("float field(vec3 p) {\n")[1].split("}")[0]
    assert body == (
        "  vec3 p1 = p * mat3(0.8660254, 0.0, -0.5, 0.0, 1.0, 0.0, 0.5, 0.0, 0.8660254);\n"
        "  float box1 = box(p1, vec3(1.0));\n"
        "  float cylinder1 = length((p - vec3(0.0, 0.25, 0.0)).yz) - 0.5;\n"
        "  float difference1 = max(box1, -cylinder1);\n"
        "  return difference1;\n"
    )


def test_only_what_is_needed_is_there():
    source = functions(om.sphere(1.0))
    assert "float sphere(" in source
    assert "float box(" not in source
    assert "gradient_noise" not in source


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (om.spheres(np.arange(3300.0).reshape(1100, 3), 0.1 + np.arange(1100)), "2048 are the"),
        (
            om.box(1.0).paint(om.Material(om.image_texture(np.zeros((65, 64, 3))))),
            "an image of 64 × 65 texels cannot be part of a shader: 4096 are the most",
        ),
        (
            om.union(
                *(
                    om.box(1.0).paint(om.Material(om.image_texture(np.full((size, 64), 0.5)))).translate(size, 0, 0)
                    for size in (60, 5)
                )
            ),
            "an image of 64 × 5 texels beside others of 3840 cannot be part of a shader: 4096 are the most",
        ),
    ],
)
def test_what_cannot_be_written_is_told(shape: om.Shape, message: str):
    with pytest.raises(om.SceneError, match=message):
        functions(shape)


def test_copies_of_a_repeat_are_all_looked_at(webgl: WebGl):
    lopsided = om.sphere(0.3).translate(0.1, 0.05, -0.1)
    for counts in itertools.product((None, 2, 3), repeat=3):
        shape = lopsided.repeat((1, 0.9, 1.1), counts=counts)
        np.testing.assert_allclose(distances(webgl, shape, CLOUD), shape.distance(CLOUD), atol=1e-5)
