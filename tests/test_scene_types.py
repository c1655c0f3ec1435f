"""Materials, lights, skies, cameras, shading and scenes: frozen values that are checked when they are made."""

import copy
import dataclasses
import pickle

import numpy as np
import pytest

import octomarch as om
from octomarch.camera import axes, framing

BALL = om.sphere(1.0)
NAN, INF = float("nan"), float("inf")

VALUES = [
    om.Material(),
    om.DirectionalLight((0, -1, 0)),
    om.PointLight((1, 2, 3)),
    om.SpotLight((1, 2, 3), target=(0, 0.5, 0), softness=0.5),
    om.Sky(),
    om.ConstantSky((0.5, 0.25, 1)),
    om.GradientSky([(-10, 0.1), (0, (0.5, 0.4, 0.3)), (90, 0)], axis=(0, 0, 1)),
    om.Camera((0, 0, 3), (0, 0, 0)),
    om.OrthographicCamera((0, 0, 3), (0, 0, 0)),
    om.March(),
    om.Shading(bounces=3),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_are_frozen_equal_by_content_and_picklable(value):
    name = dataclasses.fields(value)[0].name
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(value, name, 1)
    same = dataclasses.replace(value)
    assert same == value == copy.deepcopy(value) == pickle.loads(pickle.dumps(value))
    assert hash(same) == hash(value)
    assert eval(repr(value), vars(om)) == value


def test_environment_maps_are_equal_by_content_and_picklable():
    picture = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    value = om.EnvironmentMap(picture, rotation=20)
    assert value == om.EnvironmentMap(picture.copy(), 20) == copy.deepcopy(value) == pickle.loads(pickle.dumps(value))
    assert hash(value) == hash(om.EnvironmentMap(picture, 20.0))
    assert value != om.EnvironmentMap(picture + 1, 20)
    assert value != om.EnvironmentMap(picture, 21)
    with pytest.raises(ValueError, match="read-only"):
        value.image[0, 0, 0] = 1
    picture[0, 0, 0] = 7
    assert value.image[0, 0, 0] == 0


def test_custom_skies_are_equal_by_content():
    x, y, _ = om.coordinates()
    assert om.CustomSky((x, y, 1)) == om.CustomSky((x, y, 1)) != om.CustomSky((x, y, 2))
    assert om.CustomSky(0.5) == om.CustomSky((0.5, 0.5, 0.5))


def test_numbers_are_grey_and_vectors_become_tuples_of_floats():
    assert om.Material(color=1).color == (1.0, 1.0, 1.0)
    assert om.Material(color=np.array([0.5, 0.25, 1])).color == (0.5, 0.25, 1.0)
    assert om.DirectionalLight([0, -3, 0], np.float32(2)) == om.DirectionalLight((0.0, -3.0, 0.0), (2.0, 2.0, 2.0))
    assert om.Scene(BALL, ambient=0.5).ambient == (0.5, 0.5, 0.5)


def test_scene_keeps_lights_as_a_tuple():
    sun = om.DirectionalLight((0, -1, 0))
    assert om.Scene(BALL, lights=[sun]).lights == om.Scene(BALL, lights=(light for light in (sun,))).lights == (sun,)
    assert om.Scene(BALL).lights == ()
    assert om.Scene(BALL) == om.Scene(om.sphere(1.0))


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda v: om.Material(color=v), "color"),
        (lambda v: om.Material(color=(0, v, 0)), "color"),
        (lambda v: om.Material(roughness=v), "roughness"),
        (lambda v: om.Material(specular=v), "specular"),
        (lambda v: om.Material(metallic=v), "metallic"),
        (lambda v: om.DirectionalLight((0, -1, 0), v), "color"),
        (lambda v: om.PointLight((0, 1, 0), (v, 1, 1)), "color"),
        (lambda v: om.SpotLight((0, 1, 0), target=(0, 0, 0), color=v), "color"),
        (lambda v: om.SpotLight((0, 1, 0), target=(0, 0, 0), angle=v), "angle"),
        (lambda v: om.SpotLight((0, 1, 0), target=(0, 0, 0), softness=v), "softness"),
        (lambda v: om.Sky(base=v), "base"),
        (lambda v: om.ConstantSky(v), "color"),
        (lambda v: om.GradientSky([(0, 1), (1, v)]), r"the color of stops\[1\]"),
        (lambda v: om.EnvironmentMap(np.ones((1, 2, 3)), intensity=v), "intensity"),
        (lambda v: om.Scene(BALL, ambient=v), "ambient"),
        (lambda v: om.Camera((0, 0, 3), (0, 0, 0), fov=v), "fov"),
        (lambda v: om.OrthographicCamera((0, 0, 3), (0, 0, 0), height=v), "height"),
        (lambda v: om.Shading(normal_step=v), "normal_step"),
        (lambda v: om.Shading(shadow_k=v), "shadow_k"),
        (lambda v: om.Shading(occlusion_distance=v), "occlusion_distance"),
        (lambda v: om.Shading(reflection_cutoff=v), "reflection_cutoff"),
        (lambda v: om.Shading(reflection_offset=v), "reflection_offset"),
    ],
)
@pytest.mark.parametrize("value", [NAN, INF, -1.0], ids=str)
def test_numbers_outside_their_domain_are_named(make, argument, value):
    with pytest.raises(ValueError, match=f"^{argument}.*{value}"):
        make(value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: om.Material(roughness=1.5), r"roughness must lie in \[0, 1\], got 1.5"),
        (lambda: om.Material(color=(1, 2)), r"color must be three numbers, got \(1, 2\)"),
        (lambda: om.DirectionalLight((0, 0, 0)), "direction must not be the zero vector"),
        (lambda: om.DirectionalLight((0, NAN, 0)), "direction must be finite"),
        (lambda: om.PointLight((0, INF, 0)), "position must be finite"),
        (lambda: om.PointLight((0, 1, 0), decay=3), r"decay must lie in \[0, 2\], got 3"),
        (lambda: om.SpotLight((0, 1, 0)), "target or direction must be given, one of them; got none"),
        (lambda: om.SpotLight((0, 1, 0), (0, 0, 0), (0, -1, 0)), "target or direction must be given, one of them"),
        (lambda: om.SpotLight((0, 1, 0), (0, 1, 0)), "target must not be the light's position"),
        (lambda: om.SpotLight((0, 1, 0), direction=(0, 0, 0)), "direction must not be the zero vector"),
        (lambda: om.SpotLight((0, 1, 0), (0, 0, 0), angle=181), r"angle must lie in \[1, 180\], got 181"),
        (lambda: om.Sky(axis=(0, 0, 0)), "axis must not be the zero vector"),
        (lambda: om.GradientSky([]), "stops must hold at least one"),
        (lambda: om.GradientSky([(0, 1), (0, 2)]), r"elevations in stops must rise within \[-90, 90\], got 0.0"),
        (lambda: om.GradientSky([(0, 1), (91, 2)]), r"elevations in stops must rise within \[-90, 90\], got 91.0"),
        (lambda: om.GradientSky([(0, 1, 2)]), r"stops\[0\] must be \(elevation, color\), got \(0, 1, 2\)"),
        (lambda: om.EnvironmentMap(np.ones((4, 4, 4))), r"image must have shape \(height, width, 3\)"),
        (lambda: om.EnvironmentMap(np.ones((4, 8, 3)), rotation=INF), "rotation must be finite"),
        (lambda: om.CustomSky(om.normals()), "color must not look at normals"),
        (lambda: om.CustomSky((1, 2)), "color must have three components"),
        (lambda: om.Camera((1, 2, 3), (1, 2, 3)), "target must differ from eye"),
        (lambda: om.Camera((0, 3, 0), (0, 0, 0)), "up must not be parallel to the view"),
        (lambda: om.Camera((0, 0, 3), (0, 0, 0), up=(0, 0, 0)), "up must not be the zero vector"),
        (lambda: om.Camera((0, NAN, 3), (0, 0, 0)), "eye must be finite"),
        (lambda: om.Camera((0, 0, 3), (0, 0, 0), fov=180), r"fov must lie inside \(0, 180\) degrees, got 180"),
        (lambda: om.Camera((0, 0, 3), (0, 0, 0), fov=0), "fov must lie inside"),
        (lambda: om.OrthographicCamera((0, 3, 0), (0, 0, 0)), "up must not be parallel"),
        (lambda: om.OrthographicCamera((0, 0, 3), (0, 0, 0), height=0), "height must be > 0, got 0"),
        (lambda: om.Shading(normals="tetra"), "normals must be one of 'exact', 'central', 'tetrahedron', got"),
        (lambda: om.Shading(shadows="blurred"), "shadows must be one of 'none', 'hard', 'soft'"),
        (lambda: om.Shading(occlusion=65), "occlusion must lie in"),
        (lambda: om.Shading(bounces=65), r"bounces must lie in \[0, 64\], got 65"),
    ],
)
def test_impossible_values_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: om.Material(color="red"), "color must be three numbers, got 'red'"),
        (lambda: om.Material(roughness="a"), "roughness must be a number, got 'a'"),
        (lambda: om.DirectionalLight(3), "direction must be three numbers, got 3"),
        (lambda: om.PointLight((0, 1, 0), decay=1.5), "decay must be an integer"),
        (lambda: om.Camera("a", (0, 0, 0)), "eye must be three numbers"),
        (lambda: om.Camera({1, 2, 3}, (0, 0, 0)), "eye must be three numbers"),
        (lambda: om.Shading(occlusion=2.5), "occlusion must be an integer"),
        (lambda: om.Shading(bounces=1.5), "bounces must be an integer"),
        (lambda: om.Sky(clamped=1), "clamped must be True or False, got 1"),
        (lambda: om.GradientSky(3), r"stops must be a sequence of \(elevation, color\), got 3"),
        (lambda: om.GradientSky([3]), r"stops\[0\] must be \(elevation, color\), got 3"),
        (lambda: om.EnvironmentMap(3), "image must be a path or an array, got 3"),
        (lambda: om.CustomSky("blue"), "color must be a texture"),
        (lambda: om.Scene(3), r"shape must be an om\.Shape, got 3"),
        (lambda: om.Scene(BALL, sky=3), r"sky must be a sky such as om\.Sky, got 3"),
        (lambda: om.Scene(BALL, lights=[3]), r"lights must be lights such as om\.PointLight, got 3"),
        (lambda: om.Scene(BALL, lights=om.PointLight((0, 1, 0))), "lights must be a sequence of lights"),
    ],
)
def test_wrong_types_are_named(make, message):
    with pytest.raises(TypeError, match=message):
        make()


def test_camera_axes_are_right_handed():
    right, above, along = axes(om.Camera((0, 0, 3), (0, 0, 0)))
    assert right.tolist() == [1, 0, 0]
    assert above.tolist() == [0, 1, 0]
    assert along.tolist() == [0, 0, -1]


@pytest.mark.parametrize("size", [(640, 480), (100, 400), (400, 100)], ids=str)
@pytest.mark.parametrize(
    "shape",
    [BALL, om.box((4, 0.5, 1)), om.sphere(2e-3, center=(1e3, 5, 0)), om.sphere(0.0), om.plane(), BALL | om.plane()],
    ids=["ball", "bar", "tiny and far", "point", "plane", "ball on a plane"],
)
def test_framing_holds_the_focus(shape, size):
    program = om.compile(shape)
    camera = framing(program, size)
    basis = np.stack(axes(camera))
    lo, hi = program.focus or ((-0.5,) * 3, (0.5,) * 3)
    corners = np.array(
        [[(lo, hi)[i][0], (lo, hi)[j][1], (lo, hi)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )
    x, y, z = ((corners - camera.eye) @ basis.T).T
    tangent = np.tan(np.radians(camera.fov / 2))
    inside = np.maximum(np.abs(x) / (z * tangent * size[0] / size[1]), np.abs(y) / (z * tangent))
    assert z.min() > 0
    assert inside.max() <= 1
    assert inside.max() > 0.85 or lo == hi


def test_orthographic_rays_start_in_the_plane_of_the_eye():
    origins = om.OrthographicCamera((0, 0, 5), (0, 0, 0), height=4)._ray_origins((200, 100))
    assert sorted(map(tuple, origins)) == [(-4, -2, 5), (-4, 2, 5), (4, -2, 5), (4, 2, 5)]
