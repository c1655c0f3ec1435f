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
    om.Sky(),
    om.Camera((0, 0, 3), (0, 0, 0)),
    om.OrthographicCamera((0, 0, 3), (0, 0, 0)),
    om.March(),
    om.Shading(),
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
        (lambda v: om.Sky(base=v), "base"),
        (lambda v: om.Scene(BALL, ambient=v), "ambient"),
        (lambda v: om.Camera((0, 0, 3), (0, 0, 0), fov=v), "fov"),
        (lambda v: om.OrthographicCamera((0, 0, 3), (0, 0, 0), height=v), "height"),
        (lambda v: om.Shading(normal_step=v), "normal_step"),
        (lambda v: om.Shading(shadow_k=v), "shadow_k"),
        (lambda v: om.Shading(occlusion_distance=v), "occlusion_distance"),
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
        (lambda: om.Sky(axis=(0, 0, 0)), "axis must not be the zero vector"),
        (lambda: om.Camera((1, 2, 3), (1, 2, 3)), "target must differ from eye"),
        (lambda: om.Camera((0, 3, 0), (0, 0, 0)), "up must not be parallel to the view"),
        (lambda: om.Camera((0, 0, 3), (0, 0, 0), up=(0, 0, 0)), "up must not be the zero vector"),
        (lambda: om.Camera((0, NAN, 3), (0, 0, 0)), "eye must be finite"),
        (lambda: om.Camera((0, 0, 3), (0, 0, 0), fov=180), r"fov must lie inside \(0, 180\) degrees, got 180"),
        (lambda: om.Camera((0, 0, 3), (0, 0, 0), fov=0), "fov must lie inside"),
        (lambda: om.OrthographicCamera((0, 3, 0), (0, 0, 0)), "up must not be parallel"),
        (lambda: om.OrthographicCamera((0, 0, 3), (0, 0, 0), height=0), "height must be > 0, got 0"),
        (lambda: om.Shading(normals="tetra"), "normals must be one of 'exact', 'central', got 'tetra'"),
        (lambda: om.Shading(shadows="blurred"), "shadows must be one of 'none', 'hard', 'soft'"),
        (lambda: om.Shading(occlusion=65), "occlusion must lie in"),
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
        (lambda: om.Scene(3), r"shape must be an om\.Shape, got 3"),
        (lambda: om.Scene(BALL, sky=3), r"sky must be an om\.Sky, got 3"),
        (lambda: om.Scene(BALL, lights=[3]), r"lights must be om\.DirectionalLight or om\.PointLight, got 3"),
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
