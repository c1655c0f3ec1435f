"""Where rays begin, by how much steps stay short, and fixed steps: against closed forms, and bit by bit against the
reference where arithmetic is exact.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from closed_forms import SOLIDS, Array, FirstRoot
from octomarch.planes import PLANES
from strategies import Sample, nested
from test_march import ORIGINS, UNIT, hit_epsilon, outside
from test_render_planes import CAMERA, SUN, check_unmet

BOXES = om.box((1, 2, 1)) - om.box((0.5, 4, 0.25)) | om.box((4, 0.25, 4)).translate(0, -2, 0)
"""Along the axes, from points on a lattice, every number in its marches is one that floats hold exactly."""
LATTICE = np.stack(np.meshgrid(*[np.arange(-24, 24, 5) / 8 + 1 / 16] * 3), -1).reshape(-1, 3)
AXES = np.concatenate([np.eye(3), -np.eye(3)])
STEP = 2.0**-6


def check_same(marches: dict, origins: Array, directions: Array, precision: str, isa: str) -> om.Hits:
    """Status, steps and t are those of the reference, to the bit."""
    march = om.March(max_distance=8, epsilon=2.0**-12, **marches)
    found = BOXES.raycast(origins, directions, march=march, precision=precision, isa=isa)
    truth = om.reference.raycast(BOXES, origins, directions, march=march, dtype=precision)
    for name in ("status", "steps", "t", "position"):
        assert_array_equal(getattr(found, name), getattr(truth, name), err_msg=name)
    return found


@settings(max_examples=20)
@given(
    method=st.sampled_from(["plain", "fixed"]),
    min_distance=st.sampled_from([0, 0.25, 1.5, 3]),
    bias=st.sampled_from([0, STEP, 0.5, 8]),
    finish=st.sampled_from(["secant", None]),
    max_steps=st.sampled_from([1, 5, 40, 2000]),
)
def test_marches_along_axes_are_those_of_the_reference(isa: str, precision: str, method: str, **marches):
    step = STEP if method == "fixed" else None
    for axis in AXES:
        check_same({"method": method, "step": step, **marches}, LATTICE[::3], axis, precision, isa)


def test_such_marches_end_in_every_way(isa: str):
    hits = [
        check_same({"method": method, "max_steps": 12, "min_distance": 1.5}, LATTICE, axis, "float64", isa)
        for axis in AXES
        for method in ("plain", "fixed")
    ]
    for status in (om.Status.HIT, om.Status.MISS, om.Status.STEP_LIMIT, om.Status.INSIDE):
        assert sum((h.status == status).sum() for h in hits) > 20, status


# Where rays begin -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["plain", "fixed"])
def test_rays_begin_at_the_least_distance(method: str, isa: str, precision: str):
    """It counts in scene units, t in lengths of the direction. What lies before it is not seen."""
    plates = om.box((1, 1, 0.5)).repeat((0, 0, 2))
    march = om.March(method, min_distance=2)
    hits = plates.raycast([0, 0, 0.5], [[0, 0, 1], [0, 0, 2]], march=march, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.HIT)
    assert_allclose(hits.t, [3.25, 1.625], rtol=1e-5)
    inside = plates.raycast([0, 0, 0.5], [0, 0, 4], march=om.March(method, min_distance=1.5), isa=isa)
    assert (inside.status, inside.t, inside.steps) == (om.Status.INSIDE, 1.5 / 4, 1)


@pytest.mark.parametrize("method", ["plain", "fixed"])
def test_rays_that_begin_beyond_their_end_are_misses_and_cost_nothing(method: str, isa: str, precision: str):
    march = om.March(method, min_distance=4)
    directions = np.repeat([[0, 0, -1.0], [0, 0, np.nan]], 40, axis=0)
    options = {"march": march, "t_max": 3.5}
    hits = om.sphere(1.0).raycast([0, 0, 3], directions, precision=precision, isa=isa, **options)
    assert_array_equal(hits.status, [om.Status.MISS] * 40 + [om.Status.INVALID] * 40)
    assert_array_equal(hits.steps, 0)
    assert np.isposinf(hits.t).all()
    truth = om.reference.raycast(om.sphere(1.0), [0, 0, 3], directions, **options)
    assert_array_equal(truth.status, hits.status)
    assert_array_equal(truth.steps, 0)


def test_only_some_rays_of_a_packet_may_begin_beyond_their_end(isa: str):
    directions = np.array([[0, 0, -1.0]] * 13) * np.arange(1, 14)[:, None]
    march = om.March("enhanced", min_distance=1)
    hits = om.sphere(1.0).raycast([0, 0, 3], directions, march=march, t_max=0.2, isa=isa)
    assert_array_equal(hits.status == om.Status.MISS, np.arange(1, 14) < 10)
    assert_array_equal(hits.steps == 0, np.arange(1, 14) < 5)


def test_pictures_begin_at_the_least_distance_and_shadows_do_not(isa: str, precision: str):
    shape = om.plane(point=(0, -1, 0)) | om.sphere(0.5) | om.sphere(0.25, center=(0, 0.5, 3.5))
    scene = om.Scene(shape, lights=[SUN], ambient=0.3)
    options = {"planes": tuple(PLANES), "precision": precision, "isa": isa}
    camera = om.Camera((0, 0.5, 5), (0, 0.5, 0))
    nearer = om.render(scene, camera, (40, 40), march=om.March(min_distance=1.5, max_distance=50), **options)
    without = om.render(
        om.Scene(om.plane(point=(0, -1, 0)) | om.sphere(0.5), lights=[SUN], ambient=0.3),
        camera,
        (40, 40),
        march=om.March(max_distance=50),
        **options,
    )
    behind = nearer.status == om.Status.INSIDE
    assert 0.05 < behind.mean() < 0.3
    assert_array_equal(nearer.depth[behind], 1.5)
    assert_array_equal(nearer.color[behind], 0)
    seen = (without.status == om.Status.HIT) & (nearer.status == om.Status.HIT) & (np.abs(without.depth - 11) < 8)
    assert seen.mean() > 0.3
    assert np.quantile(np.abs(nearer.depth[seen] - without.depth[seen]), 0.99) < 1e-3
    assert np.quantile(np.abs(nearer.color[seen] - without.color[seen]), 0.9) < 1e-3


@pytest.mark.parametrize("method", ["plain", "fixed"])
def test_mirrors_show_what_is_nearer_than_the_least_distance(method: str, isa: str):
    """A ball just above a mirror, seen from below it in the mirror only."""
    mirror = om.plane(point=(0, -1, 0)).paint(om.Material(0.0, specular=0, reflectivity=1.0))
    ball = om.sphere(0.25, center=(0, -0.5, 0)).paint(om.Material((1.0, 0.0, 0.0)))
    scene = om.Scene(mirror | ball, ambient=1.0, sky=om.Sky(toward=0, away=0, base=0))
    march = om.March(method, min_distance=1.5, max_distance=20)
    settings = {"shading": om.Shading(bounces=1, occlusion=0), "march": march}
    camera = om.Camera((0, 2, 6), (0, -1, 0), fov=20)
    image = om.render(scene, camera, (40, 40), planes=("color", "object_id"), isa=isa, **settings)
    seen_in_mirror = (image.object_id == 0) & (image.color[..., 0] > 0.3)
    assert seen_in_mirror.sum() > 20
    truth = om.reference.render(scene, camera, (40, 40), **settings)
    assert np.quantile(np.abs(image.color - truth.color), 0.97) < 1e-3


# By how much steps stay short -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["plain", "fixed"])
def test_a_bias_shortens_each_step(method: str, isa: str, precision: str):
    """Along a plane at height 1 steps are all alike: 16 of three quarters reach 12, and one goes beyond."""
    march = om.March(method, bias=0.25, max_distance=12)
    hits = om.plane().raycast([0, 1, 0], [1, 0, 0], march=march, precision=precision, isa=isa)
    assert (hits.status, hits.steps) == (om.Status.MISS, 17)


def test_a_bias_takes_no_more_than_half_a_step(isa: str, precision: str):
    """So rays arrive, whatever it is: from height 1 straight down, 2^-10 is reached after ten halvings."""
    for bias in (0.5, 1.0, 1e30, 1e300):
        march = om.March(bias=bias, epsilon=2.0**-10)
        hits = om.plane().raycast([0, 1, 0], [0, -1, 0], march=march, precision=precision, isa=isa)
        assert (hits.status, hits.steps, hits.t) == (om.Status.HIT, 11, 1)


def test_a_small_bias_changes_hits_no_more_than_their_tolerance(isa: str, precision: str):
    march, biased = (om.March(epsilon=1e-4, max_distance=100, bias=bias) for bias in (0.0, 1e-3))
    shape = om.torus(1.0, 0.4)
    plain = shape.raycast(ORIGINS, UNIT, march=march, precision=precision, isa=isa)
    short = shape.raycast(ORIGINS, UNIT, march=biased, precision=precision, isa=isa)
    assert np.mean(plain.status == short.status) > 0.99  # a ray that grazes may end otherwise
    hit = (plain.status == om.Status.HIT) & (short.status == om.Status.HIT)
    assert np.quantile(np.abs(plain.t[hit] - short.t[hit]), 0.95) < 1e-4
    assert short.steps[hit].sum() > plain.steps[hit].sum()


# Fixed steps ----------------------------------------------------------------------------------------------------------


@pytest.fixture(params=SOLIDS)
def solid(request: pytest.FixtureRequest) -> tuple[om.Shape, FirstRoot]:
    return SOLIDS[request.param]


@pytest.mark.parametrize("finish", ["secant", None])
def test_fixed_steps_find_the_first_roots(
    solid: tuple[om.Shape, FirstRoot], finish: str | None, isa: str, precision: str
):
    """Rays end outside within a 1024th of a step of the root, or within a step inside without a finish."""
    shape, first_root = solid
    rays = outside(shape)
    origins, unit = ORIGINS[rays], UNIT[rays]
    root = first_root(origins, unit)
    march = om.March("fixed", step=0.02, max_distance=100, finish=finish)
    hits = shape.raycast(origins, unit, march=march, precision=precision, isa=isa)
    deep = np.isfinite(root)
    deep[deep] = om.reference.distance(shape, (origins + (root + 0.02)[:, None] * unit)[deep]) < 0
    assert deep.sum() > 100
    assert_array_equal(hits.status[deep], om.Status.HIT)
    past = hits.t[deep] - root[deep]
    rounding = hit_epsilon(origins, root, precision, 0)[deep]
    slack = 16 * rounding  # of flat rays, whose root moves by more than the field errs
    if finish:
        assert (past <= slack).all()
        assert (past >= -0.02 / 1024 - slack).all()
    else:
        assert (past >= -slack).all()
        assert (past <= 0.02 + slack).all()
    assert_array_equal(hits.status[np.isinf(root)], om.Status.MISS)


@pytest.mark.parametrize("finish", ["secant", None])
def test_fixed_steps_find_solids_without_distances(finish: str | None, isa: str, precision: str):
    x, y, z = om.coordinates()
    ball = om.solid(x * x + y * y + z * z <= 1)
    origins, unit = ORIGINS[:200], UNIT[:200]
    march = om.March("fixed", step=2.0**-5, max_distance=8, finish=finish)
    hits = ball.raycast(origins, unit, march=march, precision=precision, isa=isa)
    along = -np.einsum("ij,ij->i", origins, unit)
    apart = np.sqrt(np.einsum("ij,ij->i", origins, origins) - along**2)
    assert_array_equal(hits.status[apart > 1 + 1e-5], om.Status.MISS)
    met = apart < np.sqrt(1 - 2.0**-12)  # by a chord no shorter than a step
    assert met.sum() > 50
    assert_array_equal(hits.status[met], om.Status.HIT)
    past = hits.t[met] - (along - np.sqrt(np.maximum(1 - apart**2, 0)))[met]
    rounding = 1e-3 if precision == "float32" else 1e-11  # of squares near 1, seen along flat rays
    low, high = (-(2.0**-15), 0.0) if finish else (0.0, 2.0**-5)
    assert (past >= low - rounding).all()
    assert (past <= high + rounding).all()
    assert_array_equal(hits.steps[apart > 1 + 1e-5], 8 * 2**5 + 1)


def test_pictures_of_solids_look_like_those_of_their_distances(isa: str):
    x, y, z = om.coordinates()
    options = {"planes": ("color", "depth", "normal", "status"), "isa": isa}
    march, shading = om.March("fixed", step=0.01, max_distance=8), om.Shading(shadows="hard", occlusion=0)
    pictures = [
        om.render(om.Scene(shape, lights=[SUN], ambient=0.3), CAMERA, (40, 30), march=march, shading=shading, **options)
        for shape in (om.solid(x * x + y * y + z * z <= 1), om.sphere(1.0))
    ]
    both = np.all([image.status == om.Status.HIT for image in pictures], axis=0)
    assert both.sum() > 100
    assert np.mean(pictures[0].status == pictures[1].status) > 0.99
    assert np.abs(pictures[0].depth[both] - pictures[1].depth[both]).max() < 1e-3
    assert np.quantile(np.abs(pictures[0].color[both] - pictures[1].color[both]), 0.9) < 0.2  # normals are rough


def test_fixed_steps_are_the_field_or_the_step(isa: str, precision: str):
    """Along a plane steps are its height, or 1/64 where that is more."""
    heights = np.array([2.0**-9, 2.0**-6, 0.25])
    march = om.March("fixed", step=2.0**-6, max_distance=4)
    origins = np.stack([0 * heights, heights, 0 * heights], -1)
    hits = om.plane().raycast(origins, [1, 0, 0], march=march, precision=precision, isa=isa)
    assert_array_equal(hits.status, om.Status.MISS)
    assert_array_equal(hits.steps, [4 * 64 + 1, 4 * 64 + 1, 4 * 4 + 1])


def test_what_is_thinner_than_a_step_may_be_stepped_over(isa: str):
    plate = om.box((4, 4, 2.0**-8)).translate(0, 0, -(2.0**-5) - 2.0**-7)
    march = om.March("fixed", step=2.0**-4, max_distance=1)
    assert plate.raycast([0, 0, 0], [0, 0, -1], march=march, isa=isa).status == om.Status.MISS
    assert plate.raycast([0, 0, 0], [0, 0, -1], march=om.March(max_distance=1), isa=isa).status == om.Status.HIT


def test_the_finish_of_fixed_steps_is_counted(isa: str):
    """Ten halvings for each hit; a ray that the field has led exactly onto a surface has them too."""
    ball = om.sphere(1.0)
    march, bare = om.March("fixed", step=0.01), om.March("fixed", step=0.01, finish=None)
    image = om.render(ball, CAMERA, (50, 38), march=march, planes=("steps", "status"), isa=isa)
    plain = om.render(ball, CAMERA, (50, 38), march=bare, planes=("steps", "status"), isa=isa)
    assert_array_equal(image.steps, plain.steps)
    hits = (image.status == om.Status.HIT).sum()
    assert hits > 100
    assert plain.stats["stages"]["primary"]["evaluations"] == plain.steps.sum()
    assert image.stats["stages"]["primary"]["evaluations"] == image.steps.sum() + 10 * hits


@pytest.mark.parametrize("distance", [3.0, 1000.0])
def test_steps_suffice_unless_they_are_limited(distance: float, isa: str, precision: str):
    """Also where a step is few units in the last place of t, and each addition is off by some of one."""
    step = distance / 6000
    march = om.March("fixed", step=step, max_distance=distance)
    hits = om.plane().raycast([0, step / 7, 0], [1, 0, 0], march=march, precision=precision, isa=isa)
    assert hits.status == om.Status.MISS
    limited = om.March("fixed", step=step, max_distance=distance, max_steps=100)
    hits = om.plane().raycast([0, step / 7, 0], [1, 0, 0], march=limited, precision=precision, isa=isa)
    assert (hits.status, hits.steps) == (om.Status.STEP_LIMIT, 100)
    assert hits.t == pytest.approx(100 * step, rel=1e-4)


def test_steps_smaller_than_rounding_get_on(isa: str):
    march = om.March("fixed", step=1e-30, max_distance=2e6, min_distance=1e6, max_steps=2_000_000)
    hits = om.plane().raycast([0, 1e-30, 0], [1, 0, 0], march=march, precision="float32", isa=isa)
    assert hits.status == om.Status.MISS


@pytest.mark.parametrize("method", ["plain", "fixed"])
def test_pictures_of_both_methods_show_the_same(method: str, isa: str):
    shape = om.sphere(1.0).union(om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25) | om.plane(point=(0, -1, 0))
    scene = om.Scene(shape, ambient=0.2, lights=[SUN, om.PointLight((3, 3, 3), 5)])
    planes = ("color", "depth", "status", "normal")
    march = om.March(method, max_distance=20)
    image = om.render(scene, CAMERA, (60, 45), march=march, planes=planes, isa=isa)
    truth = om.reference.render(scene, CAMERA, (60, 45), march=om.March("fixed", max_distance=20), planes=planes)
    hit = (image.status == om.Status.HIT) & (truth.status == om.Status.HIT)
    assert hit.mean() > 0.5
    assert np.mean(image.status == truth.status) > 0.99
    assert np.quantile(np.abs(image.depth[hit] - truth.depth[hit]), 0.99) < 1e-3
    assert np.quantile(np.abs(image.color[hit] - truth.color[hit]), 0.9) < 1e-2  # penumbras know their samples


@pytest.mark.parametrize("finish", ["secant", None])
@pytest.mark.parametrize("shadows", ["hard", "soft"])
def test_surfaces_that_fixed_steps_found_cast_no_shadow_on_themselves(finish: str | None, shadows: str, isa: str):
    scene = om.Scene(om.sphere(1.0), lights=[om.DirectionalLight((0, 0, -1))])
    march = om.March("fixed", step=0.01, finish=finish)
    settings = om.Shading(shadows=shadows, shadow_k=1e30)
    image = om.render(scene, CAMERA, (40, 40), march=march, shading=settings, planes=("color", "normal"), isa=isa)
    lit = image.normal[..., 2] > 0.1
    assert lit.mean() > 0.1
    assert (image.color[lit] > 0).all()


# Both -----------------------------------------------------------------------------------------------------------------

MARCHES = {
    "begins": {"min_distance": 0.75},
    "biased": {"bias": 0.01},
    "fixed": {"method": "fixed", "step": 0.03},
    "fixed, unfinished": {"method": "fixed", "step": 0.03, "finish": None, "min_distance": 0.5, "bias": 0.01},
}


@settings(max_examples=12)
@given(sample=nested(), march=st.sampled_from(sorted(MARCHES)))
def test_no_picture_has_a_nan(isa: str, precision: str, sample: Sample, march: str):
    scene = om.Scene(sample.shape, ambient=0.25, lights=[SUN, om.PointLight((3, 3, 3), 5)])
    limits = om.March(max_steps=30, **MARCHES[march])
    image = om.render(scene, CAMERA, (13, 9), march=limits, planes=tuple(PLANES), precision=precision, isa=isa)
    begins = limits.min_distance
    assert_array_equal(image.depth[image.status == om.Status.INSIDE], np.array(begins, image.depth.dtype))
    image.depth[image.status == om.Status.INSIDE] = 0
    check_unmet(image)


@pytest.mark.parametrize("march", MARCHES)
@pytest.mark.parametrize("count", [1, 7, 8, 9, 63, 65, 600])
def test_no_ray_depends_on_its_company_or_the_instruction_set(march: str, count: int, isa: str, precision: str):
    shape = om.torus(1.0, 0.4) - om.box(0.9)
    limits = om.March(max_distance=50, max_steps=200, **MARCHES[march])
    alone = shape.raycast(ORIGINS, UNIT, march=limits, precision=precision, isa="scalar")
    hits = shape.raycast(ORIGINS[-count:], UNIT[-count:], march=limits, precision=precision, isa=isa)
    for name in ("t", "position", "normal", "steps", "status"):
        assert getattr(hits, name).tobytes() == getattr(alone, name)[-count:].tobytes(), name


def test_settings_left_open_follow_from_the_scene():
    program = om.compile(om.box((3, 4, 12)))
    fixed = om.March("fixed", max_distance=26, min_distance=13).resolve(program, (0, 0, 20))
    assert fixed.step == pytest.approx(0.013)
    assert fixed.max_steps == 1069  # 13 / 0.013, and a fifteenth more
    plain = om.March().resolve(program, (0, 0, 20))
    assert (plain.step, plain.max_steps) == (None, 256)
    behind = om.March(min_distance=1e3).resolve(program, (0, 0, 20))
    assert 1e3 < behind.max_distance < 1e3 + 1e-9
    assert om.render(om.box(1.0), CAMERA, (4, 4), march=om.March(min_distance=1e3)).color.shape == (4, 4, 3)


@pytest.mark.parametrize("size", [1e-320, 1e-300, 1e300, 1.7e308])
def test_settings_are_numbers_however_large_the_scene(size: float):
    x, _, _ = om.coordinates()
    shapes = [om.box(size), om.box(1.0).translate(size, 0, 0) | om.plane((0, 1, 0)), om.box(size) & om.solid(x < 1)]
    for shape in [*shapes, om.metaballs(om.box(1.0), om.sphere(1.0), k=size)]:
        program = om.compile(shape)
        for method in ("plain", "fixed"):
            march = om.March(method).resolve(program, (size, -size, 0))
            assert np.isfinite([march.epsilon, march.max_distance, march.max_steps, march.step or 1]).all()
        assert program.focus is None or np.isfinite(program.focus).all()
        assert np.isfinite(om.Shading().resolve(program).occlusion_distance)


def test_metadata_hold_the_settings():
    march = om.March("fixed", bias=0.5, min_distance=0.25)
    found = om.render(om.sphere(1.0), CAMERA, (4, 4), march=march).metadata["march"]
    assert (found["method"], found["bias"], found["min_distance"]) == ("fixed", 0.5, 0.25)
    assert found["step"] > 0
