"""The certified search: closed forms, what each verdict means, pictures, arguments.

`test_certified_soundness` holds its bounds against values, `_arb` and `_povray` its brackets against other programs.
"""

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from closed_forms import SOLIDS
from every_node import shapes
from octomarch.reference import Brackets, Verdict, certified, certified_picture

X, Y, Z = om.coordinates()
INF = math.inf
ROUNDING = 4e-13
"""Of closed forms evaluated in float64, at lengths up to 20; roots of quartics are another matter."""
QUARTIC = 1e-10


def rays(count: int, spread: float = 0.8) -> tuple[np.ndarray, np.ndarray]:
    """Return origins 5 away from the middle, and unit directions to points near it."""
    rng = np.random.default_rng(1)
    origins = rng.normal(size=(count, 3))
    origins *= 5 / np.linalg.norm(origins, axis=1)[:, None]
    directions = rng.normal(scale=spread, size=(count, 3)) - origins
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]


def verdicts(found: Brackets) -> set[Verdict]:
    return {Verdict(int(status)) for status in np.unique(found.status)}


@pytest.mark.parametrize("name", SOLIDS)
def test_brackets_hold_the_roots_of_closed_forms(name: str):
    shape, first_root = SOLIDS[name]
    origins, directions = rays(1500)
    outside = shape.distance(origins) > 0
    origins, directions = origins[outside], directions[outside]
    found = certified(shape, origins, directions, max_distance=100)
    truth = first_root(origins, directions)
    truth[truth > 100] = INF
    assert verdicts(found) == {Verdict.HIT, Verdict.MISS}
    hit = found.status == Verdict.HIT
    assert_array_equal(hit, np.isfinite(truth))
    slack = QUARTIC if name == "torus" else ROUNDING
    assert_array_equal(found.t_lo[~hit], INF)
    assert_array_equal(found.t_hi[~hit], INF)
    t_lo, t_hi, truth, d = found.t_lo[hit], found.t_hi[hit], truth[hit], directions[hit]
    # a root is the less sure the more the ray grazes the surface
    slope = np.abs(np.einsum("ij,ij->i", shape.gradient(origins[hit] + t_hi[:, None] * d), d))
    slack = slack / np.maximum(slope, 1e-6)
    assert (t_lo - slack <= truth).all()
    assert (truth <= t_hi + slack).all()
    assert (t_hi - t_lo <= 1e-10 * t_hi).all()


def test_roots_of_an_endless_cylinder():
    origins, directions = rays(500)
    a = (directions[:, [0, 2]] ** 2).sum(1)
    b = (directions * origins)[:, [0, 2]].sum(1)
    with np.errstate(invalid="ignore"):
        truth = (-b - np.sqrt(b * b - a * ((origins[:, [0, 2]] ** 2).sum(1) - 0.49))) / a
    found = certified(om.cylinder(0.7), origins, directions, max_distance=100)
    outside = found.status != Verdict.INSIDE
    hit = (found.status == Verdict.HIT) & outside
    assert_array_equal(hit[outside], ((truth > 0) & (truth < 100))[outside])
    assert np.abs(found.t_lo[hit] - truth[hit]).max() < 1e-8


def test_t_counts_in_lengths_of_the_direction():
    found = certified(om.sphere(1.0), [0, 0, 3], [[0, 0, -1], [0, 0, -4], [0, 0, -1e-3], [0, 0, -1e200]])
    np.testing.assert_allclose(found.t_lo, [2, 0.5, 2000, 2e-200], rtol=1e-10)


def test_a_ray_that_starts_inside_says_so():
    found = certified(om.box(2.0), [[0, 0, 0], [1, 0, 0], [0, 0, 2]], [1, 0, 0], t_min=0.5)
    assert_array_equal(found.status, [Verdict.INSIDE, Verdict.MISS, Verdict.MISS])
    assert_array_equal(found.t_lo, [0.5, INF, INF])
    assert_array_equal(found.t_hi, [0.5, INF, INF])
    on_the_face = certified(om.box(2.0), [1, 0, 0], [1, 0, 0])
    assert on_the_face.status == Verdict.INSIDE


def test_a_ray_may_start_behind_the_first_surface():
    shape = om.sphere(1.0) | om.sphere(1.0).translate(0, 0, -5)
    found = certified(shape, [0, 0, 3], [0, 0, -1], t_min=4.5)
    assert found.t_lo <= 7 <= found.t_hi


def test_nothing_lies_beyond_the_end():
    found = certified(om.sphere(1.0), [0, 0, 3], [0, 0, -2], max_distance=1.999)
    assert found.status == Verdict.MISS
    assert certified(om.sphere(1.0), [0, 0, 3], [0, 0, -2], max_distance=2.001).status == Verdict.HIT
    assert certified(om.sphere(1.0), [0, 0, 3], [0, 0, -2], t_min=1, max_distance=1.5).status == Verdict.MISS


def test_rays_that_are_none_are_invalid():
    origins = [[0, 0, 3], [0, 0, 3], [INF, 0, 0], [math.nan, 0, 0]]
    directions = [[0, 0, 0], [0, 0, -INF], [0, 0, 1], [0, 0, 1]]
    found = certified(om.sphere(1.0), origins, directions, max_distance=10)
    assert_array_equal(found.status, Verdict.INVALID)
    assert_array_equal(found.t_lo, INF)


@pytest.mark.parametrize("gap", [1e-9, 1e-7, 1e-3])
def test_what_barely_misses_misses_and_what_barely_hits_hits(gap: float):
    origins = [[1 + gap, 0, 3], [1 - gap, 0, 3]]
    found = certified(om.sphere(1.0), origins, [0, 0, -1], max_distance=10)
    assert_array_equal(found.status, [Verdict.MISS, Verdict.HIT])
    np.testing.assert_allclose(found.t_lo[1], 3 - math.sqrt(gap * (2 - gap)), rtol=1e-10)


def test_a_ray_that_only_touches_is_undecided():
    found = certified(om.sphere(1.0), [1, 0, 3], [0, 0, -1], max_distance=10)
    assert found.status == Verdict.UNDECIDED
    assert 3 - 1e-6 < found.t_lo <= 3
    assert found.t_hi == INF


def test_thin_things_are_not_passed():
    foil = om.sphere(1.0).shell(1e-9) & om.plane((0, 0, 1), (0, 0, 0.5))
    found = certified(foil, [0, 0, 3], [0, 0, -1], max_distance=10)
    np.testing.assert_allclose(found.t_lo, 4 - 5e-10, rtol=1e-10)


def test_lipschitz_bounds_are_not_believed():
    steep = om.field(20 * (om.length(X, Y, Z) - 1), lipschitz=1)
    march = om.March("plain", pixel_tolerance=0)
    assert steep.raycast([0, 0.5, 3], [0, 0, -1], march=march).status != om.Status.HIT
    found = certified(steep, [0, 0.5, 3], [0, 0, -1], max_distance=10)
    np.testing.assert_allclose(found.t_lo, 3 - math.sqrt(0.75), rtol=1e-10)


def test_jumps_are_bracketed():
    stairs = om.field(Y - om.floor(X), lipschitz=1)
    found = certified(stairs, [0.5, 2.5, 0], [2, 0, 0], max_distance=100)
    assert found.t_lo <= 1.25 <= found.t_hi
    solid = om.solid((X * X + Y * Y < 1) & (abs(Z) <= 1))
    found = certified(solid, [-3, 0.6, 0], [1, 0, 0], max_distance=100)
    np.testing.assert_allclose(found.t_lo, 2.2, rtol=1e-10)


def test_a_field_that_is_no_number_decides_nothing():
    half = om.field(om.where(X < 0, om.sqrt(X), 1 - X), lipschitz=1)
    found = certified(half, [[-2, 0, 0], [0.5, 0, 0]], [1, 0, 0], max_distance=10)
    assert_array_equal(found.status, [Verdict.UNDECIDED, Verdict.HIT])
    assert_array_equal(found.t_lo[0], 0)
    pole = certified(om.field(1 / X, lipschitz=1), [3, 0, 0], [-1, 0, 0], max_distance=10)
    assert pole.t_lo <= 3 < pole.t_hi  # positive up to it, negative after it


def test_endless_searches_end():
    found = certified(om.sphere(1.0), [0, 0, 3], [[0, 0, 1], [0, 0, -1], [1, 0, 0]], max_distance=INF)
    assert_array_equal(found.status, [Verdict.MISS, Verdict.HIT, Verdict.MISS])
    floor = certified(om.plane(), [0, 1, 0], [[1, 0, 0], [1, -1e-9, 0], [1, 1e-9, 0]], max_distance=INF)
    assert_array_equal(floor.status, [Verdict.MISS, Verdict.HIT, Verdict.MISS])
    np.testing.assert_allclose(floor.t_lo[1], 1e9, rtol=1e-10)


def test_repeats_are_searched_cell_by_cell():
    grid = om.sphere(0.25).repeat((1, 1, 1))
    origins = [[0.5, 0.5, 0.5], [0.5, 0.5, 0.5]]
    found = certified(grid, origins, [[1, 1, 1], [40, 1, 0]], max_distance=200)
    np.testing.assert_allclose(found.t_lo[0], 0.5 - 0.25 / math.sqrt(3), rtol=1e-10)
    assert found.status[1] == Verdict.MISS
    row = om.sphere(0.25).repeat((1, 0, 0), counts=(4, None, None))  # at x = ±1/2 and ±3/2
    found = certified(row, [[-9, 0, 0], [9, 0, 0], [0, 0, 0]], [[1, 0, 0], [-1, 0, 0], [1, 0, 0]], max_distance=99)
    np.testing.assert_allclose(found.t_lo, [7.25, 7.25, 0.25], rtol=1e-10)


def test_copies_that_reach_over_their_cells_are_met_in_the_next():
    """A repeat looks at the neighbour on the point's side; off-centre content is found there."""
    shape = om.sphere(0.2).translate(0.45, 0, 0).repeat((1, 0, 0))
    found = certified(shape, [0.55, 0, 3], [0, 0, -1], max_distance=10)
    np.testing.assert_allclose(found.t_lo, 3 - math.sqrt(0.04 - 0.01), rtol=1e-10)


@pytest.mark.parametrize("index", range(len(shapes())))
def test_every_kind_of_node_is_decided_and_agrees_with_a_march(index: int):
    """A march of small epsilon, all of whose hits lie within some epsilons of the truth."""
    shape, camera = shapes()[index], om.Camera((3, 2.5, 5), (0, 0, 0), fov=35)
    found = certified_picture(shape, camera, (64, 48), max_distance=30)
    march = om.March(epsilon=1e-9, pixel_tolerance=0, max_steps=5000, max_distance=30)
    image = om.render(shape, camera, (64, 48), march=march, planes=("depth", "status"), precision="float64")
    assert (found.status == Verdict.UNDECIDED).sum() == 0
    assert_array_equal(found.status, image.status)
    hit = found.status == Verdict.HIT
    assert (image.depth[hit] >= found.t_lo[hit] * (1 - 1e-9) - 2e-6).all()  # fixed steps end up to step/1024 before
    assert (image.depth[hit] <= found.t_hi[hit] * (1 + 1e-9) + 2e-6).all()


def test_few_evaluations_decide_little_but_nothing_wrong():
    origins, directions = rays(200)
    shape = om.torus(1.0, 0.25)
    truth = certified(shape, origins, directions, max_distance=100)
    for count in (1, 2, 5, 10, 100):
        found = certified(shape, origins, directions, max_distance=100, max_evaluations=count)
        undecided = found.status == Verdict.UNDECIDED
        assert_array_equal(found.status[~undecided], truth.status[~undecided])
        assert (found.t_lo[undecided] <= truth.t_lo[undecided]).all()
        assert count > 1 or undecided.all()
    assert not undecided.any()


def test_a_coarser_tolerance_holds_the_finer_bracket():
    origins, directions = rays(300)
    fine = certified(om.torus(1.0, 0.25), origins, directions, max_distance=100, tolerance=1e-13)
    coarse = certified(om.torus(1.0, 0.25), origins, directions, max_distance=100, tolerance=1e-3)
    hit = (fine.status == Verdict.HIT) & (coarse.status == Verdict.HIT)
    assert hit.any()
    assert (coarse.t_lo[hit] <= fine.t_hi[hit]).all()
    assert (coarse.t_hi[hit] >= fine.t_lo[hit]).all()
    assert (fine.t_hi[hit] - fine.t_lo[hit] <= 1e-13 * fine.t_hi[hit]).all()


def test_threads_change_nothing():
    origins, directions = rays(500)
    shape = om.torus(1.0, 0.25).union(om.sphere(0.5), smooth=0.2)
    one, three = (certified(shape, origins, directions, max_distance=50, threads=n) for n in (1, 3))
    for name in ("t_lo", "t_hi", "status"):
        assert_array_equal(getattr(one, name), getattr(three, name))


@pytest.mark.parametrize(
    "camera",
    [
        om.Camera((1, 2, 4), (0, 0, 0), fov=40),
        om.OrthographicCamera((1, 2, 4), (0, 0, 0), height=3),
        om.PanoramicCamera((0.2, 0.1, 1.7), (0, 0, 0)),
    ],
    ids=lambda camera: type(camera).__name__,
)
def test_pictures_are_of_the_rays_of_renders(camera: om.Camera | om.OrthographicCamera | om.PanoramicCamera):
    shape = om.box((1, 1.2, 0.9)) | om.plane(point=(0, -1, 0))
    march = om.March(epsilon=1e-12, pixel_tolerance=0, max_steps=2000, max_distance=50)
    image = om.render(shape, camera, (24, 16), march=march, planes=("depth", "status"), precision="float64")
    found = certified_picture(shape, camera, (24, 16), max_distance=50)
    assert_array_equal(found.status, image.status)
    hit = found.status == Verdict.HIT
    np.testing.assert_allclose(image.depth[hit], found.t_lo[hit], rtol=1e-9)
    part = certified_picture(shape, camera, (24, 16), max_distance=50, crop=(3, 2, 10, 7))
    assert_array_equal(part.t_lo, found.t_lo[2:9, 3:13])
    assert_array_equal(part.status, found.status[2:9, 3:13])


def test_scenes_count_as_their_shapes_and_shapes_of_arrays_stay():
    shape = om.sphere(1.0)
    scene = om.Scene(shape)
    found = certified(scene, np.full((2, 3, 3), (0, 0, 3.0)), [0, 0, -1])
    assert found.t_lo.shape == found.t_hi.shape == found.status.shape == (2, 3)
    assert certified(shape, [0, 0, 3], [0, 0, -1]).status.shape == ()
    assert certified(shape, np.empty((0, 3)), [0, 0, -1]).status.shape == (0,)
    assert_array_equal(certified_picture(scene, size=(8, 6)).t_lo, certified_picture(shape, size=(8, 6)).t_lo)


def test_deep_graphs_take_no_stack_and_shared_parts_no_time():
    deep = om.sphere(1.0)
    for _ in range(20_000):
        deep = deep.translate(1e-5, 0, 0).round(1e-9)
    found = certified(deep, [0.2, 0, 3], [0, 0, -1], max_distance=10)
    np.testing.assert_allclose(found.t_lo, 3 - (1 + 2e-5), rtol=1e-8)
    shared = om.sphere(1.0)
    for _ in range(60):
        shared = shared.union(shared.round(1e-6), smooth=0.0)
    found = certified(shared, [0, 0, 3], [0, 0, -1], max_distance=10)
    np.testing.assert_allclose(found.t_lo, 2 - 60e-6, rtol=1e-9)


BAD = {
    "a shape": (lambda: certified("ball", [0, 0, 3], [0, 0, -1]), TypeError, "scene"),
    "origins": (lambda: certified(om.sphere(1), [0, 3], [0, 0, -1]), ValueError, "origins"),
    "t_min": (lambda: certified(om.sphere(1), [0, 0, 3], [0, 0, -1], t_min=-1), ValueError, "t_min"),
    "max_distance": (lambda: certified(om.sphere(1), [0, 0, 3], [0, 0, -1], max_distance=0), ValueError, "max_dist"),
    "no max_distance": (
        lambda: certified(om.sphere(1), [0, 0, 3], [0, 0, -1], max_distance=math.nan),
        ValueError,
        "max_distance",
    ),
    "tolerance": (lambda: certified(om.sphere(1), [0, 0, 3], [0, 0, -1], tolerance=0), ValueError, "tolerance"),
    "evaluations": (
        lambda: certified(om.sphere(1), [0, 0, 3], [0, 0, -1], max_evaluations=0),
        ValueError,
        "max_evaluations",
    ),
    "threads": (lambda: certified(om.sphere(1), [0, 0, 3], [0, 0, -1], threads=0), ValueError, "threads"),
    "size": (lambda: certified_picture(om.sphere(1), size=(0, 2)), ValueError, "size"),
    "crop": (lambda: certified_picture(om.sphere(1), size=(4, 2), crop=(0, 0, 9, 1)), ValueError, "crop"),
    "camera": (lambda: certified_picture(om.sphere(1), "front"), TypeError, "camera"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_arguments_are_named(name: str):
    call, error, message = BAD[name]
    with pytest.raises(error, match=message):
        call()


def test_brackets_are_frozen():
    found = certified(om.sphere(1.0), [0, 0, 3], [0, 0, -1])
    with pytest.raises(AttributeError):
        found.t_lo = None
