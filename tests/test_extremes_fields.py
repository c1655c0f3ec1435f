"""Fields in extreme cases: blends of any width, repeats below zero, stretched space, limit shapes, no gradient."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from faces import FACES
from limits import LIMITS
from rounding import unit_roundoff

BALL, BOX = om.sphere(1.0), om.box(1.5, center=(0.9, 0.3, 0))
POINTS = np.random.default_rng(3).normal(size=(500, 3)) * 1.5


def distances(shape: om.Shape, isa: str, precision: str) -> np.ndarray:
    values: np.ndarray = shape.distance(POINTS, precision=precision, isa=isa)
    return values


def test_polynomial_blends_of_any_width(isa: str, precision: str):
    """Of k = 0 it is the hard operator to the bit; the widest is finite, k/4 deep at the most; others are refused."""
    for operator in (om.union, om.intersection, om.difference):
        hard = distances(operator(BALL, BOX), isa, precision)
        assert_array_equal(distances(operator(BALL, BOX, smooth=0), isa, precision), hard)
        wide = distances(operator(BALL, BOX, smooth=1e20), isa, precision)
        assert np.isfinite(wide).all()
        assert (np.abs(wide - hard) <= 1e20 / 4 * (1 + 1e-6)).all()
        for bad in (math.inf, math.nan, -0.1):
            with pytest.raises(ValueError, match="smooth"):
                operator(BALL, BOX, smooth=bad)


def test_polynomial_blends_fold_from_the_left(isa: str, precision: str):
    """The order matters, and is kept."""
    c = om.sphere(0.8, center=(0.3, 1, 0))
    values = distances(om.union(BALL, BOX, c, smooth=0.3), isa, precision)
    assert_array_equal(values, distances(BALL.union(BOX, smooth=0.3).union(c, smooth=0.3), isa, precision))
    other = distances(om.union(c, BOX, BALL, smooth=0.3), isa, precision)
    assert 1e-3 < np.abs(values - other).max() < 0.03


@pytest.mark.parametrize("k", [1e-6, 0.005, 0.3])
def test_exponential_blends_of_any_width(k: float, isa: str, precision: str):
    a, b = BALL.distance(POINTS), BOX.distance(POINTS)
    expected = np.minimum(a, b) - k * np.log1p(np.exp(-np.abs(a - b) / k))
    found = distances(om.metaballs(BALL, BOX, k=k), isa, precision)
    assert_allclose(found, expected, rtol=0, atol=64 * unit_roundoff(precision) * 8)


def test_repeats_below_zero_and_on_ties(isa: str, precision: str):
    """Cells are p - b floor(p / b + 1/2), whichever side of zero; between two cells both are as near."""
    lattice = om.sphere(0.25).repeat((1, 1, 1))
    cells = np.arange(-4, 5, dtype=float)
    centres = np.stack([cells, -cells, cells + 2], axis=1)
    assert_array_equal(lattice.distance(centres, precision=precision, isa=isa), -0.25)
    assert_array_equal(lattice.distance(centres + np.array([0.5, 0, 0]), precision=precision, isa=isa), 0.25)
    for bad in (-1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="period"):
            om.sphere(0.25).repeat((bad, 1, 1))


def test_repeats_of_content_that_is_not_symmetric(isa: str, precision: str):
    """The nearest copy may be the neighbour's: the field never says more than the distance to all of them."""
    content = om.sphere(0.2, center=(0.25, 0.1, -0.2)) | om.box((0.1, 0.3, 0.1), center=(-0.2, -0.2, 0.25))
    copies = [content.translate(i, j, k) for i in range(-7, 8) for j in range(-7, 8) for k in range(-7, 8)]
    near = POINTS[np.abs(POINTS).max(axis=1) < 4][:200]
    expected = om.union(*copies).distance(near)
    found = content.repeat((1, 1, 1)).distance(near, precision=precision, isa=isa)
    rounding = 64 * unit_roundoff(precision) * 8
    assert (found <= expected + rounding).all()
    assert (content.distance(near - np.floor(near + 0.5)) > expected + 0.05).mean() > 0.05, "the neighbour matters"


@pytest.mark.parametrize("ratio", [2.0, 10.0, 20.0])
def test_anisotropic_scale_is_a_lower_bound(ratio: float, isa: str, precision: str):
    """Between the true distance and that over the ratio, where the true one is known: along the axes."""
    egg = om.sphere(1.0).stretch((ratio, 1, 1))
    far = np.array([[ratio + 1, 0, 0], [0, 2, 0], [0, 0, -3], [-ratio - 4, 0, 0]])
    share = egg.distance(far, precision=precision, isa=isa) / [1, 1, 2, 4]
    assert (share <= 1 + 1e-6).all()
    assert (share >= 1 / ratio - 1e-6).all()
    assert om.compile(egg).lipschitz == 1


@pytest.mark.parametrize("operator", [om.difference, om.intersection])
def test_subtraction_and_intersection_are_lower_bounds(operator, isa: str, precision: str):
    """Spheres of the field's radius about points outside hold nothing of the solid."""
    shape = operator(BALL, BOX)
    rng = np.random.default_rng(9)
    values = distances(shape, isa, precision)
    outside = values > 1e-3
    turns = rng.normal(size=(40, outside.sum(), 3))
    turns /= np.linalg.norm(turns, axis=-1)[..., None]
    assert (shape.distance(POINTS[outside] + 0.999 * values[outside, None] * turns) > -1e-6).all()


@pytest.mark.parametrize("name", LIMITS)
def test_shapes_at_their_limits(name: str, isa: str, precision: str):
    """A capsule of one point is a ball, a torus of no radius too, and no field or gradient is NaN."""
    shape = LIMITS[name]
    points = np.concatenate([POINTS[:64], np.zeros((1, 3)), np.eye(3), -np.eye(3)])
    assert np.isfinite(shape.distance(points, precision=precision, isa=isa)).all()
    assert np.isfinite(shape.gradient(points, precision=precision, isa=isa)).all()


def test_normals_where_the_gradient_is_zero(isa: str, precision: str):
    """There the normal is minus the direction of the ray."""
    x, _, _ = om.coordinates()
    flat = om.field(0 * x + 0.5, lipschitz=1.0)
    march = om.March("plain", max_steps=4, max_distance=10)
    direction = np.array([2, -3, 6]) / 7
    hits = flat.raycast([0, 0, 0], direction, march=march, precision=precision, isa=isa)
    assert hits.status == om.Status.STEP_LIMIT
    assert_allclose(hits.normal, -direction, atol=2 * unit_roundoff(precision))
    assert_array_equal(om.sphere(1.0).gradient([0, 0, 0], precision=precision, isa=isa), 0)


@pytest.mark.parametrize("shape", [BALL.union(BOX, smooth=0.25), BALL | BOX, om.ellipsoid((1.5, 0.5, 1))], ids=str)
def test_normals_on_creases_have_unit_length(shape: om.Shape, isa: str, precision: str):
    """Where a blend's gradient is shorter than one its normal is not."""
    image = om.render(shape, size=(40, 30), planes=("normal", "status"), precision=precision, isa=isa)
    hit = image.status == om.Status.HIT
    assert hit.sum() > 200
    assert_allclose(np.linalg.norm(image.normal[hit].astype(float), axis=1), 1, atol=8 * unit_roundoff(precision))


def test_denormal_numbers_stay_what_they_are(isa: str, precision: str):
    """The state of the processor is the host's, in threads of a render too; see test_build_denormals for imports."""
    om.render(BALL - BOX, size=(16, 16), precision=precision, isa=isa)
    assert np.float64(5e-324) * np.float64(1.0) == 5e-324
    tiny = np.full(64, 1e-44, np.float32)
    assert (tiny * np.float32(1) == tiny).all()
    points = np.array([[3e-310, 0, 0]])
    x, _, _ = om.coordinates()
    assert om.field(x, lipschitz=1.0).distance(points, isa=isa) == 3e-310


@pytest.mark.parametrize("normals", ["central", "tetrahedron"])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_normals_by_differences(normals: str, scale: float, isa: str, precision: str):
    """Exact by default; by differences with a step that grows with the scene, so that its error does not."""
    ball = om.sphere(scale)
    camera = om.Camera(np.array([1, 2, 3]) * scale, (0, 0, 0))
    planes = ("normal", "position", "status")
    angles = {}
    for kind in ("exact", normals):
        shading = om.Shading(normals=kind)
        image = om.render(ball, camera, (32, 24), shading=shading, planes=planes, precision=precision, isa=isa)
        hit = image.status == om.Status.HIT
        true = image.position[hit].astype(np.float64) / scale
        off = np.linalg.norm(image.normal[hit] - true / np.linalg.norm(true, axis=1)[:, None], axis=1)
        angles[kind] = np.degrees(np.quantile(off, 0.95))
    assert angles["exact"] < 2e-5
    assert angles[normals] < (0.01 if normals == "central" else 0.12)


@pytest.mark.parametrize("name", FACES)
def test_hits_exactly_on_a_face(name: str, isa: str, precision: str):
    """A ray that ends where the field is 0, at coordinates that floats hold, has the normal of the face."""
    shape, cases = FACES[name]
    points, normals = (np.array(column, float) for column in zip(*cases, strict=True))
    assert_array_equal(shape.distance(points, precision=precision, isa=isa), 0)
    assert_array_equal(shape.gradient(points, precision=precision, isa=isa), normals)
    march = om.March("plain", epsilon=0)
    hits = shape.raycast(points + normals / 4, -normals, march=march, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    assert_allclose(hits.t, 0.25, atol=1e-6)
    assert_allclose(hits.normal, normals / np.linalg.norm(normals, axis=1)[:, None], atol=1e-6)
