"""Rays cast from numpy arrays: shapes, planes asked for, limits and what is said about bad ones."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om

BALL = om.sphere(1.0)


def test_hits_have_the_broadcast_shape_of_rays():
    origins = np.broadcast_to([0, 0, 3], (4, 1, 3))
    directions = np.broadcast_to([0, 0, -1], (5, 3))
    hits = BALL.raycast(origins, directions)
    assert hits.t.shape == hits.status.shape == (4, 5)
    assert hits.position.shape == hits.normal.shape == (4, 5, 3)
    assert_array_equal(hits.t, 2.0)
    assert repr(hits) == "<Hits of shape (4, 5): t, position, normal, object_id, material_id, steps, status>"


def test_one_ray_gives_scalars_and_no_ray_none():
    assert BALL.raycast([0, 0, 3], [0, 0, -1]).t.shape == ()
    empty = BALL.raycast(np.empty((0, 3)), [0, 0, -1])
    assert empty.t.shape == (0,)
    assert empty.normal.shape == (0, 3)


def test_planes_have_documented_types():
    hits = BALL.raycast([0, 0, 3], [0, 0, -1], precision="float32")
    types = {
        name: getattr(hits, name).dtype.name for name in ("t", "position", "normal", "object_id", "steps", "status")
    }
    assert types == {
        "t": "float32",
        "position": "float32",
        "normal": "float32",
        "object_id": "int32",
        "steps": "int32",
        "status": "uint8",
    }


def test_t_counts_in_the_length_of_the_direction():
    hits = BALL.raycast([0, 0, 3], [[0, 0, -1], [0, 0, -2], [0, 0, -0.25]])
    assert_allclose(hits.t, [2, 1, 8])
    assert_allclose(hits.position, [[0, 0, 1]] * 3)


def test_misses_hold_infinity_and_no_ids():
    hits = BALL.raycast([0, 0, 3], [0, 0, 1])
    assert hits.status == om.Status.MISS
    assert np.isposinf(hits.t)
    assert hits.object_id == hits.material_id == -1
    assert hits.normal.tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("origin", "direction"),
    [
        ([0, 0, 3], [0, 0, 0]),
        ([0, 0, 3], [np.nan, 0, 0]),
        ([0, 0, 3], [np.inf, 0, 0]),
        ([np.nan, 0, 3], [0, 0, -1]),
        ([np.inf, 0, 3], [0, 0, -1]),
    ],
)
def test_rays_that_are_none_are_invalid(origin, direction):
    assert BALL.raycast(origin, direction).status == om.Status.INVALID


@pytest.mark.parametrize("raycast", [om.Shape.raycast, om.reference.raycast])
def test_directions_of_any_length_give_no_nan(raycast):
    longest = [-np.finfo(float).max] * 3
    hits = raycast(BALL, [[3, 3, 3], [3, 3, -3]], longest)
    assert_array_equal(hits.status, [om.Status.HIT, om.Status.MISS])
    assert hits.t[0] < 1e-300
    assert hits.t[1] == np.inf


def test_rays_from_inside_say_so():
    hits = BALL.raycast([0, 0, 0], [0, 0, 1])
    assert hits.status == om.Status.INSIDE
    assert hits.t == 0


def test_spent_steps_are_no_miss():
    slab = om.box((4000, 2, 10), center=(0, -1, 0))
    hits = slab.raycast([0, 1, 0], [1, -1e-3, 0], march=om.March(max_steps=5))
    assert hits.status == om.Status.STEP_LIMIT
    assert hits.steps == 5
    assert 0 < hits.t < 1000


def test_limits_of_distance():
    far = om.sphere(1.0, center=(0, 0, -1000))
    aim = [0, 0, 3], [0, 0, -2]
    assert far.raycast(*aim).status == om.Status.HIT
    assert far.raycast(*aim, t_max=500).status == om.Status.MISS
    assert far.raycast(*aim, t_max=502).status == om.Status.HIT
    assert far.raycast(*aim, march=om.March(max_distance=1000)).status == om.Status.MISS


def test_default_distance_reaches_across_the_bounds():
    """From any origin, the farthest corner of what is bounded, and the horizon of a floor."""
    corner = om.box(0.5, center=(40, 40, 40)) | om.sphere(0.5)
    away = np.array([40, 40, 40.0])
    assert corner.raycast(-away, away).status == om.Status.HIT
    shot = corner.raycast([[0, 2, 0], [-100, 2, 0]], [1, 0.95, 1])
    assert shot.t.shape == (2,)
    floor = om.plane() | om.sphere(1.0)
    assert floor.raycast([50, 1, 0], [1, -1e-2, 0], march=om.March(max_steps=2000)).status == om.Status.HIT


def test_ids_tell_objects_and_materials_apart():
    red, blue = om.Material((0.8, 0.1, 0.1)), om.Material((0.1, 0.1, 0.8))
    shape = BALL.paint(red) | BALL.translate(3, 0, 0).paint(blue) | BALL.translate(6, 0, 0).paint(red)
    hits = shape.raycast([[0, 0, 3], [3, 0, 3], [6, 0, 3]], [0, 0, -1])
    program = om.compile(shape)
    assert [program.materials[i] for i in hits.material_id] == [red, blue, red]
    assert [program.objects[i][0] for i in hits.object_id] == ["sphere"] * 3
    assert len(set(hits.object_id.tolist())) == 3


def test_planes_left_out_say_how_to_ask():
    hits = BALL.raycast([0, 0, 3], [0, 0, -1], planes=("t", "steps"))
    assert hits.t == 2
    assert repr(hits) == "<Hits of shape (): t, steps>"
    with pytest.raises(AttributeError, match="normal was not asked for: add 'normal' to the planes of raycast"):
        hits.normal  # noqa: B018
    with pytest.raises(AttributeError, match="Hits has no attribute 'distance'"):
        hits.distance  # noqa: B018
    with pytest.raises(AttributeError):
        hits.t = 3


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"t_max": 0}, ValueError, "t_max must be > 0, got 0"),
        ({"t_max": np.nan}, ValueError, "t_max must be > 0, got nan"),
        ({"t_max": "a"}, TypeError, "t_max must be a number"),
        ({"march": 3}, TypeError, r"march must be an om\.March, got 3"),
        ({"planes": ("t", "color")}, ValueError, "planes must be one of 't', .*got 'color'"),
        ({"planes": ()}, ValueError, "planes must name at least one plane"),
        ({"planes": 3}, TypeError, "planes must be names of planes, got 3"),
    ],
)
def test_bad_options_are_refused(options, error, message):
    with pytest.raises(error, match=message):
        BALL.raycast([0, 0, 3], [0, 0, -1], **options)


def test_rays_that_do_not_broadcast_are_refused():
    with pytest.raises(ValueError, match=r"origins and directions must broadcast, got shapes \(2, 3\) and \(4, 3\)"):
        BALL.raycast(np.ones((2, 3)), np.ones((4, 3)))


# March ----------------------------------------------------------------------------------------------------------------


def test_march_resolves_epsilon_from_the_size():
    program = om.compile(om.box((3, 4, 12)))
    assert om.March().resolve(program, (0, 0, 20)).epsilon == pytest.approx(1e-6 * 13)
    assert om.March().resolve(program, (0, 0, 20), pixels=False).epsilon == pytest.approx(1e-5 * 13)
    assert om.March(epsilon=0.5).resolve(program, (0, 0, 20)).epsilon == 0.5
    assert om.March().resolve(om.compile(om.plane()), (0, 0, 20)).epsilon == 1e-6
    assert om.March().resolve(om.compile(om.sphere(0)), (0, 0, 20)).epsilon == 1e-6


def test_march_resolves_max_distance_from_the_bounds():
    box = om.compile(om.box((2, 2, 2)))
    assert om.March().resolve(box, (0, 0, 5)).max_distance == pytest.approx(1.001 * np.sqrt(38))
    assert om.March().resolve(box, [[0, 0, 5], [0, np.nan, 9], [0, 0, 7]]).max_distance == pytest.approx(
        1.001 * np.sqrt(66)
    )
    assert om.March().resolve(box, (0, 0, 0)).max_distance == pytest.approx(1.001 * np.sqrt(12))
    open_ended = om.compile(om.box((3, 4, 12)) | om.plane())
    assert om.March().resolve(open_ended, (0, 0, 1)).max_distance == pytest.approx(13_000)
    assert om.March().resolve(open_ended, (0, 0, 100)).max_distance == pytest.approx(100_000)
    assert om.March(max_distance=7).resolve(box, (0, 0, 5)).max_distance == 7


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"method": "magic"}, ValueError, "method must be one of 'auto', 'plain', .*'certified', got 'magic'"),
        ({"method": None}, ValueError, "method"),
        ({"max_steps": 0}, ValueError, "max_steps must lie in"),
        ({"max_steps": 2.0}, TypeError, "max_steps must be an integer, got 2.0"),
        ({"epsilon": -1e-3}, ValueError, "epsilon must be ≥ 0, got -0.001"),
        ({"epsilon": np.nan}, ValueError, "epsilon must be finite, got nan"),
        ({"pixel_tolerance": -1}, ValueError, "pixel_tolerance"),
        ({"max_distance": 0}, ValueError, "max_distance must be > 0, got 0"),
        ({"max_distance": np.inf}, ValueError, "max_distance must be finite"),
        ({"min_distance": -1}, ValueError, "min_distance must be ≥ 0, got -1"),
        ({"min_distance": "near"}, TypeError, "min_distance must be a number"),
        (
            {"min_distance": 2, "max_distance": 2.0},
            ValueError,
            "min_distance must be less than max_distance 2.0, got 2",
        ),
        ({"bias": -0.1}, ValueError, "bias must be ≥ 0, got -0.1"),
        ({"bias": np.inf}, ValueError, "bias must be finite, got inf"),
        ({"method": "fixed", "step": 0}, ValueError, "step must be > 0, got 0"),
        ({"step": 0.1}, ValueError, "step must be None unless method is 'fixed', got 0.1"),
        ({"finish": "newton"}, ValueError, "finish must be one of 'secant', None, got 'newton'"),
    ],
)
def test_bad_marches_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        om.March(**arguments)


def test_surface_points_are_those_of_their_rays(isa: str, precision: str):
    """Whichever of some neighbouring rays hit: positions are gathered by their indices."""
    rng = np.random.default_rng(2)
    for count in (8, 16, 19):
        origins = rng.uniform((-0.5, -0.5, 2.5), (0.5, 0.5, 3.5), (count, 3))
        for _ in range(60):
            hits_ball = rng.random(count) < 0.7
            directions = np.where(hits_ball[:, None], [0.0, 0, -1], [0, 0, 1.0])
            hits = BALL.raycast(origins, directions, precision=precision, isa=isa)
            assert_array_equal(hits.status == om.Status.HIT, hits_ball)
            expected = origins[hits_ball] + hits.t[hits_ball, None] * directions[hits_ball]
            assert_allclose(hits.position[hits_ball], expected, atol=1e-6)
