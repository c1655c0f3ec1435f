"""Draw what trade.py has measured: error over evaluations, and over time on all lanes and on one.

plots.py has the style and writes the files, tables.py calls both.
"""

from collections.abc import Callable
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from plots import COLOURS, OURS
from sweep_rows import Row, median, scene_title, values, where

KINDS = {
    ("auto", "secant"): ("long steps, finish", OURS),
    ("auto", None): ("long steps, no finish", COLOURS[1]),
    ("plain", "secant"): ("plain steps, finish", COLOURS[0]),
    ("plain", None): ("plain steps, no finish", COLOURS[6]),
}


def trade(rows: list[Row]) -> Any:
    """Draw a column for each scene: left and low is better."""
    scenes = values(rows, "scene")
    figure, axes = plt.subplots(
        2, len(scenes), figsize=(3.1 * len(scenes), 5.6), layout="constrained", sharey="row", squeeze=False
    )
    for column, name in enumerate(scenes):
        some = where(rows, scene=name)
        _curves(axes[0][column], some, lambda row: float(row["evaluations"]), "-")
        _curves(axes[1][column], some, lambda row: median(row["simd"]), "-")
        _curves(axes[1][column], some, lambda row: median(row["lane"]), ":")
        axes[0][column].set(title=scene_title(some[0]), xlabel="evaluations a ray")
        axes[1][column].set(xlabel="depth, ms")
    for row in axes:
        row[0].set_ylabel("95th percentile of |Δt|")
    _legend(figure, axes[0][0])
    return figure


def figures(result: Any) -> dict[str, Callable[[], Any]]:
    """Return how to draw each plot, by name."""
    return {"trade": lambda: trade(result["rows"])}


def _curves(axes: Any, rows: list[Row], cost: Callable[[Row], float], style: str) -> None:
    """Draw a line for each kind of setting, from coarse to fine."""
    for (method, finish), (label, colour) in KINDS.items():
        some = [row for row in where(rows, method=method, finish=finish) if row["p95"]]
        points = sorted((-row["tolerance"], cost(row), row["p95"]) for row in some)
        axes.plot(
            [p[1] for p in points], [p[2] for p in points], f"o{style}", color=colour, ms=3.5, lw=1.2, label=label
        )
    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,g}"))
    axes.xaxis.set_minor_locator(NullLocator())


def _legend(figure: Any, axes: Any) -> None:
    handles, labels = axes.get_legend_handles_labels()
    handles += plt.plot([], [], "-", color="black", lw=1.2) + plt.plot([], [], ":", color="black", lw=1.2)
    labels += ["all lanes", "one lane"]
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
