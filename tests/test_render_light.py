"""Light on surfaces, by hand: Lambert, Phong, shadows, occlusion, sky. And whole pictures against the reference."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import unit_roundoff
from strategies import Array

FLOOR = om.plane()
DULL = om.Material(color=(0.5, 0.25, 0.125), roughness=1, specular=0)
ABOVE = om.OrthographicCamera((0, 8, 0), (0, 0, 0), up=(0, 0, -1), height=8)
EXACT = om.March(epsilon=1e-4, pixel_tolerance=0)  # lest shadow rays start as far off the surface as pixels are large


def shade(shape: om.Shape, isa: str, lights=(), ambient=0.0, precision="float32", **shading) -> tuple[Array, Array]:
    """Colours and positions (24, 24) of a picture taken from straight above."""
    scene = om.Scene(shape, lights=lights, ambient=ambient)
    settings = om.Shading(**{"occlusion": 0, "shadows": "none", **shading})
    options = {"planes": ("color", "position"), "precision": precision, "isa": isa}
    image = om.render(scene, ABOVE, (24, 24), march=EXACT, shading=settings, **options)
    return image.color.astype(np.float64), image.position.astype(np.float64)


def assert_uniform(color: Array, expected, precision: str) -> None:
    """Check a picture of one colour; some ten roundings lie between a light's colour and a pixel's."""
    assert_allclose(color, np.broadcast_to(expected, color.shape), rtol=16 * unit_roundoff(precision))


# On a floor ----------------------------------------------------------------------------------------------------------


def test_directional_light_is_lambert_on_a_dull_floor(isa: str, precision: str):
    lights = [om.DirectionalLight((3, -4, 0), color=(1, 2, 3)), om.DirectionalLight((0, -5, 0), color=0.5)]
    color, _ = shade(FLOOR.paint(DULL), isa, lights, ambient=0.1, precision=precision)
    assert_uniform(color, np.array(DULL.color) * (0.1 + 0.8 * np.array([1, 2, 3]) + 0.5), precision)


@pytest.mark.parametrize("decay", [0, 1, 2])
def test_point_light_falls_with_the_distance(decay: int, isa: str, precision: str):
    lamp = om.PointLight((1, 2, -1), color=10, decay=decay)
    color, position = shade(FLOOR.paint(DULL), isa, [lamp], precision=precision)
    to_lamp = [1, 2, -1] - position - [0, 2 * EXACT.epsilon, 0]
    distance = np.linalg.norm(to_lamp, axis=-1)
    irradiance = 10 * to_lamp[..., 1] / distance ** (decay + 1)
    assert_allclose(color, irradiance[..., None] * DULL.color, rtol=64 * unit_roundoff(precision))


@pytest.mark.parametrize(("metallic", "tint"), [(0, [0.6] * 3), (1, [0.5, 0.25, 0.125]), (0.5, [0.55, 0.425, 0.3625])])
def test_highlight_is_phong_in_the_colour_of_metals_and_white_else(metallic, tint, isa: str, precision: str):
    """Roughness ½ makes the exponent 30; the mirrored light and the way back to the eye enclose the light's angle."""
    material = om.Material(color=(0.5, 0.25, 0.125), roughness=0.5, specular=0.6, metallic=metallic)
    color, _ = shade(FLOOR.paint(material), isa, [om.DirectionalLight((1, -2, 0))], precision=precision)
    cosine = 2 / np.sqrt(5)
    expected = (1 - metallic) * np.array(material.color) * cosine + np.array(tint) * cosine**30
    assert_allclose(color, np.broadcast_to(expected, color.shape), rtol=200 * unit_roundoff(precision))  # 30 in a power


def test_light_from_below_does_not_reach_the_upper_side(isa: str):
    lights = [om.DirectionalLight((0, 1, 0)), om.DirectionalLight((1, 0, 0)), om.PointLight((0, -3, 0))]
    assert_array_equal(shade(FLOOR.paint(DULL), isa, lights)[0], 0)


# Shadows -------------------------------------------------------------------------------------------------------------

CUBE = om.box(1.0, center=(-3, 2, 0))
SLANTED = om.DirectionalLight((1, -1, 0))


def shadow_of(shape: om.Shape, method: str, shadows: str, precision: str = "float64") -> om.Image:
    """Render a floor and what is above it, seen from there and lit from the side by one light."""
    scene = om.Scene(shape.paint(DULL), lights=[om.DirectionalLight((1, -1, 0.2))], ambient=0)
    shading = om.Shading(shadows=shadows, shadow_k=8, occlusion=0)
    march = om.March(method, epsilon=1e-4, pixel_tolerance=0)
    return om.render(scene, ABOVE, (64, 64), planes=("color",), march=march, shading=shading, precision=precision)


CASTERS = [
    pytest.param(FLOOR | om.sphere(0.6, center=(-2, 1.5, 0)), id="ball"),
    pytest.param(FLOOR | om.torus(1.0, 0.2).rotate(70, "x").translate(-1, 1.3, 0), id="torus"),
    pytest.param(FLOOR | (om.box(1.5, center=(-1, 1, 0)) - om.sphere(0.9, center=(-1, 1, 0))), id="carved box"),
]


@pytest.mark.parametrize("shadows", ["hard", "soft"])
@pytest.mark.parametrize("shape", CASTERS)
def test_long_steps_cast_the_shadows_of_plain_ones_with_half_the_work(shape: om.Shape, shadows: str):
    """They are plain in penumbras: what differs is where the samples of these lie."""
    plain, long = (shadow_of(shape, method, shadows) for method in ("plain", "auto"))
    difference = np.abs(plain.color - long.color)[..., 0]
    assert (plain.color[..., 0] < 0.25 * plain.color.max()).mean() > 0.01  # there is a shadow
    assert difference.mean() < 2e-3 * plain.color.max()
    assert (difference > 0.1 * plain.color.max()).mean() < 5e-3
    assert long.stats["stages"]["shadow"]["evaluations"] < 0.6 * plain.stats["stages"]["shadow"]["evaluations"]


@pytest.mark.parametrize("shadows", ["hard", "soft"])
@pytest.mark.parametrize("shape", CASTERS)
def test_shadows_of_long_steps_are_those_of_the_reference(shape: om.Shape, shadows: str):
    """Samples differ by an approximated quotient, so that a few rays that graze an edge may fall on its other side."""
    scene = om.Scene(shape.paint(DULL), lights=[om.DirectionalLight((1, -1, 0.2))], ambient=0)
    options = {
        "march": om.March("enhanced", epsilon=1e-4, pixel_tolerance=0),
        "shading": om.Shading(shadows=shadows, shadow_k=8, occlusion=0),
    }
    fast = om.render(scene, ABOVE, (48, 48), planes=("color",), precision="float64", **options)
    slow = om.reference.render(scene, ABOVE, (48, 48), planes=("color",), dtype="float64", **options)
    difference = np.abs(fast.color - slow.color).max(axis=-1)
    assert np.quantile(difference, 0.99) < 2e-3
    assert (difference > 0.05).mean() < 2e-3


def shadow(isa: str, shape: om.Shape, light, precision="float32", **shading) -> tuple[Array, Array, Array]:
    """Share of light that reaches the floor, and x and z there."""
    lit, position = shade(shape.paint(DULL), isa, [light], precision=precision, **shading)
    bright, _ = shade(FLOOR.paint(DULL), isa, [light], precision=precision)
    floor = np.abs(position[..., 1]) < 1e-3
    return (lit / bright)[floor][:, 0], position[floor][:, 0], position[floor][:, 2]


def test_hard_shadow_of_a_cube_is_its_outline(isa: str, precision: str):
    """From y = 1.5 … 2.5 the cube's points come down at x = -3.5 + 1.5 … -2.5 + 2.5."""
    share, x, z = shadow(isa, FLOOR | CUBE, SLANTED, precision, shadows="hard")
    depth = np.minimum(np.minimum(x + 2, -x), 0.5 - np.abs(z))  # inside the outline where > 0
    assert (depth > 0.05).sum() > 10
    assert_array_equal(share[depth > 0.01], 0)
    assert_allclose(share[depth < -0.01], 1, rtol=16 * unit_roundoff(precision))


@pytest.mark.parametrize("light", [SLANTED, om.PointLight((-8, 7, 0), decay=0)], ids=["directional", "point"])
def test_soft_shadows_lie_between_none_and_hard(light, isa: str):
    hard, *_ = shadow(isa, FLOOR | CUBE, light, shadows="hard")
    softer, *_ = shadow(isa, FLOOR | CUBE, light, shadows="soft", shadow_k=4)
    soft, *_ = shadow(isa, FLOOR | CUBE, light, shadows="soft", shadow_k=16)
    assert ((hard == 0) | (np.abs(hard - 1) < 1e-6)).all()
    for share in (soft, softer):
        assert (share >= 0).all()
        assert (share <= 1 + 1e-6).all()
        assert_array_equal(share[hard == 0], 0)
    for share, pixels in ((soft, 2), (softer, 10)):
        assert ((share > 0.02) & (share < 0.98)).sum() > pixels
    assert (softer <= soft + 1e-6).all()
    assert softer.mean() < soft.mean() < hard.mean()


def test_penumbra_is_as_wide_as_k_says(isa: str):
    """Light straight down past the rim of a disc 2 above: of k times gap over way, the least on the way gets through.

    That is the sine of the angle between light and rim; samples need not fall where it is reached.
    """
    disc = om.cylinder(2.0, height=1e-3, center=(0, 2, 0))
    k = 4.0
    share, x, z = shadow(isa, FLOOR | disc, om.DirectionalLight((0, -1, 0)), shadows="soft", shadow_k=k)
    gap = np.hypot(x, z) - 2
    least = np.minimum(k * gap / np.hypot(2, gap), 1)
    beside = gap > 0.02
    assert ((least > 0.1) & (least < 0.9))[beside].sum() > 10
    assert (share >= least - 0.001)[beside].all()  # what the disc's thickness and the start off the floor change
    assert np.quantile((share - least)[beside], 0.9) < 0.1


def test_nothing_beyond_a_point_light_shades(isa: str):
    lamp = om.PointLight((0, 1, 0), decay=0)
    share, *_ = shadow(isa, FLOOR | om.sphere(0.5, center=(0, 3, 0)), lamp, shadows="hard")
    assert_allclose(share, 1, rtol=1e-6)


# Occlusion -----------------------------------------------------------------------------------------------------------


def test_occlusion_is_none_on_a_plane_and_as_computed_beside_a_wall(isa: str, precision: str):
    samples, reach = 4, 0.8
    occlusion = {"occlusion": samples, "occlusion_distance": reach, "precision": precision}
    plane, _ = shade(FLOOR.paint(DULL), isa, ambient=1.0, **occlusion)
    assert_uniform(plane, DULL.color, precision)
    wall = om.box((2, 6, 100), center=(-3.1, 0, 0))
    corner, position = shade((FLOOR | wall).paint(DULL), isa, ambient=1.0, **occlusion)
    gap = position[..., 0] + 2.1
    i = np.arange(1, samples + 1)
    heights, weights = reach * (i / samples) ** 2, 0.5**i
    above = np.minimum(heights, np.maximum(gap, 0)[..., None])
    expected = 1 - (weights * (heights - above)).sum(-1) / (weights * heights).sum()
    on_floor = gap > 0.01
    share = (corner / np.array(DULL.color))[..., 0]
    assert_allclose(share[on_floor], expected[on_floor], atol=10 * EXACT.epsilon)  # points are 2 epsilon off the floor
    assert share[on_floor].min() < 0.8
    assert_allclose(share[gap > reach], 1, atol=1e-6)


# What is not lit -----------------------------------------------------------------------------------------------------


def test_sky_is_what_its_formula_says(isa: str, precision: str):
    axis = np.array([1, 2, -2]) / 3
    sky = om.Sky(axis=axis * 5, toward=(1, 0, 0.5), away=(0, 1, 0.25), base=(0, 0, 0.25))
    scene = om.Scene(om.sphere(0.1, center=(0, 0, 9)), sky=sky)
    camera = om.Camera((0, 0, 0), (0, 0, -1), fov=90)
    image = om.render(scene, camera, (16, 8), planes=("color", "status"), precision=precision, isa=isa)
    assert_array_equal(image.status, om.Status.MISS)
    x = (2 * (np.arange(16) + 0.5) / 16 - 1) * 2
    y = 1 - 2 * (np.arange(8) + 0.5) / 8
    rays = np.stack([*np.meshgrid(x, y), -np.ones((8, 16))], -1)
    along = (rays @ axis / np.linalg.norm(rays, axis=-1))[..., None]
    assert (along < 0).any()
    expected = np.maximum(along, 0) * sky.toward + np.maximum(-along, 0) * sky.away + sky.base
    assert_allclose(image.color, expected, rtol=0, atol=16 * unit_roundoff(precision))


def test_spent_rays_show_the_surface_before_them_or_the_sky_behind_it(isa: str, precision: str):
    """A candidate counts as seen where its surface faces the ray; past the rim of a ball it does not."""
    sky = om.Sky(toward=0, away=0, base=(0, 0, 9))
    scene = om.Scene(om.sphere(1.0), sky=sky, ambient=1.0)
    camera = om.Camera((0, 0, 4), (0, 0, 0))
    options = {"march": om.March(max_steps=7), "planes": ("color", "status", "normal", "position")}
    image = om.render(scene, camera, (64, 48), precision=precision, isa=isa, **options)
    spent = image.status == om.Status.STEP_LIMIT
    away = ((image.position - np.array([0, 0, 4])) * image.normal).sum(-1) >= 0
    assert (spent & away).sum() > 10
    assert (spent & ~away).sum() > 10
    assert_array_equal(image.color[spent & away], np.broadcast_to([0, 0, 9], ((spent & away).sum(), 3)))
    assert (image.color[spent & ~away] < 9).all()
    assert_allclose(np.linalg.norm(image.normal[spent], axis=-1), 1, atol=1e-6)


# The reference -------------------------------------------------------------------------------------------------------

BLEND = om.sphere(1.0).union(om.box(1.5, center=(0.9, 0.3, 0)), smooth=0.25).paint(om.Material(0.5, roughness=0.2))
TOWER = om.box((4, 12, 4)) - om.box((0.6, 0.8, 0.6)).repeat((1, 1.5, 1)) - om.cylinder(1.2)
RING = om.torus(1, 0.25, axis=(1, 2, 0)).difference(om.box(1.0, center=(1, 0, 0)), smooth=0.1).paint(om.Material(0.3))
LIGHTS = [om.DirectionalLight((-1, -2, -1), 0.8), om.PointLight((3, 4, 2), 20)]
SCENES = {
    "blend": (BLEND | om.plane(point=(0, -1, 0)), om.Camera((3, 2, 4), (0, 0, 0))),
    "tower": (TOWER | om.plane(point=(0, -6, 0)).paint(om.Material(0.6)), om.Camera((9, 4, 12), (0, 0, 0))),
    "ring": (RING | om.capsule((0, -1, 0), (0, 1, 0), 0.2), om.OrthographicCamera((2, 1, 3), (0, 0, 0), height=3)),
}
SHADINGS = {
    "soft": om.Shading(shadows="soft", occlusion=5),
    "hard": om.Shading(shadows="hard", occlusion=0),
    "central": om.Shading(normals="central", shadows="none", occlusion=3),
    "tetrahedron": om.Shading(normals="tetrahedron", shadows="none", occlusion=0),
}
TYPICAL, STEEP = 64, 1e5
"""What a picture magnifies the unit roundoff by, relative to the eye's distance: at the median pixel, where some dozen
roundings add up, and at the 99th percentile, where rays graze or a penumbra is steep."""
TURNED = 0.005
"""Share of pixels that rounding may send to another side of an edge."""


@pytest.mark.parametrize("shading", SHADINGS)
@pytest.mark.parametrize("name", SCENES)
def test_pictures_are_those_of_the_reference(name: str, shading: str, precision: str):
    """By plain steps, which both take to the last rounding. On the best instruction set: test_lanes.py says that the
    others give the same bits.
    """
    shape, camera = SCENES[name]
    scene = om.Scene(shape, lights=LIGHTS, ambient=(0.2, 0.25, 0.3))
    planes = ("color", "depth", "position", "normal", "material_id", "steps", "status")
    march = om.March("plain")
    truth = om.reference.render(scene, camera, (64, 48), planes=planes, march=march, shading=SHADINGS[shading])
    image = om.render(
        scene, camera, (64, 48), planes=planes, march=march, shading=SHADINGS[shading], precision=precision
    )
    for plane in ("status", "material_id", "steps"):
        assert np.mean(getattr(image, plane) != getattr(truth, plane)) <= TURNED, plane
    same = image.status == truth.status
    unit = unit_roundoff(precision) * float(np.linalg.norm(camera.eye))
    for plane in ("color", "depth", "position", "normal"):
        seen = same & np.isfinite(truth.depth) if plane == "depth" else same
        error = np.abs(getattr(image, plane)[seen].astype(np.float64) - getattr(truth, plane)[seen])
        assert np.median(error) <= TYPICAL * unit, plane
        assert np.quantile(error, 0.99) <= STEEP * unit, plane
