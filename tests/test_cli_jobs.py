"""Processes that do tasks, and die."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import octomarch as om
from octomarch.cli import main
from octomarch.cli.jobs import Jobs, WorkerDiedError

SCENE = om.Scene(om.gyroid(0.5, 0.1) & om.sphere(1.0), lights=[om.DirectionalLight((-1, -2, -1))], ambient=0.2)


def test_calls_give_results_and_errors():
    with Jobs(2) as jobs:
        assert [each.result() for each in [jobs.submit(abs, -i) for i in range(5)]] == list(range(5))
        with pytest.raises(ValueError, match="invalid literal"):
            jobs.submit(int, "five").result()
        with pytest.raises(RuntimeError, match="pickle"):
            jobs.submit(eval, "lambda: 0").result()
        assert jobs.submit(int, "5").result() == 5


def test_a_dead_process_fails_its_call_alone():
    with Jobs(1) as jobs:
        first = jobs.submit(os.getpid).result()
        with pytest.raises(WorkerDiedError, match="exit code -9"):
            jobs.submit(os.kill, first, signal.SIGKILL).result()
        assert jobs.submit(os.getpid).result() != first


def test_the_end_does_not_wait():
    begin = time.monotonic()
    with Jobs(2) as jobs:
        futures = [jobs.submit(time.sleep, 60) for _ in range(5)]
        jobs_begun = jobs.submit(abs, 1)
        time.sleep(1.0)
    assert time.monotonic() - begin < 30
    assert all(each.done() for each in [*futures, jobs_begun])


@pytest.mark.parametrize("count", [0, -1, 1.5, "2", None])
def test_wrong_counts(count: object):
    with pytest.raises((TypeError, ValueError), match="count"):
        Jobs(count)  # type: ignore[arg-type]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks into /proc")
def test_frames_survive_killed_processes(tmp_path: Path):
    cameras = om.turntable(SCENE, 8)
    settings = {"size": (160, 120), "samples": 4, "threads": 1, "planes": ("color", "depth")}
    serial = om.render_frames(SCENE, cameras, out=tmp_path / "serial_{}.exr", **settings)
    killed: list[int] = []

    def watch(done: int, _: int) -> None:
        if len(killed) < 2 and done >= (1, 4)[len(killed)]:
            workers = {int(task.name) for task in Path("/proc").glob("[0-9]*") if is_worker(task)}
            victim = sorted(workers - set(killed))[0]
            os.kill(victim, signal.SIGKILL)
            killed.append(victim)

    with Jobs(2) as jobs:
        paths = om.render_frames(
            SCENE, cameras, out=tmp_path / "frame_{}.exr", executor=jobs, progress=watch, **settings
        )
    assert len(killed) == 2
    for path, expected in zip(paths, serial, strict=True):
        image, truth = om.read_exr(path), om.read_exr(expected)
        for plane in truth.planes:
            assert getattr(image, plane).tobytes() == getattr(truth, plane).tobytes(), (path, plane)
    assert not list(tmp_path.glob(".*"))


def is_worker(process: Path) -> bool:
    """Tell whether a process is one of this one's that multiprocessing has made for work."""
    try:
        parent = int((process / "stat").read_text().rpartition(")")[2].split()[1])
        return parent == os.getpid() and b"spawn_main" in (process / "cmdline").read_bytes()
    except (OSError, ValueError):
        return False


def test_render_in_processes_has_the_same_bits(tmp_path: Path):
    SCENE.save(tmp_path / "scene.json")
    arguments = ["render", str(tmp_path / "scene.json"), "--size", "600x900", "-q", "-o"]
    assert main([*arguments, str(tmp_path / "here.exr")]) == 0
    assert main([*arguments, str(tmp_path / "there.exr"), "--jobs", "2"]) == 0
    here, there = (om.read_exr(tmp_path / name) for name in ("here.exr", "there.exr"))
    assert here.color.tobytes() == there.color.tobytes()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="signals are of POSIX")
def test_ctrl_c_ends_processes_at_once_and_work_goes_on(tmp_path: Path):
    """As a terminal sends it: to all processes."""
    out = tmp_path / "large.exr"
    SCENE.save(tmp_path / "scene.json")
    size = ["--size", "4096x1024"]
    command = [sys.executable, "-m", "octomarch", "render", str(tmp_path / "scene.json"), "-o", str(out), *size]
    bands = tmp_path / ".large.exr.bands"
    with subprocess.Popen(
        [*command, "--jobs", "2", "--set", "samples=4"], stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        while len(list(bands.glob("[0-9]*.exr"))) < 2:
            assert process.poll() is None, process.stderr and process.stderr.read()
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert error == f"octomarch: {bands} has what is done; the same command goes on\noctomarch: interrupted\n"
    assert not out.exists()
    done = {band: band.stat().st_mtime_ns for band in bands.glob("[0-9]*.exr")}
    assert main([*command[3:], "--set", "samples=4", "--bands", "-q"]) == 0
    assert len(done) >= 2
    assert not bands.exists()
    assert om.read_exr(out).metadata["render"]["samples"] == 4
