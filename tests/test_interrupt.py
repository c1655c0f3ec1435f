"""Ctrl-C and exceptions of callbacks end long work at once.

Each interrupt is sent to a process of its own, that says how long after it the work ended, and how far it had come:
work that would not have gone on for long proves nothing.
"""

import json
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import octomarch as om

PATIENCE = 1.0
"""Seconds from signal to exception on a machine that does much else; on an idle one it is some hundredths."""
WORKED = 0.3
"""Seconds of work before the signal."""

SCRIPT = """
import json, os, signal, threading, time
import numpy as np
import octomarch as om

progress = [0, 1]
sent = []

def note(done, total):
    progress[:] = done, total

def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

camera = om.Camera((3, 2, 4), (0, 0, 0))
whole, central = om.March(prune=False), om.Shading('central')
centers = np.random.default_rng(0).uniform(-2, 2, (10_000, 3))
{prepare}
threading.Timer({worked}, interrupt).start()
begin = time.monotonic()
try:
    {work}
except KeyboardInterrupt:
    now = time.monotonic()
    print(json.dumps(dict(waited=now - sent[0], worked=now - begin, progress=progress)))
"""

SMALL = "shape = om.sphere(1.0).union(om.box(1.5), smooth=0.25) | om.plane(point=(0, -1, 0))"
LARGE = "shape = om.union(*(om.sphere(0.05, center=c) for c in centers), smooth=0.01); om.compile(shape)"
WAVES = "x, y, z = om.coordinates(); shape = om.field(sum(om.sin(x * k + y) for k in range(4000)))"
GRAZED = "shape = om.plane(); camera = om.Camera((0, 1e-3, 0), (1, 0, 0), fov=0.01)"
MIRRORS = f"{LARGE}; shape = shape.paint(om.Material(0.5, reflectivity=1)) | om.plane(point=(0, -1, 0))"
NOISY = "image = om.Image({'color': np.random.default_rng(0).random((5000, 5000, 3), np.float32)})"
WORK = {
    "many pixels": (SMALL, "om.render(shape, camera, (16000, 16000), progress=note)"),
    "many steps": (GRAZED, "om.render(shape, camera, (8000, 8000), progress=note, march=om.March('plain', 10**6))"),
    "fixed steps": (
        GRAZED,
        "om.render(shape, camera, (4000, 4000), progress=note, march=om.March('fixed', step=1e-5))",
    ),
    "many samples": (SMALL, "om.render(shape, camera, (4000, 4000), progress=note, samples=64)"),
    "a large scene": (LARGE, "om.render(shape, camera, (16000, 16000), progress=note)"),
    "occlusion of a large scene": (
        LARGE,
        "om.render(shape, camera, (4000, 4000), progress=note, march=whole, shading=om.Shading(occlusion=64))",
    ),
    "central normals of a large scene": (
        LARGE,
        "om.render(shape, camera, (4000, 4000), planes='normal', march=whole, shading=central, progress=note)",
    ),
    "reflections": (MIRRORS, "om.render(shape, camera, (4000, 4000), progress=note, shading=om.Shading(bounces=64))"),
    "a picture to be saved": (
        SMALL,
        "om.render(shape, camera, (16000, 16000), samples=4, progress=note).save('picture.exr')",
    ),
    "saving EXR": (NOISY, "image.save('picture.exr')"),
    "saving PNG": (NOISY, "image.save('picture.png')"),
    "a large field": (WAVES, "shape.distance(np.zeros((10**7, 3)))"),
    "a large gradient": (WAVES, "shape.gradient(np.zeros((10**7, 3)))"),
    "many rays": (LARGE, "shape.raycast(np.full((10**6, 3), 3.0), np.full((10**6, 3), -1.0))"),
    "certified rays": (LARGE, "om.reference.certified(shape, np.full((10**6, 3), 3.0), np.full((10**6, 3), -1.0))"),
}


@pytest.mark.skipif(sys.platform == "win32", reason="signals are of POSIX")
@pytest.mark.parametrize("name", WORK)
@pytest.mark.parametrize("isa", [om.isas()[0], "scalar"])
def test_ctrl_c_ends_long_work_at_once(name: str, isa: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("OCTOMARCH_ISA", isa)
    prepare, work = WORK[name]
    script = SCRIPT.format(prepare=prepare, work=work, worked=WORKED)
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout, "the work ended before the signal came"
    found = json.loads(done.stdout)
    assert found["waited"] < PATIENCE
    tiles, total = found["progress"]
    assert tiles < total / 20, "the whole work should take twenty times as long, or the test tests nothing"
    assert list(tmp_path.iterdir()) == []


class StoppedError(Exception):
    pass


@pytest.mark.parametrize("after", [0, 1, 5])
def test_an_exception_of_the_progress_callback_arrives_and_ends_the_render(after: int):
    calls: list[tuple[int, int]] = []

    def stop(done: int, total: int) -> None:
        calls.append((done, total))
        if len(calls) > after:
            raise StoppedError(f"at {done} of {total}")

    with pytest.raises(StoppedError, match=r"at \d+ of \d+"):
        om.render(om.sphere(1.0), om.Camera((3, 2, 4), (0, 0, 0)), (16000, 16000), progress=stop)
    assert len(calls) == after + 1  # it is not called again
    done, total = calls[-1]
    assert done < total / 4


def test_work_goes_on_after_an_interrupted_render():
    """No thread is left behind, and no half of a state."""

    def stop(*_: int) -> None:
        raise StoppedError

    shape, camera = om.sphere(1.0) - om.box(1.2), om.Camera((3, 2, 4), (0, 0, 0))
    before = om.render(shape, camera, (200, 150)).color
    for _ in range(5):
        with pytest.raises(StoppedError):
            om.render(shape, camera, (8000, 8000), progress=stop)
    np.testing.assert_array_equal(om.render(shape, camera, (200, 150)).color, before)


def test_the_callback_is_called_on_the_calling_thread():
    threads = set()
    om.render(om.sphere(1.0), size=(900, 900), progress=lambda *_: threads.add(threading.get_ident()))
    assert threads == {threading.get_ident()}
