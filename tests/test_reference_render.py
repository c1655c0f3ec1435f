"""Pictures by the scalar reference against optics worked out by hand: cameras, lights, shadows, occlusion, sky."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om

ROUNDING = 1e-9  # of hits on planes after the secant finish, relative to a few units
FLOOR = om.plane()
ABOVE = om.Camera(eye=(0, 4, 0), target=(0, 0, 0), up=(0, 0, -1), fov=60)
DULL = om.Material(color=(0.5, 0.25, 0.125), roughness=1, specular=0)
FLAT = om.Shading(occlusion=0, shadows="none")


def shade(
    shape: om.Shape,
    lights: Sequence[om.DirectionalLight | om.PointLight] = (),
    camera: om.Camera | om.OrthographicCamera = ABOVE,
    ambient: float = 0.0,
    **shading: object,
) -> NDArray[np.float64]:
    """Colours of 5 × 5 pixels."""
    scene = om.Scene(shape, lights=lights, ambient=ambient)
    settings = om.Shading(**{"occlusion": 0, "shadows": "none", **shading})
    march = om.March(pixel_tolerance=0)  # lest shadow rays start as far off the surface as pixels are large
    return om.reference.render(scene, camera, (5, 5), march=march, shading=settings).color


def test_perspective_rays_run_through_pixel_centres():
    image = om.reference.render(FLOOR, ABOVE, (8, 4), planes=("position", "depth", "normal"))
    half = 4 * np.tan(np.radians(30))
    x = (2 * (np.arange(8) + 0.5) / 8 - 1) * 2 * half
    z = -(1 - 2 * (np.arange(4) + 0.5) / 4) * half  # up in the picture is -z
    expected = np.stack([*np.meshgrid(x, z)], -1)
    assert_allclose(image.position[..., [0, 2]], expected, atol=ROUNDING)
    assert_allclose(image.depth, np.sqrt((expected**2).sum(-1) + 16), atol=ROUNDING)
    assert_allclose(image.normal, np.broadcast_to([0, 1, 0], (4, 8, 3)))


def test_orthographic_rays_are_parallel():
    camera = om.OrthographicCamera(eye=(0, 4, 0), target=(0, 0, 0), up=(0, 0, -1), height=2)
    image = om.reference.render(FLOOR, camera, (4, 2), planes=("position", "depth"))
    assert_allclose(image.depth, 4)
    assert_allclose(image.position[:, :, 0], [[-1.5, -0.5, 0.5, 1.5]] * 2, atol=ROUNDING)
    assert_allclose(image.position[:, :, 2], [[-0.5] * 4, [0.5] * 4], atol=ROUNDING)


def test_directional_light_is_lambert_on_a_dull_floor():
    color = shade(FLOOR.paint(DULL), [om.DirectionalLight((3, -4, 0), color=(1, 2, 3))], ambient=0.1)
    assert_allclose(color, np.broadcast_to(np.array(DULL.color) * (0.1 + 0.8 * np.array([1, 2, 3])), (5, 5, 3)))


@pytest.mark.parametrize("decay", [0, 1, 2])
def test_point_light_falls_with_the_distance(decay: int):
    color = shade(FLOOR.paint(DULL), [om.PointLight((0, 2, 0), color=10, decay=decay)])
    assert_allclose(color[2, 2], np.array(DULL.color) * 10 / 2**decay, rtol=1e-4)  # the origin is offset by 2 epsilon


@pytest.mark.parametrize(("metallic", "highlight"), [(0, [0.6] * 3), (1, [0.5, 0.25, 0.125])])
def test_highlight_is_phong_in_the_colour_of_metals_and_white_else(metallic: float, highlight: list[float]):
    material = om.Material(color=(0.5, 0.25, 0.125), roughness=0.5, specular=0.6, metallic=metallic)
    light = om.DirectionalLight((1, -2, 0))
    color = shade(FLOOR.paint(material), [light])
    cosine = 2 / np.sqrt(5)  # with the normal, and of the mirrored ray with the ray back to the eye above
    diffuse = (1 - metallic) * np.array(material.color) * cosine
    assert_allclose(color[2, 2], diffuse + np.array(highlight) * cosine**30, rtol=1e-6)


def test_light_from_below_does_not_reach_the_upper_side():
    assert_array_equal(shade(FLOOR.paint(DULL), [om.DirectionalLight((0, 1, 0)), om.PointLight((0, -3, 0))]), 0)


@pytest.mark.parametrize("light", [om.DirectionalLight((2, -2, 0)), om.PointLight((-6, 6, 0), decay=0)])
def test_shadows_darken_what_a_ball_covers(light: om.DirectionalLight | om.PointLight):
    shape = (FLOOR | om.sphere(0.5).translate(-2, 2, 0)).paint(DULL)
    none, hard, soft = (shade(shape, [light], shadows=kind)[2, 2, 0] for kind in ("none", "hard", "soft"))
    assert none > 0.3
    assert hard == soft == 0
    lit = [shade(shape, [light], shadows=kind)[4, 4, 0] for kind in ("none", "hard")]
    assert lit[0] == lit[1] > 0


def test_soft_shadows_have_a_penumbra_as_wide_as_k_says():
    # The light comes straight down past the ball's rim, 0.02 away from it: visibility k·0.02/2 at the equator's height.
    shape = (FLOOR | om.sphere(0.5).translate(-0.52, 2, 0)).paint(DULL)
    down = [om.DirectionalLight((0, -1, 0))]
    camera = om.Camera(eye=(0.5, 1, 0), target=(0, 0, 0))
    soft = [shade(shape, down, camera, shadows="soft", shadow_k=k)[2, 2, 0] / 0.5 for k in (8, 32)]
    assert_allclose(soft, [0.08, 0.32], rtol=0.1)  # samples need not fall on the nearest point


def test_a_light_beyond_nothing_is_not_hidden_by_what_lies_behind_it():
    shape = (FLOOR | om.sphere(0.5).translate(0, 9, 0)).paint(DULL)
    lamp = [om.PointLight((0, 3, 0), decay=0)]
    assert_allclose(shade(shape, lamp, shadows="hard")[2, 2], DULL.color, rtol=1e-4)


def test_occlusion_is_nothing_on_a_floor_and_as_computed_beside_a_wall():
    def ambient_light(distance_of_wall: float) -> float:
        wall = om.plane(normal=(1, 0, 0), point=(-distance_of_wall, 0, 0))
        color = shade((FLOOR | wall).paint(DULL), ambient=1.0, occlusion=4, occlusion_distance=0.8)
        return float(color[2, 2, 0] / DULL.color[0])

    heights, weights = 0.8 * (np.arange(1, 5) / 4) ** 2, 0.5 ** np.arange(1, 5)
    missing = np.maximum(heights - np.minimum(heights, 0.3), 0)
    expected = 1 - (weights * missing).sum() / (weights * heights).sum()
    assert_allclose([ambient_light(5), ambient_light(0.3)], [1, expected], rtol=1e-4)


def test_sky_shows_where_nothing_is_met():
    sky = om.Sky(axis=(0, 2, 0), toward=(1, 0, 0), away=(0, 1, 0), base=(0, 0, 0.25))
    scene = om.Scene(om.sphere(0.1).translate(0, 0, 9), sky=sky)
    up, down = (om.reference.render(scene, om.Camera((0, 0, 0), (0, y, -1)), (1, 1)).color[0, 0] for y in (0.75, -0.75))
    assert_allclose([up, down], [(0.6, 0, 0.25), (0, 0.6, 0.25)])


def test_rays_from_inside_are_black_and_say_so():
    image = om.reference.render(om.sphere(2.0), om.Camera((0, 0, 1), (0, 0, 0)), (3, 2), planes=("color", "status"))
    assert_array_equal(image.color, 0)
    assert_array_equal(image.status, om.Status.INSIDE)


def test_central_normals_are_near_exact_ones():
    shape = om.torus(1.0, 0.4).union(om.box(1.0), smooth=0.3)
    exact, central = (
        om.reference.render(shape, size=(24, 18), planes=("normal",), shading=om.Shading(normals=kind)).normal
        for kind in ("exact", "central")
    )
    assert np.quantile(np.abs(exact - central).max(axis=-1), 0.95) < 1e-4  # all but the pixels on creases
    assert (exact != central).any()


def test_a_picture_has_the_planes_asked_for_in_the_precision_asked_for():
    image = om.reference.render(om.sphere(1.0), size=(4, 3), planes=("depth", "material_id"), dtype="float32")
    assert image.planes == ("depth", "material_id")
    assert image.depth.dtype == np.float32
    assert image.metadata["render"]["renderer"] == "reference"
    with pytest.raises(AttributeError, match="color was not rendered"):
        _ = image.color
    with pytest.raises(ValueError, match="planes must be one of"):
        om.reference.render(om.sphere(1.0), planes=("object_id",))
    with pytest.raises(ValueError, match="size"):
        om.reference.render(om.sphere(1.0), size=(0, 3))


SPOT = {"position": (0, 2, 0), "direction": (0, -1, 0), "color": 8, "decay": 0}


@pytest.mark.parametrize("softness", [0.25, 1.0])
def test_spot_light_fades_towards_the_edge_of_its_cone(softness: float):
    camera = om.OrthographicCamera((0, 4, 0), (0, 0, 0), up=(0, 0, -1), height=4)
    scene = om.Scene(FLOOR.paint(DULL), lights=[om.SpotLight(**SPOT, angle=60, softness=softness)], ambient=0)
    march = om.March(pixel_tolerance=0)
    image = om.reference.render(scene, camera, (9, 9), march, shading=FLAT, planes=("color", "position"))
    cosine = 2 / np.sqrt((image.position**2).sum(-1) + 4)
    inner, outer = np.cos(np.radians(30 * (1 - softness))), np.cos(np.radians(30))
    x = np.clip((cosine - outer) / (inner - outer), 0, 1)
    expected = (8 * x * x * (3 - 2 * x) * cosine)[..., None] * DULL.color
    assert_allclose(image.color, expected, rtol=0, atol=1e-4)  # light is looked for 2 epsilon above the floor
    assert (expected == 0).any()


def mirror(reflectivity: float) -> om.Material:
    return om.Material(0.5, reflectivity=reflectivity)


@pytest.mark.parametrize("bounces", [0, 1, 5])
def test_a_mirror_mixes_its_own_colour_with_the_sky(bounces: int):
    scene = om.Scene(FLOOR.paint(mirror(0.25)), sky=om.Sky(toward=(1, 2, 3), away=9, base=0), ambient=1)
    camera = om.Camera((0, 3, 4), (0, 0, 0), fov=20)
    image = om.reference.render(
        scene, camera, (5, 5), shading=om.Shading(occlusion=0, bounces=bounces), planes=("color", "position")
    )
    towards = image.position - camera.eye
    upward = -towards[..., 1] / np.sqrt((towards**2).sum(-1))
    expected = 0.75 * 0.5 + 0.25 * upward[..., None] * [1, 2, 3] if bounces else np.full((5, 5, 3), 0.5)
    assert_allclose(image.color, expected, rtol=1e-9)


def test_each_bounce_weighs_what_the_mirrors_before_it_say():
    facing = om.plane((0, 0, 1), (0, 0, -1)).paint(mirror(0.5)) | om.plane((0, 0, -1), (0, 0, 1)).paint(mirror(0.25))
    scene, camera = om.Scene(facing, ambient=1), om.OrthographicCamera((0, 0, 0), (0, 0, -1), height=0.1)
    for bounces, cutoff in ((0, 0), (1, 0), (4, 0), (9, 0.05)):
        shading = om.Shading(occlusion=0, shadows="none", bounces=bounces, reflection_cutoff=cutoff)
        expected, weight = 0.0, 1.0
        for i in range(bounces + 1):
            reflected = weight * (0.5, 0.25)[i % 2]
            last = i == bounces or reflected < cutoff
            expected += 0.5 * (weight if last else weight - reflected)
            if last:
                break
            weight = reflected
        color = om.reference.render(scene, camera, (1, 1), shading=shading).color
        assert_allclose(color, np.full((1, 1, 3), expected), rtol=1e-12)
