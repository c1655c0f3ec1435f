"""Materials whose properties are numbers or expressions: what they hold, what a program gives back, what is seen."""

import copy
import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose

import octomarch as om

X, Y, Z = om.coordinates()
NAN = float("nan")
RAINBOW = om.Texture(0.5 + 0.5 * X, 0.5 + 0.5 * Y, 0.5)

MATERIALS = {
    "plain": om.Material(),
    "red": om.Material((0.8, 0.1, 0.1), roughness=0.3, specular=0.2, metallic=0.1, reflectivity=0.4),
    "texture": om.Material(RAINBOW),
    "expressions": om.Material((X, 0.5, Y * Z)),
    "grey expression": om.Material(abs(X)),
    "all": om.Material(RAINBOW, om.clamp(X, 0, 1), abs(Y), X > 0, om.noise(X, Y, Z) ** 2),
    "normal": om.Material(abs(om.normals()[1])),
}


@pytest.mark.parametrize("name", MATERIALS)
def test_programs_give_materials_back(name: str):
    material = MATERIALS[name]
    assert om.compile(om.sphere(1.0).paint(material)).materials == [material]


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_are_values(name: str):
    material = MATERIALS[name]
    same = dataclasses.replace(material)
    assert same == material == copy.deepcopy(material)
    assert hash(same) == hash(material)
    assert om.sphere(1.0).paint(same) == om.sphere(1.0).paint(material)
    assert same != dataclasses.replace(material, roughness=0.123)


def test_equal_materials_count_once():
    shape = om.sphere(1.0).paint(om.Material(RAINBOW)) | om.box(1.0).paint(om.Material(om.Texture(*RAINBOW.components)))
    assert len(om.compile(shape).materials) == 1


def test_what_is_the_same_everywhere_is_a_number():
    material = om.Material(om.Texture(0.1, 0.2, 0.3), roughness=om.minimum(0.25))
    assert material.color == (0.1, 0.2, 0.3)
    assert material.roughness == 0.25
    assert material == om.Material((0.1, 0.2, 0.3), 0.25)
    assert om.Material((X, 0.5, 0.5)).color == om.Texture(X, 0.5, 0.5)
    assert om.Material(X).color == om.Texture(X, X, X)


def seen(shape: om.Shape, points, isa: str | None = None, precision: str = "float64") -> np.ndarray:
    """Return colours of a surface seen from above at (x, z) under ambient light of strength 1 alone."""
    colors = []
    for x, z in points:
        image = om.render(
            om.Scene(shape, ambient=1),
            om.OrthographicCamera((x, 9, z), (x, 0, z), up=(0, 0, -1), height=1e-3),
            (1, 1),
            shading=om.Shading(occlusion=0),
            precision=precision,
            isa=isa,
        )
        colors.append(image.color[0, 0])
    return np.array(colors)


def test_colours_are_those_of_the_position(isa: str):
    material = om.Material(om.Texture(0.5 + 0.25 * X, 0.5 + 0.25 * Y, 0.5 + 0.25 * Z))
    found = seen(om.box((4, 1, 4)).paint(material), [(0, 0), (1, 0.5), (-1.5, -1)], isa)
    assert_allclose(found, [(0.5, 0.625, 0.5), (0.75, 0.625, 0.625), (0.125, 0.625, 0.25)], 0, 1e-6)


def test_paint_moves_with_the_shape(isa: str):
    """Expressions are those of the shape's own coordinates, whatever becomes of it after it is painted."""
    painted = om.box((4, 1, 4)).paint(om.Material(om.Texture(0.5 + 0.25 * X, 0.5, 0.5 + 0.25 * Z)))
    moved = painted.scale(0.5).rotate(90, "y").translate(3, 0, 0)
    # (x, z) of the box comes to (3 + z/2, −x/2)
    found = seen(moved, [(3, 0), (3, -0.5), (3.5, 0)], isa)
    assert_allclose(found, [(0.5, 0.5, 0.5), (0.75, 0.5, 0.5), (0.5, 0.5, 0.75)], 0, 1e-6)
    fixed = om.box((4, 1, 4)).translate(3, 0, 0).paint(om.Material(om.Texture(0.25 * X, 0, 0)))
    assert_allclose(seen(fixed, [(3, 0)], isa), [(0.75, 0, 0)], 0, 1e-6)


def test_normals_turn_with_the_shape(isa: str):
    up = om.Material(om.Texture(*(0.5 + 0.5 * n for n in om.normals())))
    assert_allclose(seen(om.box((4, 1, 4)).paint(up), [(0, 0)], isa), [(0.5, 1, 0.5)], 0, 1e-6)
    assert_allclose(seen(om.box((1, 4, 4)).paint(up).rotate(90, "z"), [(0, 0)], isa), [(1, 0.5, 0.5)], 0, 1e-6)


def test_values_beyond_their_range_are_clamped(isa: str):
    wild = om.Material(
        (X - 5, 0.5, om.sqrt(X - 5)), roughness=9 * X - 5, specular=-X, metallic=X / 0, reflectivity=-9 - X
    )
    light = om.DirectionalLight((0, -1, 0))
    image = om.render(
        om.Scene(om.box(2.0).paint(wild), lights=[light]), om.Camera((3, 3, 3), (0, 0, 0)), (24, 18), isa=isa
    )
    assert np.isfinite(image.color).all()
    assert (image.color >= 0).all()
    assert_allclose(seen(om.box(2.0).paint(wild), [(0.25, 0)], isa)[0, [0, 2]], 0)


def test_roughness_widens_the_highlight():
    """Phong: at the mirror direction every exponent gives the same; off it a rougher surface gives more."""
    light = om.DirectionalLight((0, -1, 0))

    def brightness(roughness, x: float) -> float:
        ball = om.sphere(1.0).paint(om.Material(0.0, roughness=roughness, specular=1.0))
        camera = om.OrthographicCamera((x, 9, 0), (x, 0, 0), up=(0, 0, -1), height=1e-3)
        image = om.render(om.Scene(ball, lights=[light], ambient=0), camera, (1, 1), precision="float64")
        return float(image.color[0, 0, 0])

    assert brightness(0.2, 0.0) == pytest.approx(brightness(0.8, 0.0), abs=1e-3)
    assert brightness(0.2, 0.3) < brightness(0.5, 0.3) < brightness(0.8, 0.3)
    assert brightness(0.2 + 0 * X, 0.3) == pytest.approx(brightness(0.2, 0.3))
    exponent, angle = 2 / 0.8**4 - 2, np.arcsin(0.3)
    assert brightness(0.8, 0.3) == pytest.approx(np.cos(2 * angle) ** exponent, rel=1e-2)


def test_metals_colour_their_highlight():
    light = om.DirectionalLight((0, -1, 0))

    def color(metallic: float) -> np.ndarray:
        ball = om.sphere(1.0).paint(om.Material((1, 0.5, 0.25), specular=0.5, metallic=metallic))
        camera = om.OrthographicCamera((0, 9, 0), (0, 0, 0), up=(0, 0, -1), height=1e-3)
        return om.render(om.Scene(ball, lights=[light], ambient=0), camera, (1, 1), precision="float64").color[0, 0]

    assert_allclose(color(1.0), [1, 0.5, 0.25], rtol=1e-3)
    assert_allclose(color(0.0), [1.5, 1, 0.75], rtol=1e-3)


@pytest.mark.parametrize("name", MATERIALS)
def test_every_isa_shows_the_same(name: str, precision: str):
    shape = om.sphere(1.0).paint(MATERIALS[name]).union(om.box(1.2).translate(0.9, 0, 0), smooth=0.3)
    first, *others = (om.render(shape, size=(32, 24), precision=precision, isa=isa).color for isa in om.isas())
    for other in others:
        np.testing.assert_array_equal(other, first)


@pytest.mark.parametrize("slot", ["roughness", "specular", "metallic", "reflectivity"])
@pytest.mark.parametrize("value", [NAN, -0.5, 1.5], ids=str)
def test_numbers_outside_their_range_are_named(slot: str, value: float):
    with pytest.raises(ValueError, match=rf"{slot} must lie in \[0, 1\], got {value}"):
        om.Material(**{slot: value})


@pytest.mark.parametrize("slot", ["roughness", "specular", "metallic", "reflectivity"])
@pytest.mark.parametrize("value", ["a", None, True, (1, 2, 3), RAINBOW], ids=str)
def test_wrong_types_are_named(slot: str, value):
    with pytest.raises(TypeError, match=f"{slot} must be a number"):
        om.Material(**{slot: value})


@pytest.mark.parametrize(
    ("color", "message"),
    [
        ((0.5, -1, 0), "color must have components ≥ 0"),
        ((0.5, NAN, 0), "color must be finite"),
        ((0.5, NAN, X), r"color\[1\] must be a number, got nan"),
        ((0.5, X), "color must have three components"),
        ((0.5, 0.5), "color must be three numbers"),
        (om.Texture(-1, 0, 0), "color must have components ≥ 0"),
    ],
)
def test_impossible_colours_are_refused(color, message):
    with pytest.raises(ValueError, match=message):
        om.Material(color=color)
