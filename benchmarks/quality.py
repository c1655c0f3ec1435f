"""Cost and error of the gallery's quality series: the same street with 32 to 512 steps, with and without a far limit.

``python benchmarks/quality.py`` prints a table and keeps it in benchmarks/results/quality.json. Costs are counts, so
the table is the same on every machine. The truth is the same march in float64 with a thousandth of the hit epsilon and
steps enough for every ray.
"""

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

import octomarch as om

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "examples" / "gallery"))
from _quality import CAMERA, street  # noqa: E402  (the scene of the pictures, from where they are)

SIZE = (640, 480)
FAR = 60.0
STEPS = (32, 64, 128, 256, 512)
TRUTH = om.March(max_steps=100_000, epsilon=1e-8, pixel_tolerance=1e-4)


@dataclass(frozen=True)
class Row:
    """One setting. Errors are of the depth of rays that hit in both pictures, in scene units."""

    max_steps: int
    max_distance: float | None
    evaluations_per_ray: float
    step_limit: float
    """Share of rays that ran out of steps."""
    false_misses: int
    """Pixels that miss and should hit nearer than the far limit."""
    false_hits: int
    p50: float
    p95: float
    p99: float


def measure(scene: om.Scene, truth: om.Image, max_steps: int, far: float | None) -> Row:
    march = om.March("plain", max_steps=max_steps, max_distance=far)
    image = om.render(scene, CAMERA, SIZE, march=march, planes=("depth", "status"))
    wanted = truth.depth <= (np.inf if far is None else far)
    wanted &= truth.status == om.Status.HIT
    hit = image.status == om.Status.HIT
    both = hit & wanted
    error = np.abs(image.depth[both] - truth.depth[both])
    p50, p95, p99 = (float(p) for p in np.percentile(error, [50, 95, 99]))
    return Row(
        max_steps=max_steps,
        max_distance=far,
        evaluations_per_ray=image.stats["stages"]["primary"]["evaluations"] / image.stats["rays"],
        step_limit=float((image.status == om.Status.STEP_LIMIT).mean()),
        false_misses=int((wanted & (image.status == om.Status.MISS)).sum()),
        false_hits=int((hit & ~wanted).sum()),
        p50=p50,
        p95=p95,
        p99=p99,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, metavar="FILE", default=ROOT / "benchmarks" / "results" / "quality.json")
    out = parser.parse_args().out
    scene = street()
    truth = om.render(scene, CAMERA, SIZE, march=TRUTH, planes=("depth", "status"), precision="float64")
    rows = [measure(scene, truth, steps, far) for far in (None, FAR) for steps in STEPS]
    print("| steps | far | evaluations | out of steps | false misses | false hits | p50 | p95 | p99 |")
    print("|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        far = "–" if row.max_distance is None else f"{row.max_distance:g}"
        print(
            f"| {row.max_steps} | {far} | {row.evaluations_per_ray:.1f} | {row.step_limit:.2%} | {row.false_misses} "
            f"| {row.false_hits} | {row.p50:.1e} | {row.p95:.1e} | {row.p99:.1e} |"
        )
    out.write_text(json.dumps({"size": SIZE, "rows": [asdict(row) for row in rows]}, indent=1) + "\n")


if __name__ == "__main__":
    main()
