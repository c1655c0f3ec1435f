"""Frames on a cluster of Dask whose workers are killed while they work: all are there, whole, with the same bits."""

import os
import signal
import threading
import time
from pathlib import Path

import pytest

import octomarch as om
from octomarch.cli import main

distributed = pytest.importorskip("distributed")

FRAMES = 16
SCENE = om.Scene(om.gyroid(0.5, 0.1) & om.sphere(1.0), lights=[om.DirectionalLight((-1, -2, -1))], ambient=0.2)
SETTINGS = {"size": (240, 180), "samples": 4, "planes": ("color", "depth", "object_id"), "threads": 1}
"""Of frames that take some tenths of a second, so that workers are killed in the midst of them."""


@pytest.fixture
def client():
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def kill_a_worker_at_work(client) -> str:
    """Kill -9 a worker that is rendering, and return its address."""
    while True:
        busy = {address for address, tasks in client.processing().items() if tasks}
        for nanny in client.cluster.workers.values():
            if nanny.worker_address in busy and nanny.pid:
                os.kill(nanny.pid, signal.SIGKILL)
                return nanny.worker_address


def test_frames_survive_killed_workers(client, tmp_path: Path):
    cameras = om.turntable(SCENE, FRAMES)
    serial = om.render_frames(SCENE, cameras, out=tmp_path / "serial_{}.exr", **SETTINGS)
    killed: set[str] = set()

    def watch(done: int, _: int) -> None:
        if len(killed) < 2 and done >= (2, 7)[len(killed)]:
            killed.add(kill_a_worker_at_work(client))

    out = tmp_path / "frame_{}.exr"
    # one frame more always fails: a folder stands where its file should be
    (tmp_path / f"frame_{FRAMES}.exr").mkdir()
    with pytest.raises(om.FramesError, match=rf"1 of {FRAMES + 1} frames failed.*IsADirectoryError") as caught:
        om.render_frames(SCENE, [*cameras, cameras[0]], out=out, executor=client, retries=2, progress=watch, **SETTINGS)
    assert list(caught.value.failures) == [FRAMES]
    assert len(killed) == 2
    for path, expected in zip(caught.value.paths, serial, strict=False):
        image, truth = om.read_exr(path), om.read_exr(expected)
        for plane in truth.planes:
            assert getattr(image, plane).tobytes() == getattr(truth, plane).tobytes(), (path, plane)
    assert not list(tmp_path.glob(".*")), "halves of files are left"

    before = [path.stat().st_mtime_ns for path in serial]
    again = om.render_frames(SCENE, cameras, out=tmp_path / "serial_{}.exr", executor=client, **SETTINGS)
    assert [path.stat().st_mtime_ns for path in again] == before


def test_the_command_renders_on_a_cluster(client, tmp_path: Path):
    SCENE.save(tmp_path / "scene.json")
    scene, address = str(tmp_path / "scene.json"), client.scheduler.address
    arguments = ["--size", "60x40", "--frames", "4", "-q"]
    assert main(["animate", scene, "-o", str(tmp_path / "here_{}.exr"), *arguments]) == 0
    assert main(["animate", scene, "-o", str(tmp_path / "there_{}.exr"), *arguments, "--cluster", address]) == 0
    for i in range(4):
        here, there = (om.read_exr(tmp_path / f"{where}_{i}.exr") for where in ("here", "there"))
        assert here.color.tobytes() == there.color.tobytes()


def test_a_study_survives_a_killed_worker(client):
    settings = {"size": (160, 120), "groups": ("series", "finish"), "truth": "float64", "rounds": 0}
    here = om.study(SCENE, **settings)
    killed: set[str] = set()

    def watch(done: int, _: int) -> None:
        if not killed and done >= 3:
            killed.add(kill_a_worker_at_work(client))

    there = om.study(SCENE, **settings, executor=client, progress=watch)
    assert killed
    assert str(there.table) == str(here.table)


def test_cancelling_frees_the_cluster(client, tmp_path: Path):
    work = om.Progress()
    threading.Timer(0.5, work.cancel).start()
    begin = time.monotonic()
    with pytest.raises(om.CancelledError):
        om.render_frames(
            SCENE, om.turntable(SCENE, 200), out=tmp_path / "{}.exr", executor=client, progress=work, **SETTINGS
        )
    assert time.monotonic() - begin < 5
    assert client.submit(abs, -3).result(timeout=30) == 3
