"""Certified marches against `om.reference.certified`, which believes no Lipschitz bound and knows nothing of roundings:
never a miss where something is, never a hit where nothing is, and no hit farther from the root than its bracket.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import octomarch as om
from octomarch import Status
from octomarch.reference import Verdict
from strategies import PRIMITIVES, Array, Sample, nested

FARTHEST = 30.0
SHAPES: dict[str, om.Shape] = {
    "ball": om.sphere(1.0),
    "floor": om.plane(),
    "thin shell": om.sphere(1.0).shell(1e-5),
    "thin sheet": om.box((2, 2, 2e-6)),
    "twisted box": om.box((1, 3, 1)).twist(60, axis="y"),
    "bent bar": om.box((3, 0.4, 0.4)).bend(40),
    "blend": om.sphere(1.0).union(om.box(1.5).translate(0.9, 0.3, 0.0), smooth=0.25) | om.plane(point=(0, -1, 0)),
    "metaballs": om.metaballs(om.sphere(0.6), om.sphere(0.5, center=(0.9, 0.2, 0)), k=0.2),
    "thin star": om.polygon([(1, 0), (0.2, 0.2), (0, 1), (-0.2, 0.2), (-1, -0.4), (0.1, -0.2)]).extrude(1e-4),
    "windows": om.box((2, 3, 2)) - om.box((0.3, 0.4, 0.3)).repeat((0.5, 0.75, 0.5)),
    "crowd": om.union(*(om.sphere(0.1, center=np.sin([i, 2.1 * i, 3.3 * i])) for i in range(80)), smooth=0.02),
}
PRECISIONS = ["float32", "float64"]


def rays(seed: int, extent: float = 1.5, n: int = 60) -> tuple[Array, Array]:
    """Return rays that float32 holds; a third of them graze planes through their target, or are along axes."""
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(n, 3))
    origins *= rng.uniform(0.1, 3, (n, 1)) * (1 + extent) / np.linalg.norm(origins, axis=1)[:, None]
    directions = rng.normal(scale=0.6 * extent, size=(n, 3)) - origins
    origins[::6, 1] = 10.0 ** rng.uniform(-7, -1, len(origins[::6]))
    directions[::6, 1] *= 10.0 ** rng.uniform(-6, 0, len(origins[::6]))
    directions[1::6] *= np.eye(3)[rng.integers(0, 3, len(directions[1::6]))]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return origins.astype(np.float32).astype(float), directions.astype(np.float32).astype(float)


def check(shape: om.Shape, origins: Array, directions: Array, precision: str, **changes) -> Array:
    """Hold a march against the truth; return the statuses."""
    program = om.compile(shape)
    march = om.March("certified", max_distance=FARTHEST, **changes).resolve(program, origins, pixels=False)
    lengths = np.linalg.norm(directions, axis=1)
    truth = om.reference.certified(shape, origins, directions, max_distance=FARTHEST, max_evaluations=20_000)
    lo, hi = truth.t_lo * lengths, truth.t_hi * lengths
    found = [
        shape.raycast(origins, directions, march=march, precision=precision),
        om.reference.raycast(shape, origins, directions, march=march, dtype=precision),
    ]
    for hits in found:
        status, t = hits.status, hits.t * lengths
        bracket = march.bracket(program, origins, np.where(np.isfinite(t), t, 0), precision)
        before = np.spacing(t.astype(precision)).astype(float) if march.finish is None else bracket
        hit, miss, inside = (status == s for s in (Status.HIT, Status.MISS, Status.INSIDE))
        assert not (hit & np.isin(truth.status, [Verdict.MISS, Verdict.INSIDE])).any()
        assert not (miss & np.isin(truth.status, [Verdict.HIT, Verdict.INSIDE])).any()
        assert not (inside & np.isin(truth.status, [Verdict.HIT, Verdict.MISS])).any()
        assert (lo[hit] <= (t + bracket)[hit]).all()
        assert (hi[hit] >= (t - before)[hit]).all()
        spent = (status == Status.STEP_LIMIT) & (truth.status != Verdict.INSIDE)
        assert (hi[spent] >= t[spent] * (1 - 1e-6)).all()
    decided = [hits.status != Status.STEP_LIMIT for hits in found]
    both = decided[0] & decided[1]
    assert (found[0].status[both] == found[1].status[both]).all()
    return found[0].status


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("name", SHAPES)
def test_named_scenes(name: str, precision: str):
    status = check(SHAPES[name], *rays(1, n=400), precision)
    grazes = np.arange(400) % 6 == 0
    if precision == "float64":
        assert (status[~grazes] == Status.STEP_LIMIT).mean() < 0.02


@pytest.mark.parametrize(
    "changes", [{"finish": None}, {"epsilon": 1e-9}, {"epsilon": 0.01}, {"bias": 1e-4}, {"max_steps": 9}]
)
@pytest.mark.parametrize("name", ["floor", "thin shell", "twisted box", "blend"])
def test_settings(name: str, changes: dict[str, float]):
    for precision in PRECISIONS:
        check(SHAPES[name], *rays(2, n=300), precision, **changes)


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(sample=st.one_of(*PRIMITIVES.values(), nested(2), nested(5)), seed=st.integers(0, 2**31), double=st.booleans())
def test_random_shapes(sample: Sample, seed: int, double: bool):
    program = om.compile(sample.shape)
    assume(not program.is_solid and np.isfinite(program._native.doubt("float32")[0]))
    check(sample.shape, *rays(seed, sample.extent), PRECISIONS[double])


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(sample=st.one_of(*PRIMITIVES.values(), nested(2), nested(5)), seed=st.integers(0, 2**31))
def test_what_is_allowed_for_roundings_holds_them(sample: Sample, seed: int):
    """Float64 stands for the truth of float32."""
    program = om.compile(sample.shape)
    offset, slope, reach = program._native.doubt("float32")
    assume(not program.is_solid and np.isfinite(offset))
    rng = np.random.default_rng(seed)
    points = 10.0 ** rng.uniform(-3, 3, (200, 1)) * rng.normal(size=(200, 3)) * (1 + sample.extent)
    points = points.astype(np.float32).astype(float)
    seen = points - np.array(program.anchor)
    points = points[(seen == seen.astype(np.float32)).all(axis=1)]
    off = np.abs(
        sample.shape.distance(points, precision="float32") - sample.shape.distance(points, precision="float64")
    )
    size = np.abs(points - np.array(program.anchor)).max(axis=1)
    assert (off <= np.where(size <= reach, (offset + slope * size) * program.lipschitz, np.inf)).all()


def test_rays_nearer_to_a_shell_than_any_epsilon():
    """Half of the rays pass the shell at a distance, or dig into it by as much."""
    off = 10.0 ** np.linspace(-9, -2, 50)
    x = 1.0 + 5e-6 + np.concatenate([off, -off])
    origins = np.stack([x, np.zeros(100), np.full(100, 3.0)], axis=1)
    status = check(SHAPES["thin shell"], origins, np.tile([0.0, 0.0, -1.0], (100, 1)), "float64", max_steps=20_000)
    assert (status[:50] != Status.HIT).all()
    assert (status[50:] != Status.MISS).all()
    assert (status[25:50] == Status.MISS).all()
    assert (status[75:] == Status.HIT).all()


@pytest.mark.parametrize("isa", om.isas())
@pytest.mark.parametrize("precision", PRECISIONS)
def test_all_instruction_sets_and_parts_of_programs_give_the_same_bits(isa: str, precision: str):
    camera = om.Camera((3, 2, 6), (0, 0, 0))
    for name in ("crowd", "blend", "twisted box"):
        pictures = [
            om.render(
                SHAPES[name],
                camera,
                (64, 48),
                march=om.March("certified", prune=prune),
                precision=precision,
                planes=("depth", "status", "steps"),
                isa=which,
            )
            for which, prune in (("scalar", False), (isa, True))
        ]
        for plane in ("depth", "status", "steps"):
            np.testing.assert_array_equal(getattr(pictures[0], plane), getattr(pictures[1], plane))
        assert (pictures[0].status == Status.STEP_LIMIT).mean() < 0.05
        assert pictures[0].stats["stages"]["cones"]["evaluations"] == 0


def test_pictures_are_those_of_the_truth():
    camera = om.Camera((3, 2, 6), (0, 0, 0))
    for name in ("twisted box", "thin shell", "metaballs"):
        picture = om.render(
            SHAPES[name],
            camera,
            (64, 48),
            march=om.March("certified", max_distance=FARTHEST),
            precision="float64",
            planes=("depth", "status"),
        )
        truth = om.reference.certified_picture(SHAPES[name], camera, (64, 48), max_distance=FARTHEST)
        assert not ((picture.status == Status.HIT) & (truth.status == Verdict.MISS)).any()
        assert not ((picture.status == Status.MISS) & (truth.status == Verdict.HIT)).any()
        hit = (picture.status == Status.HIT) & (truth.status == Verdict.HIT)
        assert hit.sum() > 100
        pixel = 0.1 * picture.depth[hit] * np.tan(np.radians(camera.fov / 2)) / 48
        assert (np.abs(picture.depth[hit] - truth.t_lo[hit]) <= np.maximum(1e-5, 1.01 * pixel)).all()


def test_coloured_pictures_have_mirrors_and_shadows():
    scene = om.Scene(SHAPES["blend"].paint(om.Material(0.5, reflectivity=0.4)))
    pictures = [
        om.render(scene, om.Camera((3, 2, 4), (0, 0, 0)), (48, 32), march=om.March(method), precision="float64")
        for method in ("certified", "plain")
    ]
    assert np.median(np.abs(pictures[0].color - pictures[1].color)) < 1e-3


@pytest.mark.parametrize(
    "shape",
    [
        om.solid(om.coordinates()[0] < 0),
        om.field(om.floor(om.coordinates()[0]), lipschitz=1),
    ],
)
def test_what_cannot_be_certified_is_an_error(shape: om.Shape):
    with pytest.raises(ValueError, match="method must not be 'certified'"):
        shape.raycast([0, 0, 3], [0, 0, -1], march=om.March("certified"))
    with pytest.raises(ValueError, match="method must not be 'certified'"):
        om.render(shape, size=(8, 8), march=om.March("certified"))


def test_brackets_are_of_resolved_certified_marches():
    program = om.compile(om.sphere(1.0))
    with pytest.raises(ValueError, match="march must be certified and resolved"):
        om.March("certified").bracket(program, (0, 0, 3), 2.0)
    with pytest.raises(ValueError, match="march must be certified and resolved"):
        om.March().resolve(program, (0, 0, 3)).bracket(program, (0, 0, 3), 2.0)
