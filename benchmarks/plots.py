"""Draw what compare.py has measured: time against the number of balls, and time against error; write plots.

tables.py calls it; sweep_plots.py draws what sweep.py has measured.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter

import peer_tables

# Equal results give equal files: no date, and names that do not depend on chance.
mpl.use("svg")
STYLE: Any = {
    "svg.hashsalt": "octomarch",
    "svg.fonttype": "path",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
}
OURS = "#c02020"
MARKERS = {"A": "o", "B": "s", "C": "^"}
COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f")


def look(keys: list[str]) -> dict[str, dict[str, Any]]:
    """Return colour and line of every contender: octomarch's stand out."""
    found, peers = {}, [key for key in keys if not key.startswith("octomarch")]
    for key in keys:
        if key in peers:
            found[key] = {"color": COLOURS[peers.index(key) % len(COLOURS)], "lw": 1.2}
        else:
            style = "-" if key.endswith("defaults") else "--"
            found[key] = {"color": OURS, "lw": 2.2, "ls": style}
    return found


def plain(value: float, _: int) -> str:
    return f"{value:,.0f}" if value >= 1 else f"{value:g}"


def growth(result: Any) -> Any:
    """Draw milliseconds of primary rays against the number of balls."""
    names, ns = peer_tables.labels(result), peer_tables.sizes(result)
    columns = {n: peer_tables.picture(result, "C", n, "depth") for n in ns}
    figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    for key, style in look(peer_tables.leading(result)).items():
        points = [(n, columns[n][key]["median"]) for n in ns if columns[n].get(key, {}).get("status") == "ok"]
        if len(points) > 1:
            axes.plot(*zip(*points, strict=True), marker="o", ms=3.5, label=names[key], **style)
    axes.set(xscale="log", yscale="log", xlabel="balls in scene C", ylabel="primary rays, ms")
    axes.xaxis.set_major_formatter(FuncFormatter(plain))
    axes.yaxis.set_major_formatter(FuncFormatter(plain))
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return figure


def error(result: Any) -> Any:
    """Draw milliseconds of primary rays against the 95th percentile of the depth's error: left and low is better."""
    names, pictures = peer_tables.labels(result), peer_tables.pictures(result)
    figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    for key, style in look(peer_tables.leading(result)).items():
        for scene, n in pictures:
            row = peer_tables.picture(result, scene, n, "depth").get(key, {})
            if row.get("status") == "ok" and row["error"]:
                size = 2 * style["lw"] + 3.6  # octomarch's larger, behind the others
                axes.plot(row["error"]["p95"], row["median"], MARKERS[scene], color=style["color"], ms=size, alpha=0.8)
        axes.plot([], [], "o", color=style["color"], label=names[key])
    for scene, _ in pictures:
        axes.plot([], [], MARKERS[scene], color="black", mfc="none", label=f"scene {scene}")
    axes.set(xscale="log", yscale="log", xlabel="95th percentile of |Δt|, scene units", ylabel="primary rays, ms")
    axes.yaxis.set_major_formatter(FuncFormatter(plain))
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return figure


def figures(result: Any) -> dict[str, Callable[[], Any]]:
    """Return how to draw each plot, by name."""
    return {"size": lambda: growth(result), "error": lambda: error(result)}


def draw(figures: dict[str, Callable[[], Any]], folder: Path) -> list[Path]:
    """Write plots into `folder` and return their files."""
    paths = []
    with mpl.rc_context(STYLE):
        for name, make in figures.items():
            figure, path = make(), folder / f"benchmarks-{name}.svg"
            figure.savefig(path, metadata={"Date": None})
            plt.close(figure)
            paths.append(path)
    return paths
