"""Spot lights: their cone, its soft edge, their fall with the distance and their shadows, by hand."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from rounding import unit_roundoff
from strategies import Array

DULL = om.Material(1.0, specular=0)
FLOOR = om.plane().paint(DULL)
ABOVE = om.OrthographicCamera((0, 9, 0), (0, 0, 0), up=(0, 0, -1), height=8)
EXACT = om.March(epsilon=1e-4, pixel_tolerance=0)  # shadow rays leave from 2 epsilon above
LAMP = np.array([0.5, 2.0, -0.25])
AIM = np.array([1.0, -4.0, 0.5])


def lit(light, isa: str, shape: om.Shape = FLOOR, precision: str = "float32", **shading) -> tuple[Array, Array]:
    """Return colours (24, 24) and positions (24, 24, 3) of a floor seen from straight above."""
    settings = om.Shading(**{"occlusion": 0, "shadows": "none", **shading})
    scene = om.Scene(shape, lights=[light], ambient=0)
    options = {"planes": ("color", "position"), "precision": precision, "isa": isa}
    image = om.render(scene, ABOVE, (24, 24), march=EXACT, shading=settings, **options)
    return image.color[..., 0].astype(np.float64), image.position.astype(np.float64)


def to_lamp(position: Array) -> tuple[Array, Array, Array]:
    """Return distance to the lamp, cosine at the floor, and cosine of the angle from the middle of the cone."""
    way = LAMP - position - [0, 2 * EXACT.epsilon, 0]
    distance = np.linalg.norm(way, axis=-1)
    return distance, way[..., 1] / distance, -(way @ AIM) / np.linalg.norm(AIM) / distance


@pytest.mark.parametrize("softness", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("decay", [0, 2])
def test_cones_are_smoothsteps_of_the_cosine(softness: float, decay: int, isa: str, precision: str):
    spot = om.SpotLight(LAMP, direction=3 * AIM, color=5, angle=70, softness=softness, decay=decay)
    color, position = lit(spot, isa, precision=precision)
    distance, at_floor, off_middle = to_lamp(position)
    outer, inner = np.cos(np.radians(35)), np.cos(np.radians(35 * (1 - softness)))
    x = np.clip((off_middle - outer) / (inner - outer), 0, 1)
    expected = 5 * x * x * (3 - 2 * x) * at_floor / distance**decay
    assert (expected == 0).any()
    assert ((x > 0) & (x < 1)).any()
    roundings = 64 / (inner - outer)  # an error of the cosine is magnified by the smoothstep's slope
    assert_allclose(color, expected, rtol=0, atol=5 * roundings * unit_roundoff(precision))


def test_hard_edges_are_hard(isa: str):
    color, position = lit(om.SpotLight(LAMP, direction=AIM, angle=70, softness=0, decay=0), isa)
    _, at_floor, off_middle = to_lamp(position)
    angle = np.degrees(np.arccos(off_middle))
    assert_array_equal(color[angle > 35], 0)
    inside = angle < 34.9
    assert_allclose(color[inside], at_floor[inside], rtol=1e-5)


def test_a_target_is_a_direction():
    assert om.SpotLight((1, 2, 3), target=(1, 0, 4)) == om.SpotLight((1, 2, 3), direction=(0, -2, 1))


def test_in_the_middle_a_spot_is_a_point_light(isa: str):
    narrow = om.SpotLight(LAMP, direction=AIM, color=(1, 2, 3), angle=90, softness=0.5)
    spot, position = lit(narrow, isa)
    point, _ = lit(om.PointLight(LAMP, color=(1, 2, 3)), isa)
    middle = to_lamp(position)[2] > np.cos(np.radians(22))
    assert middle.sum() > 10
    assert_array_equal(spot[middle], point[middle])


def test_spots_cast_shadows(isa: str):
    ball = om.sphere(0.3, center=LAMP + 0.25 * AIM)
    spot = om.SpotLight(LAMP, direction=AIM, angle=90, decay=0)
    free, position = lit(spot, isa)
    color, seen = lit(spot, isa, FLOOR | ball.paint(DULL), shadows="hard")
    floor = np.abs(seen[..., 1]) < 1e-3
    way = position - LAMP
    along = way @ AIM / (AIM @ AIM)
    off_axis = np.linalg.norm(way / along[..., None] * 0.25 - 0.25 * AIM, axis=-1)
    shaded, open_ = floor & (along > 0.25) & (off_axis < 0.25), floor & (off_axis > 0.6) & (free > 0)
    assert shaded.sum() > 5
    assert open_.sum() > 5
    assert_array_equal(color[shaded], 0)
    assert_array_equal(color[open_], free[open_])


def test_lights_of_all_kinds_add_up(isa: str, precision: str):
    lights = [
        om.DirectionalLight((1, -2, 0), 0.5),
        om.PointLight((0, 3, 0), 2),
        om.SpotLight(LAMP, direction=AIM, color=4),
        om.SpotLight((0, 3, 0), target=(-1, 0, 0), color=3, angle=20),
    ]
    settings = om.Shading(occlusion=0, shadows="none")
    options = {"march": EXACT, "shading": settings, "precision": precision, "isa": isa}
    scene = om.Scene(FLOOR, lights=lights, ambient=0.125)
    together = om.render(scene, ABOVE, (24, 24), **options).color[..., 0]
    single = [lit(light, isa, precision=precision)[0] for light in lights]
    total = 0.125 + sum(single)
    assert_allclose(together, total, rtol=8 * unit_roundoff(precision))
