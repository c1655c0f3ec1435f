"""Ways of stepping: each finds the surfaces that plain steps find, never passes one, and says so truly."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray

import octomarch as om
from marched import CAMERAS, FAR, LONGER, METHODS, SCENES, blend, picture

Array = NDArray[np.float64]


def truth(name: str) -> om.Image:
    """Plain steps to a tolerance that is as good as none, in double."""
    return picture(name, "float64", method="plain", max_steps=20_000, epsilon=1e-9, pixel_tolerance=0.0)


@pytest.fixture(params=SCENES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.mark.parametrize("method", METHODS)
def test_surfaces_are_found(name: str, method: str, precision: str):
    """No surface is missed. A ray that comes within the hit epsilon of an edge may hit there, and few do."""
    found, expected = picture(name, precision, method=method), truth(name)
    assert not (expected.status == om.Status.STEP_LIMIT).any()
    surface = expected.status == om.Status.HIT
    assert_array_equal(found.status[surface], om.Status.HIT)
    assert np.count_nonzero(found.status[~surface] != om.Status.MISS) <= 0.005 * found.status.size
    off = np.abs(found.depth[surface] - expected.depth[surface]) / expected.depth[surface]
    assert np.median(off) < {"float32": 1e-7, "float64": 3e-8}[precision]
    assert np.quantile(off, 0.9) < (1e-2 if name == "crowd" else 1e-5)
    # a hit is never behind the surface, but by its tolerance
    assert (found.depth[surface] <= expected.depth[surface] * (1 + 1e-3)).all()


@pytest.mark.parametrize("method", METHODS)
def test_steps_are_counted_and_limited(name: str, method: str):
    steps = picture(name, method=method).steps
    assert steps.max() < 256
    few = picture(name, method=method, max_steps=9)
    assert few.steps.max() == 9
    assert_array_equal(few.steps[few.status == om.Status.STEP_LIMIT], 9)


@pytest.mark.parametrize("max_steps", [1, 2, 3, 5, 9, 20])
@pytest.mark.parametrize("method", METHODS)
def test_no_surface_lies_before_a_candidate(name: str, method: str, max_steps: int):
    """A step of which is not known whether the surface was passed does not count."""
    found, expected = picture(name, "float64", method=method, max_steps=max_steps), truth(name)
    spent = found.status == om.Status.STEP_LIMIT
    assert spent.any() or (name, method, max_steps) == ("building", "auto", 20)  # needs fewer
    assert (found.depth[spent] <= expected.depth[spent] * (1 + 1e-9)).all()
    others = ~spent & (expected.status == om.Status.HIT)
    assert_array_equal(found.status[others], om.Status.HIT)


def rays(count: int) -> tuple[Array, Array]:
    """Return rays from all sides, most of which hit something."""
    rng = np.random.default_rng(12)
    origins = rng.normal(size=(count, 3))
    origins *= 7 / np.linalg.norm(origins, axis=1)[:, None]
    return origins, rng.normal(size=(count, 3)) - origins


@pytest.mark.parametrize("finish", ["secant", None])
@pytest.mark.parametrize("method", METHODS)
def test_rays_are_those_of_the_reference(name: str, method: str, finish: str | None, isa: str):
    """Enhanced steps differ in the last digits of their length, so that few rays need one more or one less."""
    shape, (origins, directions) = SCENES[name][0], rays(150)
    for limits in ({}, {"max_steps": 6}, {"min_distance": 3.0, "max_distance": 6.5}):
        march = om.March(method, finish=finish, **({"max_distance": FAR} | limits))
        found = shape.raycast(origins, directions, march=march, precision="float64", isa=isa)
        expected = om.reference.raycast(shape, origins, directions, march=march)
        known = expected.status != om.Status.STEP_LIMIT if method == "auto" else np.full(150, True)
        assert_array_equal(found.status[known], expected.status[known])
        ended = known & (found.status != om.Status.STEP_LIMIT)
        sooner = ~known & (found.status != om.Status.STEP_LIMIT)
        if sooner.any():
            further = om.March(method, finish=finish, **({"max_distance": FAR} | limits | {"max_steps": 5000}))
            settled = om.reference.raycast(shape, origins[sooner], directions[sooner], march=further)
            assert_array_equal(found.status[sooner], settled.status)
            assert_allclose(found.t[sooner], settled.t, rtol=1e-3 if finish is None else 1e-4)
        assert_allclose(found.t[ended], expected.t[ended], rtol=1e-3 if finish is None else 1e-4)
        if method in ("plain", "relaxed"):
            assert_allclose(found.t, expected.t, rtol=1e-6)
            assert_array_equal(found.steps, expected.steps)
        if method == "auto":  # less is marched
            assert found.steps.sum() <= expected.steps.sum()
        else:
            assert np.median(np.abs(found.steps - expected.steps)) == 0
            assert np.abs(found.steps - expected.steps).max() <= 8


@pytest.mark.parametrize("method", LONGER)
@pytest.mark.parametrize("distance", [1.3, 1.7, 1.999])
def test_no_shell_before_the_farthest_distance_is_missed(method: str, distance: float, isa: str, precision: str):
    """Long steps end at max_distance, where walls a little before it, thin ones too, are still in the way."""
    rng = np.random.default_rng(3)
    height = rng.uniform(0.3, 0.99, 500) * distance
    slope = np.concatenate([np.zeros(250), rng.uniform(0, 0.3, 250)])
    directions = np.stack([np.sin(slope), 0 * slope, -np.cos(slope)], axis=-1)
    march = om.March(method, max_distance=distance, epsilon=1e-6)
    origins = np.stack([0 * height, 0 * height, height], axis=-1)
    hits = (
        om.plane((0, 0, 1), (0, 0, 0))
        .shell(1e-3)
        .raycast(origins, directions, march=march, precision=precision, isa=isa)
    )
    expected = (height - 5e-4) / np.cos(slope)
    clear = expected < distance * 0.9999
    assert_array_equal(hits.status[clear], om.Status.HIT)
    assert_allclose(hits.t[clear], expected[clear], rtol=1e-5)


@pytest.mark.parametrize("method", LONGER)
def test_a_farthest_distance_that_a_sum_is_rounded_past(method: str, isa: str):
    """The sum t + (t_max − t) may be the number after t_max, as in float of these. What lies before is hit."""
    unit = 2.0**-23
    for far, start in itertools.product(1 + np.arange(1001, 1301, 50) * unit, np.arange(0.5, 8) * unit):
        heights = np.linspace(0.65, 0.99, 40)
        origins = np.stack([0 * heights, 0 * heights, heights], axis=-1)
        march = om.March(method, max_distance=far, min_distance=start)
        hits = om.plane((0, 0, 1)).raycast(origins, [0, 0, -1], march=march, precision="float32", isa=isa)
        assert_array_equal(hits.status, om.Status.HIT)


@pytest.mark.parametrize("finish", ["secant", None])
@pytest.mark.parametrize("method", METHODS)
def test_hits_do_not_lie_behind_a_wall(method: str, finish: str | None, isa: str, precision: str):
    """Square to a wall, the sphere of a sample behind it touches the one before it, as after a step well taken."""
    heights = np.linspace(0.5, 5, 333)
    origins = np.stack([0 * heights, 0 * heights, heights], axis=-1)
    march = om.March(method, finish=finish, epsilon=1e-5)
    for shape in (om.plane((0, 0, 1)), om.box((4, 4, 1)).translate(0, 0, -0.5), om.sphere(1).translate(0, 0, -1)):
        hits = shape.raycast(origins, [0, 0, -1], march=march, precision=precision, isa=isa)
        assert_array_equal(hits.status, om.Status.HIT)
        assert_allclose(hits.t, heights, atol=2e-5)
        if precision == "float64":
            reference = om.reference.raycast(shape, origins[::7], [0, 0, -1], march=march)
            assert_allclose(reference.t, heights[::7], atol=2e-5)


@pytest.mark.parametrize("method", METHODS)
def test_what_is_no_number_behind_a_surface_does_not_matter(method: str, isa: str, precision: str):
    """A long step may end there, and goes back. Before the surface, it makes rays invalid."""
    _, y, z = om.coordinates()
    wall = om.field(om.where(z < 0.2, om.sqrt(-1 - z * z), z - 0.3), lipschitz=1)
    heights = np.linspace(0.5, 6, 100)
    directions = np.stack([0.4 * np.sin(heights), 0 * heights, -np.ones(100)], axis=-1)
    origins = np.stack([0 * heights, 0 * heights, heights], axis=-1)
    march = om.March(method)
    hits = wall.raycast(origins, directions, march=march, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    assert_allclose(hits.t, heights - 0.3, rtol=1e-5)
    assert_array_equal(om.reference.raycast(wall, origins, directions, march=march).status, om.Status.HIT)
    fog = om.field(om.where(abs(z - 2) < 1, om.sqrt(-1 - y * y), z - 0.3), lipschitz=1)
    assert_array_equal(
        fog.raycast([[0, 0, 2.5], [0, 0, 0.5]], [0, 0, -1], march=march, isa=isa).status,
        [om.Status.INVALID, om.Status.HIT],
    )


@pytest.mark.parametrize("method", LONGER)
def test_with_a_bias_all_steps_are_plain(method: str, isa: str, precision: str):
    """Bit by bit."""
    shape, (origins, directions) = blend(), rays(500)
    for bias in (1e-6, 0.01, 1.0):
        found, expected = (
            shape.raycast(origins, directions, march=om.March(m, bias=bias), precision=precision, isa=isa)
            for m in (method, "plain")
        )
        for plane in ("t", "status", "steps"):
            assert getattr(found, plane).tobytes() == getattr(expected, plane).tobytes()


@pytest.mark.parametrize("method", METHODS)
def test_shadows_are_those_of_plain_steps(method: str):
    """However camera rays go, shadow rays take plain steps: pictures differ by no more than hits do."""
    lights = [om.DirectionalLight((-1, -2, -1)), om.PointLight((3, 3, 3), 5)]
    scene = om.Scene(blend(), ambient=0.2, lights=lights)
    for shadows in ("hard", "soft"):
        plain, other = (
            om.render(scene, CAMERAS["perspective"], (61, 43), march=om.March(m), shading=om.Shading(shadows=shadows))
            for m in ("plain", method)
        )
        off = np.abs(plain.color - other.color).max(axis=-1)
        assert (off < 1e-3).mean() > 0.98


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        (
            {"method": "fast"},
            ValueError,
            "method must be one of 'auto', 'plain', 'relaxed', 'enhanced', 'fixed', 'certified', got 'fast'",
        ),
        ({"method": "Auto"}, ValueError, "method must be .* got 'Auto'"),
        ({"method": 1}, (TypeError, ValueError), "method must be"),
        ({"method": None}, (TypeError, ValueError), "method must be"),
        *(
            ({"method": method, "step": 0.1}, ValueError, "step must be None unless method is 'fixed', got 0.1")
            for method in METHODS
        ),
        *(({"method": m, "bias": b}, ValueError, "bias must be") for m, b in itertools.product(LONGER, (-1.0, np.nan))),
    ],
)
def test_wrong_arguments(settings: dict[str, object], error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.March(**settings)


def test_auto_is_what_there_is_by_default():
    assert om.March() == om.March("auto")
    found, expected = (
        om.render(blend(), size=(40, 30), planes=("depth",), **options) for options in ({}, {"march": om.March("auto")})
    )
    assert found.depth.tobytes() == expected.depth.tobytes()
