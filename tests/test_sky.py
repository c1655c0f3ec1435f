"""Skies by hand: each formula against numpy, on every instruction set, and all of them against the reference."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import unit_roundoff
from strategies import Array

NOTHING = om.sphere(0.1, center=(0, 0, 90))
AROUND = om.PanoramicCamera((0, 0, 0), (0, 0, -1))
SIZE = (32, 16)
FORMULA = 64
"""Roundings between a direction and a colour of skies without pictures, slopes of stops by 4 included."""


def seen(sky, isa: str, precision: str = "float32", camera=AROUND, size=SIZE) -> Array:
    """Colours (height, width, 3) of nothing but sky."""
    planes = ("color", "status")
    image = om.render(om.Scene(NOTHING, sky=sky), camera, size, planes=planes, precision=precision, isa=isa)
    assert (image.status == om.Status.MISS).all()
    return image.color.astype(np.float64)


def directions(size=SIZE) -> Array:
    """Return the unit directions of AROUND's pixels."""
    longitude = 2 * np.pi * ((np.arange(size[0]) + 0.5) / size[0] - 0.5)
    latitude = np.pi * (0.5 - (np.arange(size[1]) + 0.5) / size[1])[:, None]
    flat = np.cos(latitude)
    return np.stack(np.broadcast_arrays(flat * np.sin(longitude), np.sin(latitude), -flat * np.cos(longitude)), -1)


@pytest.mark.parametrize("clamped", [True, False])
def test_two_colours_are_what_their_formula_says(clamped: bool, isa: str, precision: str):
    axis = np.array([1, 2, -2]) / 3
    sky = om.Sky(axis * 5, toward=(1, 0, 0.5), away=(0, 1, 0.25), base=(0, 0.5, 0.25), clamped=clamped)
    along = (directions() @ axis)[..., None]
    ahead, behind = (np.maximum(along, 0), np.maximum(-along, 0)) if clamped else (along, -along)
    expected = np.maximum(np.multiply(ahead, sky.toward) + np.multiply(behind, sky.away) + sky.base, 0)
    assert (expected == 0).any()
    assert_allclose(seen(sky, isa, precision), expected, rtol=0, atol=FORMULA * unit_roundoff(precision))


def test_one_colour_is_exact(isa: str, precision: str):
    color = (0.25, 0.5, 3)
    assert_array_equal(seen(om.ConstantSky(color), isa, precision), np.broadcast_to(color, (16, 32, 3)))


def test_gradients_pass_between_their_stops_and_stay_beyond(isa: str, precision: str):
    stops = [(-30, (1, 0, 0)), (0, (0, 1, 0)), (15, (0, 1, 2)), (60, (0.5, 0, 0))]
    elevation = np.degrees(np.arcsin(directions() @ [0, 0, 1]))
    places, colors = np.array([stop for stop, _ in stops]), np.array([color for _, color in stops])
    expected = np.stack([np.interp(elevation, places, colors[:, i]) for i in range(3)], -1)
    found = seen(om.GradientSky(stops, axis=(0, 0, 2)), isa, precision)
    assert_allclose(found, expected, rtol=0, atol=4 * FORMULA * unit_roundoff(precision))
    low = elevation < -31
    assert low.any()
    assert_array_equal(found[low], np.broadcast_to([1, 0, 0], (low.sum(), 3)))


def test_custom_skies_see_the_direction(isa: str, precision: str):
    x, y, z = om.coordinates()
    found = seen(om.CustomSky((x, 2 * y, z - x)), isa, precision)
    dx, dy, dz = np.moveaxis(directions(), -1, 0)
    expected = np.maximum(np.stack([dx, 2 * dy, dz - dx], -1), 0)
    assert_allclose(found, expected, rtol=0, atol=FORMULA * unit_roundoff(precision))


def test_textures_serve_as_skies(isa: str):
    found = seen(om.CustomSky(om.checker(0.25, 0.75, size=0.4)), isa)
    assert set(np.unique(found)) == {0.25, 0.75}


def test_colours_that_are_no_numbers_are_black(isa: str, precision: str):
    x, y, _ = om.coordinates()
    colors = seen(om.CustomSky((om.sqrt(x), om.log(y), (x - x) / (y - y))), isa, precision)
    assert np.isfinite(colors).all()
    assert (colors >= 0).all()
    dx = directions()[..., 0]
    assert (colors[..., 0][dx < -0.01] == 0).all()
    assert (colors[..., 0][dx > 0.01] > 0).all()
    assert (colors[..., 2] == 0).all()


# Environment maps ----------------------------------------------------------------------------------------------------

PICTURE = np.random.default_rng(5).random((8, 16, 3), np.float32)
TEXELS = 1000
"""What a picture of 16 texels across magnifies an angle's error by: two units in the last place of u, about 1, times
16 texels, times differences of 1 between them, and the same along v."""


def looked_up(picture: Array, u: Array, v: Array) -> Array:
    """Bilinear lookup, repeated along u, held along v."""
    height, width = picture.shape[:2]
    column, row = u * width - 0.5, (1 - v) * height - 0.5
    left, above = np.floor(column).astype(int), np.floor(row).astype(int)
    s, t = (column - left)[..., None], (row - above)[..., None]

    def texel(i: Array, j: Array) -> Array:
        return picture[np.clip(j, 0, height - 1), i % width]

    upper = texel(left, above) * (1 - s) + texel(left + 1, above) * s
    return upper * (1 - t) + (texel(left, above + 1) * (1 - s) + texel(left + 1, above + 1) * s) * t


@pytest.mark.parametrize("rotation", [0, 30, -400])
def test_environment_maps_are_looked_up_by_longitude_and_latitude(rotation: float, isa: str, precision: str):
    size = (24, 12)
    x, y, z = np.moveaxis(directions(size), -1, 0)
    u = np.arctan2(x, -z) / (2 * np.pi) + 0.5 + rotation / 360
    expected = 3 * looked_up(PICTURE.astype(np.float64), u, np.arcsin(y) / np.pi + 0.5)
    found = seen(om.EnvironmentMap(PICTURE, rotation, intensity=3), isa, precision, size=size)
    assert_allclose(found, expected, rtol=0, atol=TEXELS * unit_roundoff(precision))


def test_a_panoramic_picture_of_an_environment_map_is_the_map(isa: str):
    assert_allclose(seen(om.EnvironmentMap(PICTURE), isa, size=(16, 8)), PICTURE, rtol=0, atol=1e-5)


def test_environment_maps_turn_right_handed_about_y():
    """What lay ahead, along -z, is seen along -x after a quarter turn; and the middle row is the horizon."""
    ahead = np.zeros((1, 4, 3), np.float32)
    ahead[:, 1:3] = 1
    turned = om.EnvironmentMap(ahead, rotation=90).texture().evaluate([[-1, 0, 0], [1, 0, 0], [0, 0, -1]])
    assert_allclose(turned[:, 0], [1, 0, 0.5], atol=1e-12)


def test_environment_maps_come_from_files(tmp_path, isa: str):
    path = tmp_path / "around.exr"
    om.render(om.Scene(NOTHING, sky=om.Sky()), AROUND, SIZE, isa=isa).save(path)
    sky = om.EnvironmentMap(path)
    assert sky == om.EnvironmentMap(str(path)) == om.EnvironmentMap(sky.image)
    assert_allclose(seen(sky, isa), seen(om.Sky(), isa), atol=1e-5)
    with pytest.raises(FileNotFoundError, match="nowhere"):
        om.EnvironmentMap(tmp_path / "nowhere.exr")


def test_poles_of_environment_maps_are_no_holes(isa: str):
    sky = om.EnvironmentMap(np.full((4, 8, 3), 0.5))
    up = om.OrthographicCamera((0, 0, 0), (0, 1, 0), up=(0, 0, 1), height=1)
    assert_array_equal(seen(sky, isa, camera=up, size=(4, 4)), 0.5)


# The reference -------------------------------------------------------------------------------------------------------

x, y, z = om.coordinates()
SKIES = {
    "two colours": om.Sky(axis=(1, 2, 3)),
    "unclamped": om.Sky(axis=(1, 2, 3), base=0, clamped=False),
    "gradient": om.GradientSky([(-20, 0.1), (5, (0.9, 0.5, 0.2)), (50, (0.2, 0.4, 0.8))]),
    "environment": om.EnvironmentMap(PICTURE, rotation=10),
    "custom": om.CustomSky((om.noise(4 * x, 4 * y, 4 * z), om.sin(9 * x), om.exp(y - 1))),
}
MAGNIFIED = 2000
"""Units of roundoff: noise, sines and pictures change by some ten times their input, angles count some hundred."""


@pytest.mark.parametrize("name", SKIES)
def test_skies_are_those_of_the_reference(name: str, precision: str):
    """On the best instruction set; see test_lanes.py for the others."""
    scene = om.Scene(NOTHING, sky=SKIES[name])
    truth = om.reference.render(scene, AROUND, SIZE)
    image = om.render(scene, AROUND, SIZE, precision=precision)
    assert_allclose(image.color, truth.color, rtol=0, atol=MAGNIFIED * unit_roundoff(precision))


@pytest.mark.parametrize("name", SKIES)
def test_skies_have_equal_bits_on_all_isas_and_threads(name: str, precision: str):
    scene = om.Scene(NOTHING, sky=SKIES[name])
    expected = om.render(scene, AROUND, SIZE, precision=precision, isa="scalar", threads=1).color
    for isa in om.isas():
        found = om.render(scene, AROUND, SIZE, precision=precision, isa=isa, threads=2).color
        assert_array_equal(found.view(np.uint8), expected.view(np.uint8), isa)
