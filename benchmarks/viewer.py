"""Measure the viewer: what a picture takes in the kernel, and how soon it follows the hand in a notebook.

``python benchmarks/viewer.py`` times the steps of a picture on scenes A, B and C, then drags scene A about in a
JupyterLab of its own in Debian's Chromium, with pictures as JPEG and with as many bytes as their pixels would take. It
prints both tables and keeps them in benchmarks/results/viewer-*.json. octomarch must be installed, with what its extra
``test`` names.
"""

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import machine
from octomarch import png
from octomarch.looks import look
from octomarch.viewer.messages import jpeg_bytes
from octomarch.viewer.pace import Quality
from octomarch.viewer.pictures import View, take, view_of
from scenes import blend, building, spheres
from timing import measure

SIZE = (480, 360)
ROOT = Path(__file__).resolve().parents[1]
CELL = """import sys

sys.path.insert(0, {folder!r})
import octomarch as om
from octomarch.viewer import messages
from scenes import blend

jpeg_bytes = messages.jpeg_bytes
messages.jpeg_bytes = lambda shown: jpeg_bytes(shown) + bytes({padding})
viewer = om.view(blend().shape, blend().camera, {size})
viewer"""
WATCH = """() => {
    window.delays = [];
    const canvas = document.querySelector(".octomarch-viewer canvas");
    new MutationObserver(() => window.delays.push(Number(canvas.dataset.delay)))
        .observe(canvas, { attributes: true, attributeFilter: ["data-frames"] });
}"""

Row = dict[str, Any]


@dataclass(frozen=True)
class Step:
    """One step of a picture, which can be timed."""

    key: str
    run: Callable[[], Any]


def steps(name: str, view: View, rounds: int) -> list[Row]:
    """Return how long the steps of a picture take in the kernel, and how many bytes come out of them."""
    image = take(view, Quality())
    shown = look(image, "color")
    contenders = [
        Step("render, all light", partial(take, view, Quality())),
        Step("render, no shadows", partial(take, view, Quality(is_lit=False))),
        Step("render, no shadows, half size", partial(take, view, Quality(2, is_lit=False))),
        Step("sRGB", partial(look, image, "color")),
        Step("JPEG", partial(jpeg_bytes, shown)),
        Step("PNG", partial(png.png_bytes, shown)),
    ]
    times, outcomes = measure(contenders, rounds, lambda _: None)
    sizes = {key: len(found) if isinstance(found, bytes) else None for key, found in outcomes.items()}
    return [
        {"scene": name, "step": key, "bytes": sizes[key], "wall": taken.wall, "cpu": taken.cpu}
        for key, taken in times.items()
    ]


def drags(padding: int, seconds: float, rounds: int) -> Row:
    """Return pictures a second while scene A is dragged about in JupyterLab, and milliseconds after the hand."""
    sys.path.append(str(ROOT / "tests"))
    from viewer_page import in_jupyter_lab

    cell = CELL.format(folder=str(Path(__file__).parent), padding=padding, size=SIZE)
    with in_jupyter_lab((cell,), []) as notebook:
        notebook.drag(1.0)  # warms up, and lets the pace settle
        rates, delays = [], []
        for _ in range(rounds):
            notebook.page.evaluate(WATCH)
            rates.append(notebook.drag(seconds))
            delays += notebook.page.evaluate("window.delays")
        return {"padding": padding, "rates": rates, "delays": delays, "picture": notebook.number("picture")}


def run(rounds: int, seconds: float) -> Row:
    """Return everything that was measured, and on what machine."""
    description = machine.describe(None)
    machine.warn_when_busy(description)
    others = machine.OtherWork()
    scenes = [blend(), building(), spheres()]
    rows = [row for scene in scenes for row in steps(scene.name, view_of(scene.shape, scene.camera, SIZE), rounds)]
    description["busy_processors_during"] = others.busy_processors()
    raw = 4 * SIZE[0] * SIZE[1]
    return {"machine": description, "size": SIZE, "steps": rows, "drags": [drags(n, seconds, 3) for n in (0, raw)]}


def tables(result: Row) -> str:
    """Return what was measured as two tables in Markdown."""
    found = result["machine"]
    names = list(dict.fromkeys(row["scene"] for row in result["steps"]))
    cells = {(row["step"], row["scene"]): row for row in result["steps"]}
    how = (
        f"{found['processor']['model']}, {found['date'][:10]}, octomarch {found['octomarch']} at {found['commit']}; "
        f"other work kept {found['busy_processors_during']} of {found['processor']['processors']} processors busy."
    )
    lines = [
        how,
        "",
        f"| milliseconds at {SIZE[0]}×{SIZE[1]}, all threads | {' | '.join(names)} |",
        f"|---|{'---:|' * len(names)}",
    ]
    lines += [
        f"| {step} | {' | '.join(_cell(cells[step, name]) for name in names)} |"
        for step in dict.fromkeys(row["step"] for row in result["steps"])
    ]
    lines += ["", "| A in JupyterLab, as the hand moves | pictures a second | ms after the hand: median | p95 | as |"]
    lines.append("|---|---:|---:|---:|---|")
    for row in result["drags"]:
        name = f"JPEG and {row['padding'] / 1e3:.0f} kB" if row["padding"] else "JPEG"
        median, late = np.percentile(row["delays"], (50, 95))
        rates = f"{np.median(row['rates']):.0f} ({min(row['rates']):.0f}–{max(row['rates']):.0f})"
        lines.append(f"| {name} | {rates} | {median:.0f} | {late:.0f} | {row['picture']} |")
    return "\n".join(lines)


def _cell(row: Row) -> str:
    return f"{np.median(row['wall']):.1f}" + (f" ({row['bytes'] / 1e3:.0f} kB)" if row["bytes"] else "")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few rounds: a check, not a measurement")
    parser.add_argument("--out", type=Path, metavar="FILE", help="default: results/viewer-<date>-<processor>.json")
    chosen = parser.parse_args()
    result = run(*((2, 1.0) if chosen.quick else (21, 5.0)))
    print(f"\n{tables(result)}")
    if chosen.quick and not chosen.out:
        return
    out = chosen.out or machine.result_file(result["machine"], "viewer-")
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"\n{out}")


if __name__ == "__main__":
    main()
