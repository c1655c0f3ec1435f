"""`March.for_error`: its settings meet the target on pixels and scenes that it has not seen, or it says how near."""

from typing import Any

import numpy as np
import pytest

import octomarch as om
from octomarch.study.errors import depth_errors, percentiles, ray_errors
from octomarch.study.measure import evaluations
from octomarch.study.sample import windows
from octomarch.study.truth import find_truth

SIZE = (320, 240)
SMALL = (160, 120)
SAMPLING = 0.05  # evaluations a ray by which costs on one half of a sample may differ from those on all of it


def drilled() -> tuple[om.Shape, om.Camera]:
    floor = om.plane(point=(0, -1, 0))
    return (om.box(2.0) - om.sphere(1.3)) | floor, om.Camera((3, 2.5, 4), (0, 0, 0))


def twisted() -> tuple[om.Shape, om.Camera]:
    return om.box((1, 3, 1)).twist(40).round(0.1), om.Camera((2, 2, 5), (0, 0, 0), fov=50)


def rings() -> tuple[om.Shape, om.Camera]:
    links = om.torus(1.0, 0.2).union(om.torus(0.8, 0.25, axis="x").translate(1, 0, 0), smooth=0.3)
    return links | om.sphere(20.0, center=(0, -21, 0)), om.Camera((0, 1.5, 5), (0.3, 0, 0))


def waves() -> tuple[om.Shape, om.Camera]:
    x, y, z = om.coordinates()
    return om.field(y + 0.2 * om.sin(3 * x) * om.sin(3 * z)) & om.box(6.0), om.Camera((5, 5, 6), (0, 0, 0))


SCENES = [drilled, twisted, rings, waves]


def held_out(shape: om.Shape, camera: om.Camera, march: om.March, precision: Any = "float32") -> Any:
    """Return the errors of all pixels that no window has, and those of the depth plane."""
    resolved = om.March().resolve(om.compile(shape), camera.eye)
    planes = ("depth", "status")
    truth = find_truth(om.Scene(shape), camera, SIZE, resolved, kind="float64", planes=planes).depth
    image = om.render(shape, camera, SIZE, march=march, planes=planes, precision=precision)
    unseen = np.ones(truth.shape, bool)
    for x, y, width, height in windows(SIZE, 32):
        unseen[y : y + height, x : x + width] = False
    assert unseen.mean() > 0.4
    return image.depth[unseen], image.status[unseen], truth[unseen]


@pytest.mark.parametrize("make", SCENES, ids=lambda make: make.__name__)
@pytest.mark.parametrize("p95", [1e-2, 1e-4])
def test_the_target_is_met_on_pixels_that_were_not_seen(make: Any, p95: float):
    shape, camera = make()
    march = om.March.for_error(shape, camera, p95, size=SIZE)
    errors = depth_errors(*held_out(shape, camera, march))
    assert errors.p95 <= p95
    assert errors.false_misses == 0
    assert march.measured is not None
    assert march.measured.p95 <= p95
    assert march.measured.misses == 0


def test_less_error_costs_more():
    shape, camera = drilled()
    costs = [om.March.for_error(shape, camera, p95, size=SMALL).measured for p95 in (1.0, 1e-2, 1e-5)]
    counted = [measured.evaluations for measured in costs]
    assert counted[0] < counted[1] <= counted[2] + SAMPLING
    of_defaults = evaluations(om.render(shape, camera, SMALL, planes=("depth",)))
    assert counted[1] < of_defaults  # which are finer than that


def test_settings_are_the_cheapest_of_those_that_meet_the_target():
    """Anything cheaper that a user could try by the tolerance alone is worse than what was asked for."""
    shape, camera = twisted()
    march = om.March.for_error(shape, camera, 1e-3, size=(64, 48))  # all of it is the sample
    truth = find_truth(om.Scene(shape), camera, (64, 48), om.March().resolve(om.compile(shape), camera.eye)).depth
    for tolerance in (8.0, 4.0, 2.0, 1.0, 0.5, 0.2, 0.1):
        other = om.March(pixel_tolerance=tolerance)
        image = om.render(shape, camera, (64, 48), march=other, planes=("depth", "status"))
        if evaluations(image) < march.measured.evaluations - 0.01:
            assert percentiles(ray_errors(image.depth, truth))[1] > 1e-3


def test_false_hits_can_be_ruled_out():
    shape, camera = twisted()
    loose = om.March.for_error(shape, camera, 1e-2, size=SMALL)
    strict = om.March.for_error(shape, camera, 1e-2, size=SMALL, false_hits=1e-4)
    assert strict.measured.false_hits <= 1e-4 * strict.measured.rays < loose.measured.false_hits
    assert strict.measured.evaluations > loose.measured.evaluations


def test_a_target_out_of_reach_is_told_with_how_near_it_came():
    shape, camera = drilled()
    with pytest.raises(ValueError, match=r"no settings meet p95 ≤ 1e-08, .* in float32: the nearest have p95") as told:
        om.March.for_error(shape, camera, 1e-8, size=(64, 48))
    assert "precision='float64' comes nearer" in str(told.value)
    near = float(str(told.value).split("the nearest have p95 ")[1].split(",")[0])
    assert 1e-8 < near < 1e-4
    march = om.March.for_error(shape, camera, 1e-8, size=SIZE, precision="float64")
    assert depth_errors(*held_out(shape, camera, march, "float64")).p95 <= 1e-8


def test_the_same_question_has_the_same_answer():
    shape, camera = rings()
    first, second = (om.March.for_error(shape, camera, 1e-3, size=(96, 64), threads=n) for n in (1, 2))
    assert first == second
    assert first.measured == second.measured


def test_only_what_was_measured_says_so():
    march = om.March.for_error(om.sphere(1.0), size=(64, 48))
    assert march.measured is not None
    assert om.March().measured is None
    assert march.resolve(om.compile(om.sphere(1.0)), (0, 0, 3)).measured is None
    assert march == om.March(**{f: getattr(march, f) for f in march.__dataclass_fields__})


def test_solids_get_the_longest_steps_that_do():
    x, y, z = om.coordinates()
    ball = om.solid(x * x + y * y + z * z <= 1)
    camera = om.Camera((0, 0, 4), (0, 0, 0))
    march = om.March.for_error(ball, camera, 2e-2, size=(64, 48))
    assert march.method == "fixed"
    assert march.measured.p95 <= 2e-2


def test_windows_cover_small_pictures_and_are_spread_over_large_ones():
    for size in ((1, 1), (31, 33), (64, 40), (640, 480), (2000, 50)):
        counts = np.zeros(size[::-1], int)
        for x, y, width, height in windows(size, 32):
            assert width >= 1
            assert height >= 1
            counts[y : y + height, x : x + width] += 1
        assert counts.max() == 1
        if size[0] * size[1] <= 32 * 1024 and min(size) >= 32:
            assert counts.min() == 1
    quarters = [(x < 320, y < 240) for x, y, _, _ in windows((640, 480), 32)]
    assert min(quarters.count((a, b)) for a in (True, False) for b in (True, False)) >= 5


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"scene": 3}, TypeError, r"scene must be an om\.Shape or om\.Scene, got 3"),
        ({"camera": 3}, TypeError, r"camera must be an om\.Camera.*, got 3"),
        ({"p95": 0}, ValueError, r"p95 must be > 0, got 0"),
        ({"p95": "small"}, TypeError, r"p95 must be a number, got 'small'"),
        ({"misses": 2}, ValueError, r"misses must lie in \[0, 1\], got 2"),
        ({"false_hits": -1}, ValueError, r"false_hits must lie in \[0, 1\], got -1"),
        ({"size": (8,)}, ValueError, r"size must be \(width, height\), got \(8,\)"),
        ({"precision": "half"}, ValueError, r"precision must be one of .*, got 'half'"),
        ({"max_distance": -1}, ValueError, r"max_distance must be > 0, got -1"),
        ({"threads": 0}, ValueError, r"threads must lie in"),
        ({"progress": 3}, TypeError, r"progress must be True, a callable or None, got 3"),
        ({"camera": om.Camera((0, 0, 4), (0, 0, 9))}, ValueError, r"camera must see a surface: none is met"),
    ],
)
def test_wrong_arguments_are_named(arguments: dict[str, Any], error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.March.for_error(**{"scene": om.sphere(1.0), "size": (32, 24), **arguments})


def test_ctrl_c_ends_a_search():
    def stop(done: int, _: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        om.March.for_error(om.sphere(1.0), size=(32, 24), progress=stop)
