"""Reflections: what plane mirrors show, how bounces are weighted and when they end; and pictures of the reference."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import unit_roundoff
from strategies import Array

EXACT = om.March(epsilon=1e-4, pixel_tolerance=0)
FLAT = {"occlusion": 0, "shadows": "none"}
GLOW = om.ConstantSky((0.25, 0.5, 1))


def mirror(reflectivity: float, color=0.5) -> om.Material:
    return om.Material(color, reflectivity=reflectivity)


def picture(shape: om.Shape, camera, isa: str, sky=GLOW, precision="float32", size=(24, 24), **shading) -> om.Image:
    """Render a picture in which ambient light of strength 1 gives every surface its own colour."""
    scene = om.Scene(shape, sky=sky, ambient=1)
    settings = om.Shading(**{**FLAT, **shading})
    planes = ("color", "position", "object_id", "status")
    return om.render(scene, camera, size, march=EXACT, shading=settings, planes=planes, precision=precision, isa=isa)


# Plane mirrors -------------------------------------------------------------------------------------------------------

DOWN = om.OrthographicCamera((0, 5, 0), (0, 0, 0), up=(0, 0, -1), height=4)
SLANTED = om.Camera((0, 2, 5), (0, 0, 0))


@pytest.mark.parametrize("share", [0.25, 0.5, 1.0])
def test_a_mirror_mixes_its_colour_with_the_sky(share: float, isa: str, precision: str):
    image = picture(om.plane().paint(mirror(share, (0.5, 0.25, 0))), DOWN, isa, precision=precision, bounces=1)
    expected = (1 - share) * np.array([0.5, 0.25, 0]) + share * np.array(GLOW.color)
    assert_allclose(image.color, np.broadcast_to(expected, (24, 24, 3)), rtol=4 * unit_roundoff(precision))


def test_mirrors_obey_the_law_of_reflection(isa: str, precision: str):
    """Over a floor that mirrors all, each pixel shows the sky in its ray's direction with y turned over."""
    x, y, z = om.coordinates()
    image = picture(om.plane().paint(mirror(1)), SLANTED, isa, om.CustomSky((x + 1, y, z + 1)), precision, bounces=1)
    hit = image.status == om.Status.HIT
    way = image.position[hit].astype(np.float64) - SLANTED.eye
    way /= np.linalg.norm(way, axis=-1, keepdims=True)
    assert hit.sum() > 100
    assert_allclose(image.color[hit], way * [1, -1, 1] + [1, 0, 1], rtol=0, atol=64 * unit_roundoff(precision))


def test_mirrors_show_what_stands_before_them(isa: str):
    """A ball over a mirror floor appears again as far below it, as a camera below would see it."""
    ball = om.sphere(0.5, center=(0, 1, 0)).paint(om.Material((1, 0, 0)))
    image = picture(om.plane().paint(mirror(1)) | ball, SLANTED, isa, om.ConstantSky(0), bounces=1, size=(48, 48))
    twin = picture(om.sphere(0.5, center=(0, -1, 0)), SLANTED, isa, size=(48, 48))
    floor = image.object_id == 0
    reflected = floor & (image.color[..., 0] > 0.5)
    expected = floor & (twin.status == om.Status.HIT)
    assert expected.sum() > 50
    assert (reflected != expected).mean() < 0.01  # mirror rays leave from 1e-3 above the floor


def test_reflected_surfaces_are_lit_like_others(isa: str):
    """A floor that mirrors all shows the underside of a slab as bright as the lamp below it makes it."""
    slab = om.box((40, 1, 40), center=(0, 8.5, 0)).paint(om.Material((0.5, 0.25, 1), specular=0))
    lamp = om.PointLight((0, 2, 0), color=36)
    scene = om.Scene(om.plane().paint(mirror(1, 0)) | slab, lights=[lamp], ambient=0)
    settings = om.Shading(occlusion=0, shadows="hard", bounces=1)
    above = om.OrthographicCamera((0, 4, 0), (0, 0, 0), up=(0, 0, 1), height=0.1)
    image = om.render(scene, above, (9, 9), march=EXACT, shading=settings, isa=isa)
    assert_allclose(image.color, np.broadcast_to([0.5, 0.25, 1], (9, 9, 3)), rtol=1e-3)  # 6 above the lamp


# Bounces -------------------------------------------------------------------------------------------------------------

FACING = om.plane((0, 1, 0)).paint(mirror(0.5, 1.0)) | om.plane((0, -1, 0), (0, 4, 0)).paint(mirror(0.5, 1.0))
BETWEEN = om.OrthographicCamera((0, 2, 0), (0, 0, 0), up=(0, 0, -1), height=1)


@pytest.mark.parametrize("bounces", [0, 1, 2, 3, 8])
def test_facing_mirrors_reflect_as_often_as_bounces_say(bounces: int, isa: str, precision: str):
    image = picture(FACING, BETWEEN, isa, precision=precision, size=(8, 8), bounces=bounces, reflection_cutoff=0)
    assert_array_equal(image.color, 1)  # shares of 1/2, 1/4 … and the rest of a white last one
    assert image.stats["stages"]["reflection"]["count"] == 64 * bounces


def test_each_bounce_is_weighted_by_the_reflectivities_before(isa: str, precision: str):
    """Floor: a quarter mirror, dark; ceiling: half a mirror, bright; then the floor again, unweighted."""
    dark, bright = mirror(0.25, 0.125), mirror(0.5, 2.0)
    room = om.plane((0, 1, 0)).paint(dark) | om.plane((0, -1, 0), (0, 4, 0)).paint(bright)
    found = picture(room, BETWEEN, isa, precision=precision, size=(4, 4), bounces=2).color
    assert_array_equal(found, 0.75 * 0.125 + 0.25 * (0.5 * 2 + 0.5 * 0.125))


@pytest.mark.parametrize(("cutoff", "rays"), [(0.3, 1), (0.25, 2), (0.2, 2), (0.125, 3), (0.51, 0)])
def test_reflections_below_the_cutoff_are_not_followed(cutoff: float, rays: int, isa: str):
    image = picture(FACING, BETWEEN, isa, size=(8, 8), bounces=8, reflection_cutoff=cutoff)
    assert image.stats["stages"]["reflection"]["count"] == 64 * rays
    assert_array_equal(image.color, 1)


def test_mirror_rays_do_not_hit_what_they_leave(isa: str, precision: str):
    """On a ball, at all angles of incidence, every mirror ray sees the sky, whatever the offset."""
    ball = om.sphere(1.0).paint(mirror(1, 0))
    for offset in (0, 1e-3, 0.1):
        camera = om.Camera((0, 0, 3), (0, 0, 0))
        image = picture(ball, camera, isa, om.ConstantSky(1), precision, (64, 64), bounces=1, reflection_offset=offset)
        assert_array_equal(image.color, 1)


def test_an_offset_lifts_mirror_rays_over_what_is_near(isa: str):
    """A slab floats 0.05 above the floor, beneath the camera: mirror rays from 0.01 hit it, from 0.2 they pass it."""
    slab = om.box((9, 0.02, 9), center=(0, 0.06, 0)).paint(om.Material(1.0))
    through = om.Camera((0, 0.03, 0), (0, 0, -0.3), up=(0, 1, 0))
    room = om.plane().paint(mirror(1, 0)) | slab
    low = picture(room, through, isa, om.ConstantSky(0), bounces=1, reflection_offset=0.01, size=(5, 5))
    high = picture(room, through, isa, om.ConstantSky(0), bounces=1, reflection_offset=0.2, size=(5, 5))
    assert (low.color[2, 2] == 1).all()
    assert (high.color[2, 2] == 0).all()


def test_reflectivity_may_change_from_point_to_point(isa: str):
    x, _, _ = om.coordinates()
    half = om.Material(0.5, reflectivity=om.where(x < 0, 1.0, 0.0))
    image = picture(om.plane().paint(half), DOWN, isa, om.ConstantSky(0.75), bounces=1)
    left = image.position[..., 0] < 0
    assert_array_equal(image.color[left], 0.75)
    assert_array_equal(image.color[~left], 0.5)
    assert image.stats["stages"]["reflection"]["count"] == left.sum()


def test_reflectivities_beyond_their_range_are_clamped(isa: str):
    for value, expected in ((7.0, 0.75), (-3.0, 0.5)):
        x, _, _ = om.coordinates()
        material = om.Material(0.5, reflectivity=om.where(x < 99, value, 0.0))
        image = picture(om.plane().paint(material), DOWN, isa, om.ConstantSky(0.75), bounces=1)
        assert_array_equal(image.color, expected)


# Whole pictures ------------------------------------------------------------------------------------------------------

ROOM = om.union(
    om.sphere(1.0).union(om.box(1.5, center=(0.9, 0.3, 0)), smooth=0.25).paint(om.Material(0.5, reflectivity=0.4)),
    om.sphere(0.6, center=(-1.6, -0.4, 0.4)).paint(om.Material((0.8, 0.6, 0.2), metallic=1, reflectivity=0.7)),
    om.plane(point=(0, -1, 0)).paint(om.Material(om.checker(0.2, 0.8), reflectivity=0.2)),
)
LIGHTS = [om.DirectionalLight((-1, -2, -1), 0.8), om.SpotLight((3, 4, 2), target=(0, 0, 0), color=20)]
SCENE = om.Scene(ROOM, lights=LIGHTS, ambient=(0.2, 0.25, 0.3))
CAMERA = om.Camera((3, 2, 4), (0, 0, 0))
OPTIONS = {"march": om.March("plain"), "shading": om.Shading(bounces=3), "planes": ("color",)}


def test_reflections_have_equal_bits_on_all_isas_and_threads(precision: str):
    options = {**OPTIONS, "precision": precision}
    expected = om.render(SCENE, CAMERA, (80, 60), isa="scalar", threads=1, **options).color
    for isa in om.isas():
        for threads in (1, 2):
            found = om.render(SCENE, CAMERA, (80, 60), isa=isa, threads=threads, **options).color
            assert_array_equal(found, expected, f"{isa}, {threads} threads")


def test_crops_of_reflections_have_the_bits_of_the_whole():
    whole = om.render(SCENE, CAMERA, (80, 60), **OPTIONS).color
    part = om.render(SCENE, CAMERA, (80, 60), crop=(33, 21, 19, 7), **OPTIONS).color
    assert_array_equal(part, whole[21:28, 33:52])


TYPICAL, STEEP, TURNED = 128, 2e5, 0.03
"""As in test_render_light.py, with what curved mirrors magnify; and the share of pixels near edges in mirrors."""


def test_reflections_are_those_of_the_reference(precision: str):
    truth = om.reference.render(SCENE, CAMERA, (64, 48), **OPTIONS).color
    found = om.render(SCENE, CAMERA, (64, 48), precision=precision, **OPTIONS).color.astype(np.float64)
    error = np.abs(found - truth).max(axis=-1)
    unit = unit_roundoff(precision) * float(np.linalg.norm(CAMERA.eye))
    assert np.median(error) <= TYPICAL * unit
    assert np.quantile(error, 1 - TURNED) <= STEEP * unit


def test_counts_of_reflections_are_those_of_their_rays(isa: str):
    stats = om.render(SCENE, CAMERA, (80, 60), isa=isa, **OPTIONS).stats
    assert 0 < stats["stages"]["reflection"]["count"] < 3 * stats["rays"]
    assert stats["stages"]["reflection"]["evaluations"] >= stats["stages"]["reflection"]["count"]
    cast = sum(stats["stages"][name]["count"] for name in ("primary", "shadow", "reflection"))
    assert stats["packets"] * 8 >= cast
    assert stats["seconds_reflect"] > 0


def test_colours_beyond_float32_give_no_nan(isa: str):
    huge = om.Material(1e30, reflectivity=0.5)
    scene = om.Scene(om.plane().paint(huge), lights=[om.DirectionalLight((0, -1, 0), 1e30)], ambient=1e30)
    color: Array = om.render(scene, SLANTED, (16, 12), shading=om.Shading(bounces=1), isa=isa).color
    assert np.isfinite(color).all()
