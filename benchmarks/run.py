"""Time the engine against the same march written by hand: scalar, one packet at a time, and in refilled blocks.

``python benchmarks/run.py`` builds the hand-written marches (CMake, into build/bench), runs every contender once per
round in an order that moves on, prints a table and keeps everything in benchmarks/results/. README.md says how to read
it. octomarch itself must be installed.
"""

import argparse
import importlib.util
import json
import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import machine
import report
from contenders import contenders
from scenes import EPSILON, MAX_DISTANCE, MAX_STEPS, SCENES, SIZE
from timing import measure

HERE = Path(__file__).resolve().parent
MODULE = "octomarch_bench"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", choices=sorted(SCENES), default=sorted(SCENES))
    parser.add_argument(
        "--isas", nargs="+", metavar="ISA", help="avx512, avx2, sse2 or neon; default: all that run here"
    )
    parser.add_argument("--repeat", type=int, default=21, metavar="N", help="rounds, ≥ 3 (default: 21)")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="default: benchmarks/results/hand-<date>-<processor>.json"
    )
    parser.add_argument("--build-dir", type=Path, default=HERE.parent / "build" / "bench", metavar="DIR")
    parser.add_argument("--module", type=Path, metavar="FILE", help=f"a built {MODULE}; nothing is built then")
    chosen = parser.parse_args()
    if chosen.repeat < 3:
        parser.error(f"--repeat must be at least 3, got {chosen.repeat}")
    return chosen


def build(build_dir: Path) -> Path:
    """Build the hand-written marches with the interpreter that runs this, and return the module's file."""
    configure = ["cmake", "-S", str(HERE.parent), "-B", str(build_dir), "-DOCTOMARCH_BUILD_BENCHMARKS=ON"]
    if not (build_dir / "CMakeCache.txt").exists():
        configure += ["-DCMAKE_BUILD_TYPE=Release", f"-DPython_EXECUTABLE={sys.executable}"]
    compile_it = ["cmake", "--build", str(build_dir), "--target", MODULE, "--parallel", str(os.cpu_count() or 1)]
    for command in (configure, compile_it):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{done.stdout}\n{' '.join(command)} failed: see above")
    return next((build_dir / "benchmarks" / "cpp").glob(f"{MODULE}.*.so"))


def load(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(MODULE, path)
    if spec is None or spec.loader is None:
        sys.exit(f"{path} is not a Python module")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def runnable(module: Any, wanted: list[str] | None) -> list[str]:
    """Return the instruction sets asked for, or all that were built and run here, best first."""
    available = list(dict.fromkeys(isa for isa, name in module.variants() if name == "block"))
    if missing := sorted(set(wanted or ()) - set(available)):
        sys.exit(f"--isas: {', '.join(missing)} cannot run here; there are {', '.join(available)}")
    return [isa for isa in available if not wanted or isa in wanted]


def main() -> None:
    chosen = arguments()
    module = load(chosen.module or build(chosen.build_dir))
    description = machine.describe(module)
    machine.warn_when_busy(description)
    isas = runnable(module, chosen.isas)
    rows: list[report.Row] = []
    verdicts: list[report.Verdict] = []
    milliseconds: dict[str, Any] = {}
    for name in chosen.scenes:
        scene = SCENES[name]()
        field = contenders(module, scene, isas)

        def progress(done: int, name: str = name) -> None:
            print(f"\rscene {name}: round {done} of {chosen.repeat}", end="", file=sys.stderr, flush=True)

        times, outcomes = measure(field, chosen.repeat, progress)
        print(file=sys.stderr)
        rows += report.rows(scene, field, times, outcomes)
        verdicts += report.verdicts(scene, isas, times)
        milliseconds[name] = {key: asdict(value) for key, value in times.items()}
    description["busy_processors_after"] = machine.busy_processors()
    settings = {
        "size": SIZE,
        "max_steps": MAX_STEPS,
        "epsilon": EPSILON,
        "max_distance": MAX_DISTANCE,
        "method": "plain",
        "pixel_tolerance": 0.0,
        "precision": "float32",
        "rounds": chosen.repeat,
    }
    print(f"{description['processor']['model']}, {description['engine_build']['compiler']}, {description['date']}")
    print(f"\n{report.table(rows)}\n\n{report.conclusion(verdicts)}")
    out = chosen.out or machine.result_file(description, "hand-")
    out.parent.mkdir(parents=True, exist_ok=True)
    result = report.as_json(description, settings, rows, verdicts, milliseconds)
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"\n{out}")


if __name__ == "__main__":
    main()
