"""The peers of the benchmarks do octomarch's work: same fields, same pictures, and who cannot is reported.

Libraries that are not installed are skipped; numpy is always there.
"""

import importlib.util
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import octomarch as om

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
POINTS = 2000
SIZE = (64, 48)
# Values of up to 20 units in float32, after a few dozen operations; scene C has hundreds, most of which change nothing.
FIELD_TOLERANCE = 2e-5
# Rays may end one step earlier or later where the field is within rounding of epsilon.
STEP_TOLERANCE = 2e-3
ODD_PIXELS = 0.01
LIBRARIES = {"drjit": "drjit", "numba-packets": "numba", "numba-rays": "numba", "jax": "jax", "warp": "warp"}
LIBRARIES |= {"taichi": "taichi", "numpy": "numpy"}


@pytest.fixture(autouse=True)
def _benchmarks_are_importable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))


@pytest.fixture
def task(request: pytest.FixtureRequest) -> Any:
    import compare

    scene, mode = request.param
    return compare.task_of(scene, mode, 30 if scene == "C" else 0, SIZE)


@pytest.fixture
def client(request: pytest.FixtureRequest) -> Iterator[Any]:
    """Start the peer of that key, as compare.py does but with the interpreter of the tests."""
    peer = str(request.param)
    from peers.client import Client
    from peers.registry import PEERS

    if importlib.util.find_spec(LIBRARIES[peer]) is None:
        pytest.skip(f"{LIBRARIES[peer]} is not installed")
    if peer == "drjit" and not list(Path("/usr/lib").glob("*/libLLVM-19.so")):
        pytest.skip("Dr.Jit ends the process where it has no LLVM 19")
    contender = next(found for found in PEERS if found.key == peer)
    started = Client(contender, Path(sys.executable), max(os.sched_getaffinity(0)), patience=300)
    yield started
    started.close()


@pytest.mark.parametrize("task", [("A", "depth"), ("B", "depth"), ("C", "depth")], indirect=True, ids=["A", "B", "C"])
def test_text_of_the_fields_agrees_with_octomarch(task: Any):
    from peers import numpy_active, octomarch_engine

    points = np.random.default_rng(7).uniform(-8, 8, (POINTS, 3)).astype(np.float32)
    found = numpy_active.field_of(task)(*points.T)
    assert found.dtype == np.float32
    expected = octomarch_engine.shape_of(task).distance(points)
    np.testing.assert_allclose(found, expected, rtol=0, atol=FIELD_TOLERANCE)


@pytest.mark.parametrize("client", LIBRARIES, indirect=True)
def test_peer_renders_octomarchs_pictures(client: Any):
    import compare
    from peers import octomarch_engine

    for scene in ("A", "B", "C"):
        for mode in ("depth", "shaded"):
            task = compare.task_of(scene, mode, 30 if scene == "C" else 0, SIZE)
            assert client.ask("prepare", task=task.to_json(), picture=str(client.picture))["first_seconds"] > 0
            picture = np.load(client.picture)
            expected = octomarch_engine.prepare(task)()
            assert picture.dtype == np.float32
            assert picture.shape == expected.shape
            same = np.isclose(picture, expected, rtol=0, atol=STEP_TOLERANCE)  # equal infinities are close
            assert (~same).mean() <= ODD_PIXELS, f"{scene}, {mode}"
    assert client.ask("round").keys() == {"wall", "cpu"}


def test_task_survives_json():
    import json

    import compare
    from peers.tasks import Task

    for scene, n in (("A", 0), ("C", 12)):
        task = compare.task_of(scene, "shaded", n, SIZE)
        assert Task.from_json(json.loads(json.dumps(task.to_json()))) == task


def test_peer_that_cannot_start_is_reported():
    from peers.client import Client, GoneError
    from peers.registry import Contender

    nobody = Contender("nobody", "nobody", "no_such_peer", ("numpy",), "")
    with pytest.raises(GoneError, match=r"ModuleNotFoundError: No module named 'peers\.no_such_peer'"):
        Client(nobody, Path(sys.executable), max(os.sched_getaffinity(0)), patience=60)


def test_peer_that_was_not_installed_gets_a_row_with_the_reason():
    import compare
    from peers import rounds
    from peers.registry import PEERS

    entry = rounds.Entry(PEERS[0], Path(sys.executable), 0, 60, absent="not installed: no such package")
    task = compare.task_of("A", "depth", 0, SIZE)
    rows, times = rounds.compare([entry], task, 3, 20)
    assert [(row["status"], row["reason"]) for row in rows] == [("failed", "not installed: no such package")]
    assert times == {}


def test_peer_that_would_take_too_long_gets_a_row_with_the_reason():
    import compare
    from peers import rounds
    from peers.registry import PEERS

    entry = rounds.Entry(PEERS[0], Path(sys.executable), 0, 60)
    entry.seconds["C", "depth"] = 200, 5.0
    ready, rows, _ = rounds.prepare([entry], compare.task_of("C", "depth", 2000, SIZE), 20)
    assert not ready
    assert rows[0]["status"] == "skipped"
    assert "about 50 s" in rows[0]["reason"]


def test_balls_stand_as_dense_in_every_scene_and_are_all_in_the_picture():
    from scenes import spheres
    from spheres import balls

    for n in (10, 1000):
        recipe, scene = balls(n), spheres(n)
        edge = np.ptp(recipe.centers, axis=0)
        assert np.prod(edge) == pytest.approx(n, rel=0.35)  # the outermost centres do not reach the box's faces
        np.testing.assert_array_equal(balls(n).centers, recipe.centers)
        rays = recipe.centers - np.asarray(scene.eye)
        forward = -np.asarray(scene.eye) / np.linalg.norm(scene.eye)
        along = rays @ forward
        beside = np.linalg.norm(rays - np.outer(along, forward), axis=1)
        assert (np.degrees(np.arctan2(beside, along)) < scene.fov / 2).all()
        assert (np.linalg.norm(rays, axis=1) + recipe.radii).max() < scene.max_distance


@pytest.mark.parametrize("n", [0, -1])
def test_balls_need_a_number(n: int):
    from spheres import balls

    with pytest.raises(ValueError, match=f"n must be at least 1, got {n}"):
        balls(n)


def test_truth_has_no_error_to_speak_of():
    import compare
    from peers import octomarch_engine

    task = compare.task_of("A", "depth", 0, SIZE)
    true = octomarch_engine.truth(task)
    reference = om.reference.render(
        octomarch_engine.shape_of(task),
        om.Camera(eye=task.eye, target=(0, 0, 0), fov=task.fov),
        SIZE,
        march=om.March(max_steps=100_000, epsilon=1e-9, pixel_tolerance=0.0, max_distance=task.max_distance),
        planes=("depth",),
        dtype="float64",
    ).depth
    np.testing.assert_allclose(true, reference, rtol=0, atol=1e-6)
