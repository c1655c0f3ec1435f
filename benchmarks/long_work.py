"""What long work takes: memory and time of large pictures, going on after kill -9, and how soon Ctrl-C ends it.

``python benchmarks/long_work.py`` prints tables and keeps them in benchmarks/results/long-<date>-<processor>.json;
``--size 16384`` for the largest picture, which needs some 4 GB of disk. Each picture is rendered in a process of its
own, whose peak memory the system tells. tables.py comes after it.
"""

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import long_tables
import machine
import octomarch as om
from octomarch.exr import read_document

SIZE = 4096
INTERRUPTS = 20
CAMERA = om.Camera((3, 2, 4), (0, 0, 0))


def scene() -> om.Scene:
    """Return scene A of the benchmarks, with its light."""
    shape = om.sphere(1.0).union(om.box(1.5).translate(0.9, 0.3, 0), smooth=0.25) | om.plane(point=(0, -1, 0))
    return om.Scene(shape, lights=[om.DirectionalLight((-1, -2, -1))])


# Pictures ------------------------------------------------------------------------------------------------------------


def render(way: str, size: int, out: Path) -> None:
    """Render the picture in this process, and print what it took."""
    start, used = time.perf_counter(), time.process_time()
    if way == "at once":
        om.render(scene(), CAMERA, (size, size)).save(out)
    else:
        om.render_file(scene(), CAMERA, (size, size), out=out)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps([time.perf_counter() - start, time.process_time() - used, peak]))


def in_a_process(way: str, size: int, out: Path) -> list[str]:
    return [sys.executable, __file__, "--render", way, "--size", str(size), "--out", str(out)]


def picture(way: str, size: int, folder: Path) -> dict[str, Any]:
    """Return what a picture takes."""
    out = folder / "picture.exr"
    out.unlink(missing_ok=True)
    done = subprocess.run(in_a_process(way, size, out), check=True, capture_output=True, text=True)
    seconds, cpu, peak = json.loads(done.stdout)
    sums = read_document(os.fspath(out))["crc32"]
    return {
        "way": way,
        "size": size,
        "seconds": seconds,
        "cpu_seconds": cpu,
        "peak_bytes": peak,
        "pixel_bytes": size * size * 3 * 4,
        "file_bytes": out.stat().st_size,
        "checksums": sums,
    }


def killed(size: int, folder: Path) -> dict[str, Any]:
    """Return what a picture takes whose process is killed when half of it is there, and that then goes on."""
    out = folder / "picture.exr"
    out.unlink(missing_ok=True)
    bands = folder / ".picture.exr.bands"
    all_bands = -(-size // max(16, 2**18 // (16 * size) * 16))
    start = time.perf_counter()
    with subprocess.Popen(in_a_process("bands", size, out), stdout=subprocess.DEVNULL) as process:
        while len(list(bands.glob("[0-9]*.exr"))) < all_bands / 2 and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    before = time.perf_counter() - start
    return {**picture("bands", size, folder), "way": "killed at half, and again", "seconds_before": before}


def picture_rows(size: int) -> list[dict[str, Any]]:
    """Return rows of pictures up to a size, all of which have to have the same pixels in whatever way they come."""
    rows = []
    with tempfile.TemporaryDirectory(dir=Path.cwd(), prefix=".long_work-") as name:
        folder = Path(name)
        for each in sorted({size // 4, size}):
            rows += [picture(way, each, folder) for way in ("at once", "bands")] + [killed(each, folder)]
            if any(row["checksums"] != rows[-1]["checksums"] for row in rows[-3:]):
                raise RuntimeError(f"the pictures of {each}² pixels differ: {rows[-3:]}")
    return rows


# Interrupts ----------------------------------------------------------------------------------------------------------

LATENCY = """
import json, os, random, signal, sys, tempfile, threading, time
import numpy as np, octomarch as om
sys.path.insert(0, {benchmarks!r})
from long_work import CAMERA, scene
signal.signal(signal.SIGINT, signal.default_int_handler)  # which shells take from what runs in the background
centers = np.random.default_rng(0).uniform(-20, 20, (100_000, 3))
balls = om.spheres(centers, 0.5, smooth=0.1)
far = om.Camera((60, 40, 80), (0, 0, 0))
scene, out, work = scene(), tempfile.mkdtemp(), om.Progress()
chance = random.Random(0)
points = np.random.default_rng(0).uniform(-20, 20, (10**7, 3))
waited = []
for number in range({interrupts}):
    sent, work = [], om.Progress()

    def interrupt():
        sent.append(time.perf_counter())
        {send}

    timer = threading.Timer(chance.uniform(0.05, 0.8), interrupt)
    try:
        timer.start()
        {work}
        timer.cancel()
    except ({error}):
        waited.append(time.perf_counter() - sent[0])
print(json.dumps(waited))
"""
SEND = {
    "Ctrl-C": ("os.kill(os.getpid(), signal.SIGINT)", "KeyboardInterrupt"),
    "cancel()": ("work.cancel()", "om.CancelledError"),
}
WORK = {
    "render, 16,384² pixels": "om.render(scene, CAMERA, (16384, 16384), progress=work)",
    "render, first picture of 100,000 balls": (
        "om.render(om.spheres(centers, 0.5 + 0.001 * number, smooth=0.1), far, (4096, 4096), progress=work)"
    ),
    "render_file, 16,384² pixels": (
        "om.render_file(scene, CAMERA, (16384, 16384), out=f'{out}/{number}.exr', progress=work)"
    ),
    "render_frames": (
        "om.render_frames(scene, om.turntable(scene, 1000, camera=CAMERA), (2048, 2048), samples=4, "
        "out=out + f'/{number}-{{}}.exr', progress=work)"
    ),
    "study": "om.study(scene, CAMERA, (640, 480), truth='float64', progress=work)",
    "March.for_error": "om.March.for_error(scene, CAMERA, 1e-4, progress=work)",
    "raycast, 10⁷ rays": "scene.shape.raycast(points, -points)",
    "distance, 10⁷ points": "balls.distance(points)",
}
"""What is ended; queries take no progress, so that only Ctrl-C ends them."""


def latency(name: str, how: str, interrupts: int) -> dict[str, Any]:
    """Return how long work goes on after it was told to end."""
    send, error = SEND[how]
    script = LATENCY.format(
        benchmarks=str(Path(__file__).parent), interrupts=interrupts, send=send, error=error, work=WORK[name]
    )
    done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    waited = json.loads(done.stdout)
    if len(waited) < interrupts / 2:
        raise RuntimeError(f"{name} ended by itself {interrupts - len(waited)} times of {interrupts}")
    return {
        "work": name,
        "how": how,
        "interrupts": len(waited),
        "median": float(np.median(waited)),
        "p95": float(np.percentile(waited, 95)),
        "most": max(waited),
    }


def latency_rows(interrupts: int) -> list[dict[str, Any]]:
    rows = []
    for name, work in WORK.items():
        for how in SEND if "progress=work" in work else ["Ctrl-C"]:
            rows.append(latency(name, how, interrupts))
            print(f"{name}, {how}: {1e3 * rows[-1]['median']:.0f} ms, {1e3 * rows[-1]['most']:.0f} at the most")
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=SIZE, help=f"width and height of the large picture ({SIZE})")
    parser.add_argument("--interrupts", type=int, default=INTERRUPTS, help=f"of each kind of work ({INTERRUPTS})")
    parser.add_argument("--render", choices=("at once", "bands"), help="render one picture, into --out")
    parser.add_argument("--out", type=Path, metavar="FILE", help="where the results go (default: benchmarks/results)")
    chosen = parser.parse_args()
    if chosen.render:
        render(chosen.render, chosen.size, chosen.out)
        return
    description = machine.describe(None)
    machine.warn_when_busy(description)
    other = machine.OtherWork()
    result = {"machine": description, "latency": latency_rows(chosen.interrupts), "pictures": picture_rows(chosen.size)}
    description["busy_processors_during"] = other.busy_processors()
    out = chosen.out or machine.result_file(description, "long-")
    out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    print("\n\n".join(long_tables.blocks(result).values()), f"\n\n{out}")


if __name__ == "__main__":
    main()
