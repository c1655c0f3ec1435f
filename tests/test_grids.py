"""Fields by samples: what is between them, how steep it is, how it goes on outside, and that arrays are kept well."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import grid_oracles as oracle
import octomarch as om

KINDS = ("linear", "cubic")
BOX = ((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5))
ROUNDING = {"float32": 3e-6, "float64": 1e-14}
"""Of a field of a few units."""
POINTS = np.random.default_rng(3).normal(scale=1.5, size=(3000, 3))


def places(count: int | tuple[int, int, int], bounds: tuple = BOX) -> np.ndarray:
    """Return where samples lie, shape (3, nx, ny, nz)."""
    counts = (count,) * 3 if isinstance(count, int) else count
    axes = [np.linspace(lo, hi, n) for lo, hi, n in zip(*bounds, counts, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"))


def ball(count: int, kind: str = "linear", radius: float = 1.0) -> om.Shape:
    return om.grid(np.linalg.norm(places(count), axis=0) - radius, BOX, kind)


def noise(size: tuple[int, int, int], seed: int = 1, scale: float = 1.0) -> np.ndarray:
    return (scale * np.random.default_rng(seed).uniform(-1, 1, size)).astype(np.float32)


# Between samples -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [(2, 2, 2), (2, 3, 5), (6, 4, 3)])
def test_grid_is_what_numpy_makes_of_the_samples(kind: str, size: tuple[int, int, int], isa: str, precision: str):
    bounds = np.array([(-1, -0.5, -1.25), (0.75, 1, 1)])
    values = noise(size)
    shape = om.grid(values, bounds, kind)
    steepness = shape._node.parameters[5]
    expected = oracle.field(values.astype(float), bounds, kind, steepness, POINTS)
    tolerance = ROUNDING[precision] * 10
    assert_allclose(shape.distance(POINTS, precision=precision, isa=isa), expected, atol=tolerance, rtol=tolerance)
    assert_allclose(om.reference.distance(shape, POINTS), expected, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_samples_are_met_where_they_lie(kind: str, isa: str):
    values = noise((5, 6, 7), scale=0.1) + 0.5
    p = np.moveaxis(places((5, 6, 7)), 0, -1)
    found = om.grid(values, BOX, kind).distance(p, isa=isa)
    assert_allclose(found, values, atol=1e-6)


@pytest.mark.parametrize(("kind", "degree"), [("linear", 1), ("cubic", 2)])
def test_polynomials_of_its_degree_come_back(kind: str, degree: int):
    """The splines keep what is quadratic, except in the outermost cells, which go on straight."""
    x, y, z = places((6, 7, 8))

    def polynomial(x, y, z):
        return 0.5 + 0.25 * x - 0.125 * y + 0.25 * x * y * z + (degree > 1) * (0.25 * x * x - 0.5 * z * z * y)

    shape = om.grid(polynomial(x, y, z), BOX, kind)
    p = np.random.default_rng(5).uniform(-0.6, 0.6, (500, 3))
    assert_allclose(om.reference.distance(shape, p), polynomial(*p.T), atol=1e-6)  # of samples in 32 bits


@pytest.mark.parametrize("kind", KINDS)
def test_gradients_are_those_of_the_interpolant(kind: str, isa: str):
    shape = om.grid(noise((5, 6, 7)), BOX, kind)
    p = np.random.default_rng(6).uniform(-1.4, 1.4, (2000, 3))
    found = shape.gradient(p, precision="float64", isa=isa)
    assert_allclose(found, om.reference.gradient(shape, p), atol=1e-11)
    h = 1e-6
    steps = [
        shape.distance(p + h * k, precision="float64") - shape.distance(p - h * k, precision="float64")
        for k in np.eye(3)
    ]
    kinks = np.abs(np.stack(steps, -1) / (2 * h) - found).max(axis=1) > 1e-6
    assert kinks.mean() < 0.01


def test_cubic_gradients_do_not_jump():
    def jump(kind: str) -> float:
        shape = om.grid(noise((5, 6, 7)), BOX, kind)
        y, z = np.random.default_rng(7).uniform(-1, 1, (2, 300))
        face = np.full(300, -1.5 + 3 * 2 / 4)
        before, after = (om.reference.gradient(shape, np.stack([face + h, y, z], -1)) for h in (-1e-9, 1e-9))
        return float(np.abs(after - before).max())

    assert jump("cubic") < 1e-6
    assert jump("linear") > 0.1


# How steep -----------------------------------------------------------------------------------------------------------


@given(
    seed=st.integers(0, 2**31),
    kind=st.sampled_from(KINDS),
    size=st.tuples(st.integers(2, 5), st.integers(2, 5), st.integers(2, 5)),
)
def test_slope_is_measured_and_never_too_small(seed: int, kind: str, size: tuple[int, int, int]):
    rng = np.random.default_rng(seed)
    lo = rng.uniform(-2, 0, 3)
    bounds = lo, lo + rng.uniform(0.5, 3, 3)
    shape = om.grid(noise(size, seed), bounds, kind)
    p = rng.uniform(*bounds, (4000, 3))
    slopes = np.linalg.norm(om.reference.gradient(shape, p), axis=1)
    assert slopes.max() <= om.compile(shape).lipschitz * (1 + 1e-12)


def test_linear_slope_is_exact():
    """At the sample where three edges meet that each rise by one per unit."""
    values = np.zeros((3, 3, 3))
    values[1, 1, 1] = 2
    assert om.compile(om.grid(values, ((-2, -4, -2), (2, 4, 2)))).lipschitz == pytest.approx(1.5, rel=1e-9)


def test_cubic_slope_is_tight():
    """Between samples it is met within a few hundredths; a straight field has its own."""
    for values in (noise((4, 5, 6)), np.linalg.norm(places(9), axis=0)):
        shape = om.grid(values, BOX, "cubic")
        p = np.random.default_rng(8).uniform(-1.5, 1.5, (200_000, 3))
        met = np.linalg.norm(om.reference.gradient(shape, p), axis=1).max()
        assert met > 0.9 * om.compile(shape).lipschitz
    x, y, _ = places(6)
    plane = om.grid(0.6 * x + 0.8 * y, BOX, "cubic")
    assert om.compile(plane).lipschitz == pytest.approx(1, rel=1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_values_that_are_no_distances_are_marched_soundly(kind: str):
    """As a scan: a density around a ball, a thousand per unit and none too steep for rays."""
    density = 1000 * np.exp(-2 * np.linalg.norm(places(41), axis=0))
    level = 1000 * np.exp(-2.0)
    shape = om.grid(level - density, BOX, kind)
    assert om.compile(shape).lipschitz > 200
    rng = np.random.default_rng(9)
    origins = rng.normal(size=(500, 3))
    origins *= 6 / np.linalg.norm(origins, axis=1)[:, None]
    targets = rng.normal(scale=0.5, size=(500, 3))
    march = om.March(epsilon=1e-4, max_steps=2000, method="plain")
    hits = shape.raycast(origins, targets - origins, march=march)
    b = np.linalg.norm(np.cross(origins, targets - origins), axis=1) / np.linalg.norm(targets - origins, axis=1)
    assert (hits.status[b < 0.97] == om.Status.HIT).all()
    assert (hits.status[b > 1.03] == om.Status.MISS).all()
    surface = np.linalg.norm(hits.position[hits.status == om.Status.HIT], axis=1)
    assert_allclose(surface, 1, atol=0.01)


# Outside -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_outside_the_field_never_exceeds_the_distance(kind: str):
    """To the ball whose distances the samples are, off by what lies between samples; and is half of it at the least."""
    shape = ball(33, kind)
    p = np.random.default_rng(10).normal(size=(5000, 3)) * np.geomspace(1, 1000, 5000)[:, None]
    p = p[np.abs(p).max(axis=1) > 1.5]
    found, distance = om.reference.distance(shape, p), np.linalg.norm(p, axis=1) - 1
    assert (found <= distance + 1e-3).all()
    assert (found >= 0.5 * distance).all()


def test_distances_to_the_box_are_exact_where_the_solid_fills_it(isa: str):
    filled = om.grid(np.full((3, 4, 5), -9.0), BOX)
    assert_allclose(filled.distance(POINTS, isa=isa), om.box(3.0).distance(POINTS, isa=isa), atol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_field_is_continuous_across_the_box(kind: str):
    shape = om.grid(noise((4, 5, 6)), BOX, kind)
    p = np.random.default_rng(11).uniform(-1.5, 1.5, (3000, 3))
    p[np.arange(3000), np.arange(3000) % 3] = np.where(np.arange(3000) % 2, 1.5, -1.5)
    outward = np.where(np.abs(p) == 1.5, np.sign(p), 0)
    for h in (1e-9, -1e-9):
        assert_allclose(om.reference.distance(shape, p + h * outward), om.reference.distance(shape, p), atol=1e-7)


def test_nothing_within_the_field_over_its_slope(isa: str):
    """Spheres about outer points of that radius hold no point of the solid: what a march rests on."""
    for seed, kind in itertools.product(range(6), KINDS):
        shape = om.grid(noise((5, 5, 5), seed), BOX, kind)
        solid = np.random.default_rng(seed).uniform(-1.5, 1.5, (4000, 3))
        solid = solid[om.reference.distance(shape, solid) <= 0]
        p = np.random.default_rng(seed + 1).normal(scale=2, size=(400, 3))
        radius = shape.distance(p, precision="float64", isa=isa) / om.compile(shape).lipschitz
        nearest = np.linalg.norm(p[:, None] - solid, axis=-1).min(axis=1)
        assert (radius <= nearest + 1e-12).all()


@pytest.mark.parametrize(
    ("factor", "far", "slope"),
    [
        (1.0, 10.0, 1.0),  # may be distances: the box's are too
        (0.75, 10.0, 1.0),
        (0.25, 2.5, 0.25),  # no distances: as steep as the field is
        (40.0, 400.0, 40.0),
    ],
)
def test_steepness_of_the_box_is_one_where_samples_may_be_distances(factor: float, far: float, slope: float):
    x, *_ = places(4)
    shape = om.grid(factor * x, BOX)
    assert float(shape.distance([-11.5, 0, 0])) == pytest.approx(far, rel=1e-6)
    assert om.compile(shape).lipschitz == pytest.approx(slope, rel=1e-6)


def test_pictures_look_at_the_solid_not_at_the_box():
    lo, hi = om.compile(ball(31)).focus
    assert_allclose(lo, [-1.1] * 3, atol=1e-9)  # a cell beyond the last sample within
    assert_allclose(hi, [1.1] * 3, atol=1e-9)
    everywhere, nowhere = (om.grid(np.full((3, 3, 3), value), BOX) for value in (-1.0, 1.0))
    assert om.compile(everywhere).focus == om.compile(nowhere).focus == BOX


# Places, bits, parts -------------------------------------------------------------------------------------------------


def test_turned_grids_are_one_instruction(isa: str):
    shape = om.grid(noise((4, 5, 6)), ((-1, -0.5, -1.25), (0.75, 1, 1)), "cubic")
    for axis, degrees in itertools.product("xyz", (90, 180, -90)):
        turned = shape.scale(1.5).rotate(degrees, axis).translate(1, -2, 0.5)
        assert om.compile(turned).instructions == 1
        expected = om.reference.distance(turned, POINTS)
        assert_allclose(turned.distance(POINTS, precision="float64", isa=isa), expected, atol=1e-13)


def test_grids_have_the_same_bits_everywhere(precision: str):
    shape = om.union(
        *(ball(9, kind).rotate(20 * i).translate(2 * i, 0, 0) for i in range(3) for kind in KINDS), smooth=0.1
    )
    p = np.random.default_rng(12).normal(scale=3, size=(1000, 3))
    values = [shape.distance(p, precision=precision, isa=isa) for isa in om.isas()]
    slopes = [shape.gradient(p, precision=precision, isa=isa) for isa in om.isas()]
    for value, slope in zip(values, slopes, strict=True):
        assert_array_equal(value, values[0])
        assert_array_equal(slope, slopes[0])
    assert_array_equal(shape.distance(p[:77], precision=precision), values[0][:77])


@pytest.mark.parametrize("kind", KINDS)
def test_many_grids_are_pruned_and_keep_their_bits(kind: str, isa: str):
    one = ball(12, kind)
    places_of = np.random.default_rng(13).uniform(-20, 20, (150, 3))
    shape = om.union(*(one.rotate(7.0 * i, "y").translate(*place) for i, place in enumerate(places_of)), smooth=0.2)
    camera = om.Camera((30, 20, 40), (0, 0, 0), fov=50)
    pictures = [
        om.render(shape, camera, size=(80, 60), planes=("depth", "steps"), march=om.March(prune=prune), isa=isa)
        for prune in (True, False)
    ]
    assert_array_equal(pictures[0].depth, pictures[1].depth)
    assert_array_equal(pictures[0].steps, pictures[1].steps)
    assert np.isfinite(pictures[0].depth).mean() > 0.05


def test_mirrored_samples_need_no_second_cell_of_a_repeat():
    """A ball's samples are the same from both sides; those that lean along x are not."""
    even = ball(8)
    assert om.compile(even.repeat((4, 4, 4))).instructions == 2
    leaning = om.grid(np.linalg.norm(places(8) - 0.3 * np.eye(3)[0][:, None, None, None], axis=0) - 0.5, BOX)
    assert om.compile(leaning.repeat((4, 4, 4))).instructions > 2


def test_certified_march_finds_what_samples_say():
    shape = ball(17, "cubic")
    origins = np.random.default_rng(14).normal(size=(40, 3))
    origins *= 5 / np.linalg.norm(origins, axis=1)[:, None]
    found = om.reference.certified(shape, origins, -origins, max_distance=20)
    assert (found.status == om.reference.Verdict.HIT).all()
    hits = shape.raycast(origins, -origins, march=om.March("certified"), t_max=2)
    assert (hits.status == om.Status.HIT).all()
    assert_allclose(hits.t, found.t_lo, atol=1e-4)


def test_picture_of_a_sampled_ball_is_that_of_the_ball():
    camera = om.Camera((1, 2, 4), (0, 0, 0), fov=40)
    sampled, true = (
        om.render(s, camera, size=(96, 72), planes=("depth", "normal")) for s in (ball(65, "cubic"), om.sphere(1.0))
    )
    both = np.isfinite(sampled.depth) & np.isfinite(true.depth)
    assert (np.isfinite(sampled.depth) != np.isfinite(true.depth)).mean() < 0.01
    assert np.quantile(np.abs(sampled.depth[both] - true.depth[both]), 0.95) < 1e-3
    assert np.quantile(np.linalg.norm(sampled.normal - true.normal, axis=-1)[both], 0.95) < 0.01


# Arrays --------------------------------------------------------------------------------------------------------------


def test_equal_samples_are_one_object_and_copies_of_a_shape_share_it():
    values = noise((20, 21, 22))
    shape = om.grid(values, BOX)
    assert om.grid(values.copy(), BOX) == shape
    assert om.grid(values.astype(np.float64), BOX) == shape
    assert om.grid(values, BOX, "cubic") != shape
    held = shape._node.texels
    assert_array_equal(held, values)
    moved = shape.translate(1, 2, 3).scale(2)
    assert np.shares_memory(held, moved._node.children[0].children[0].texels)


def test_later_changes_to_the_array_do_not_reach_the_shape():
    values = noise((4, 4, 4))
    shape = om.grid(values, BOX)
    before = shape.distance(POINTS)
    values[:] = 9
    assert_array_equal(shape.distance(POINTS), before)
    with pytest.raises(ValueError, match="read-only"):
        shape._node.texels[0, 0, 0] = 1


@pytest.mark.parametrize("kind", KINDS)
def test_grids_come_back_from_files_bit_for_bit(kind: str, tmp_path):
    values = noise((7, 5, 6))
    values[0, 0, 0] = np.float32(1e-45)
    scene = om.Scene(om.grid(values, BOX, kind) | om.sphere(0.2))
    scene.save(tmp_path / "scene.json")
    loaded = om.load(tmp_path / "scene.json")
    assert loaded == scene
    assert_array_equal(loaded.shape.distance(POINTS), scene.shape.distance(POINTS))


def test_order_of_memory_and_kind_of_numbers_do_not_matter():
    values = np.arange(60).reshape(3, 4, 5)
    shape = om.grid(values, BOX)
    assert om.grid(np.asfortranarray(values), BOX) == shape
    assert om.grid(values.tolist(), BOX) == shape
    assert om.grid(np.transpose(values.astype(float).transpose(2, 1, 0).copy()), BOX) == shape


# Bad arguments -------------------------------------------------------------------------------------------------------

VALUES = noise((3, 3, 3))


def spoilt(value: float) -> np.ndarray:
    values = np.zeros((3, 4, 5))
    values[1, 2, 3] = value
    return values


@pytest.mark.parametrize(
    ("build", "error", "message"),
    [
        (
            lambda: om.grid(np.zeros((3, 3)), BOX),
            ValueError,
            r"values must have shape \(nx, ny, nz\), got shape \(3, 3\)",
        ),
        (
            lambda: om.grid(np.zeros((3, 1, 3)), BOX),
            ValueError,
            r"values must be an array with 2 or more .*got \(3, 1, 3\)",
        ),
        (lambda: om.grid(spoilt(np.nan), BOX), ValueError, r"values\[1, 2, 3\] must be finite in 32 bits, got nan"),
        (lambda: om.grid(spoilt(-np.inf), BOX), ValueError, r"values\[1, 2, 3\] must be finite in 32 bits, got -inf"),
        (lambda: om.grid(spoilt(1e39), BOX), ValueError, r"values\[1, 2, 3\] must be finite in 32 bits, got inf"),
        (
            lambda: om.grid(np.zeros((3, 3, 3), complex), BOX),
            TypeError,
            "values must be real numbers, got an array of dtype complex",
        ),
        (lambda: om.grid("abc", BOX), TypeError, "values must be real numbers"),
        (lambda: om.grid([[[1, 2], [3]]], BOX), ValueError, "values must have shape"),
        (
            lambda: om.grid(VALUES, ((0, 0, 0), (1, 0, 1))),
            ValueError,
            r"bounds must be two finite corners.*got \(0, 0, 0\) and \(1, 0, 1\)",
        ),
        (lambda: om.grid(VALUES, ((0, 0, 0), (1, np.inf, 1))), ValueError, "bounds must be two finite corners"),
        (lambda: om.grid(VALUES, ((0, 0, 0), (1, np.nan, 1))), ValueError, "bounds must be two finite corners"),
        (lambda: om.grid(VALUES, ((0, 0, 0),)), ValueError, "bounds must be two corners"),
        (lambda: om.grid(VALUES, 3), TypeError, "bounds must be two corners, got 3"),
        (lambda: om.grid(VALUES, ((0, 0), (1, 1))), ValueError, r"bounds\[0\] must be three numbers"),
        (
            lambda: om.grid(VALUES, BOX, "nearest"),
            ValueError,
            "interpolation must be one of 'linear', 'cubic', got 'nearest'",
        ),
        (
            lambda: om.grid(3e38 * VALUES, ((0, 0, 0), (1e-300, 1, 1))),
            ValueError,
            "values must be such that their slope is finite",
        ),
    ],
)
def test_bad_arguments_are_named(build, error, message: str):
    with pytest.raises(error, match=f"^{message}"):
        build()
