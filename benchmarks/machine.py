"""What a measurement was made on: processor, compiler, versions, commit and date."""

import itertools
import os
import platform
import re
import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import octomarch as om

RESULTS = Path(__file__).resolve().parent / "results"
QUIET = 0.1  # processors that other work may keep busy

# The flags that decide which code can run; the others of a processor say nothing here.
SIMD_FLAGS = re.compile(r"sse\w*|ssse3|avx\w*|fma|bmi[12]|asimd\w*|sve\w*")


def processor() -> dict[str, Any]:
    """Return model, SIMD flags and number of processors."""
    cpuinfo = Path("/proc/cpuinfo")
    text = cpuinfo.read_text(encoding="utf-8") if cpuinfo.exists() else ""
    fields: dict[str, str] = {}
    for line in text.split("\n\n")[0].splitlines():
        name, _, value = line.partition(":")
        fields[name.strip()] = value.strip()
    flags = fields.get("flags", fields.get("Features", "")).split()
    return {
        "model": fields.get("model name", platform.processor() or platform.machine()),
        "family_model_stepping": [fields.get(name) for name in ("cpu family", "model", "stepping")],
        "mhz": fields.get("cpu MHz"),
        "processors": os.cpu_count(),
        "usable_processors": len(os.sched_getaffinity(0)),
        "flags": [flag for flag in flags if SIMD_FLAGS.fullmatch(flag)],
        "hypervisor": "hypervisor" in flags,
    }


def busy_processors(seconds: float = 1.0) -> float | None:
    """Return how many processors other work keeps busy: a benchmark wants 0. None where /proc/stat does not tell."""
    try:
        before = _ticks()
        time.sleep(seconds)
        after = _ticks()
    except (OSError, ValueError):
        return None
    idle, total = (late - early for early, late in zip(before, after, strict=True))
    return round((1.0 - idle / max(total, 1)) * (os.cpu_count() or 1), 2)


class OtherWork:
    """Tells, once processes that belong to a run have ended, how many processors others kept busy since it began."""

    def __init__(self) -> None:
        self._begin, self._own = _ticks(), self._used()

    def busy_processors(self) -> float:
        (idle, total), (idle_before, total_before) = _ticks(), self._begin
        share = 1.0 - (idle - idle_before) / max(total - total_before, 1)
        seconds = (total - total_before) / os.sysconf("SC_CLK_TCK") / (os.cpu_count() or 1)
        return round(max(share * (os.cpu_count() or 1) - (self._used() - self._own) / max(seconds, 1e-3), 0.0), 2)

    @staticmethod
    def _used() -> float:
        times = os.times()
        return times.user + times.system + times.children_user + times.children_system


def _ticks() -> tuple[int, int]:
    """Return idle ticks (waiting for input and output included) and all ticks since the machine started."""
    ticks = [int(text) for text in Path("/proc/stat").read_text(encoding="ascii").splitlines()[0].split()[1:]]
    return ticks[3] + ticks[4], sum(ticks)


def commit() -> str | None:
    """Return the commit of this checkout, with a + when the library's sources were changed since; None without git."""
    root = Path(__file__).resolve().parent.parent
    try:
        name = subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=root, capture_output=True, check=True)
        changed = subprocess.run(["git", "status", "--porcelain", "cpp"], cwd=root, capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return name.stdout.decode().strip() + ("+" if changed.stdout else "")


def describe(module: Any) -> dict[str, Any]:
    """Return everything about this run that is not a time. `module` has the marches written by hand, or is None."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "commit": commit(),
        "processor": processor(),
        "busy_processors_before": busy_processors(),
        "system": f"{platform.system()} {platform.release()}, {' '.join(platform.libc_ver())}",
        "python": platform.python_version(),
        "numpy": np.__version__,
        "octomarch": om.__version__,
        "engine_build": om.build_info(),
        "bench_build": module and {"compiler": module.compiler, "flags": module.flags, "xsimd": module.xsimd},
    }


def warn_when_busy(description: dict[str, Any]) -> None:
    """Say so where other work keeps the machine busy before a run has begun."""
    if (busy := description["busy_processors_before"]) and busy > QUIET:
        print(f"Other work keeps {busy} processors busy: these figures will not be worth keeping.", file=sys.stderr)


def result_file(description: dict[str, Any], prefix: str) -> Path:
    """Return where a run is kept: its name tells what, when, on which processor, and which run of the day it is."""
    model = re.sub(r"[^a-z0-9]+", "-", description["processor"]["model"].lower()).strip("-")
    name = f"{prefix}{description['date'][:10]}-{model}"
    names = itertools.chain([name], (f"{name}-{number}" for number in itertools.count(2)))
    return next(path for path in (RESULTS / f"{name}.json" for name in names) if not path.exists())
