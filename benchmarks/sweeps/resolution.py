"""What a picture takes as it grows: time per million pixels, and memory."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from peers.tasks import Mode
from sweeps.plan import Case, Plan, Row, say, timed
from sweeps.views import evaluations, view

PICTURES: tuple[tuple[str, Mode], ...] = (("A", "depth"), ("A", "shaded"), ("C", "depth"))


def measure(plan: Plan) -> list[Row]:
    """Return a row for each scene, mode and side of the square; one thread."""
    rows = []
    for side in plan.sides:
        cases = []
        for name, mode in PICTURES:
            n = plan.balls if name == "C" else 0
            say(f"{side}², scene {name}, {mode}: memory")
            # In a process of its own: what others have freed before would serve again, unseen.
            with ProcessPoolExecutor(1, get_context("spawn")) as alone:
                extra = alone.submit(extra_bytes, name, n, mode, side).result()
            seen = view(name, n)
            facts = {**seen.facts, "mode": mode, "side": side, "extra_bytes": extra}
            cases.append(Case(f"{name}/{mode}", partial(seen.render, (side, side), mode), facts))
        rows += timed(cases, plan, f"{side}²", lambda image: {"evaluations": evaluations(image)})
    return rows


def extra_bytes(name: str, n: int, mode: Mode, side: int) -> int | None:
    """Return the memory that a picture takes at the most, beyond its planes. None where the system does not tell."""
    status, reset = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    seen = view(name, n)
    try:
        reset.write_text("5")  # the peak begins anew: man 5 proc
        before = _kilobytes(status, "VmRSS")
        image = seen.render((side, side), mode)
        peak = _kilobytes(status, "VmHWM")
    except OSError:
        return None
    planes = sum(int(getattr(image, plane).nbytes) for plane in image.planes)
    return max(1024 * (peak - before) - planes, 0)


def _kilobytes(status: Path, name: str) -> int:
    return next(int(line.split()[1]) for line in status.read_text().splitlines() if line.startswith(f"{name}:"))
