"""Draw what sweep.py has measured. plots.py has the style and writes the files, tables.py calls both."""

from collections.abc import Callable
from functools import partial
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogFormatter, NullLocator

from plots import COLOURS, MARKERS, OURS, plain
from sweep_rows import Row, added, median, one, ratio, scene_title, values, where
from sweep_tables import PICTURES
from sweep_words import MODES


def _axes(height: float = 4.4, **settings: Any) -> tuple[Any, Any]:
    figure, axes = plt.subplots(figsize=(7.2, height), layout="constrained")
    axes.set(**settings)
    for axis, scale in ((axes.xaxis, settings.get("xscale")), (axes.yaxis, settings.get("yscale"))):
        if scale == "log":
            axis.set_major_formatter(FuncFormatter(plain))
            axis.set_minor_formatter(LogFormatter())  # where less than a power of ten is shown
    return figure, axes


def _legend(axes: Any) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def methods(rows: list[Row]) -> Any:
    """Draw milliseconds against the error of the depth: left and low is better."""
    figure, axes = _axes(xscale="log", yscale="log", xlabel="95th percentile of |Δt|, scene units", ylabel="depth, ms")
    for colour, method in zip((OURS, *COLOURS), values(rows, "method"), strict=False):
        for row in where(rows, method=method):
            axes.plot(row["error"]["p95"], median(row), MARKERS[row["scene"]], color=colour, ms=7, alpha=0.8)
        axes.plot([], [], "o", color=colour, label=method)
    for scene in values(rows, "scene"):
        axes.plot([], [], MARKERS[scene], color="black", mfc="none", label=f"scene {scene}")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}"))
    _legend(axes)
    return figure


def isas(rows: list[Row]) -> Any:
    """Draw how many times as fast as one lane instruction sets are, in both precisions."""
    figure, axes = _axes(3.2, xlabel="times as fast as one lane, float32, of the same picture")
    pictures = list(dict.fromkeys((row["scene"], row["mode"]) for row in rows))
    labels = []
    for place, (isa, precision) in enumerate(
        (isa, precision) for isa in values(rows, "isa") for precision in values(rows, "precision")
    ):
        labels.append(f"{isa}, {precision}")
        for index, (scene, mode) in enumerate(pictures):
            some = where(rows, scene=scene, mode=mode)
            row, lane = one(some, isa=isa, precision=precision), one(some, isa="scalar", precision="float32")
            if row and lane:
                label = None if place else f"{scene}, {MODES[mode]}"
                axes.barh(place + 0.2 * index - 0.3, ratio(lane, row), 0.18, color=COLOURS[index], label=label)
    axes.set_yticks(range(len(labels)), labels)
    axes.invert_yaxis()
    _legend(axes)
    return figure


def balls(rows: list[Row]) -> Any:
    """Draw milliseconds against the number of balls."""
    figure, axes = _axes(xscale="log", yscale="log", xlabel="balls in scene C", ylabel="depth, ms")
    for colour, (picture, title) in zip((OURS, *COLOURS), PICTURES.items(), strict=False):
        some = where(rows, picture=picture)
        axes.plot([row["n"] for row in some], [median(row) for row in some], "o-", color=colour, ms=3.5, label=title)
    _legend(axes)
    return figure


def resolution(rows: list[Row]) -> Any:
    """Draw milliseconds per million pixels against the side of the picture."""
    figure, axes = _axes(xscale="log", yscale="log", xlabel="pixels along each side", ylabel="ms per million pixels")
    for colour, picture in zip((OURS, *COLOURS), where(rows, side=values(rows, "side")[0]), strict=False):
        some = where(rows, **{key: picture[key] for key in ("scene", "n", "mode")})
        times = [median(row) / row["side"] ** 2 * 1e6 for row in some]
        title = f"{scene_title(picture)}, {MODES[picture['mode']]}"
        axes.plot([row["side"] for row in some], times, "o-", color=colour, ms=3.5, label=title)
    axes.set_xticks(values(rows, "side"))
    axes.xaxis.set_minor_locator(NullLocator())
    _legend(axes)
    return figure


def features(rows: list[Row]) -> Any:
    """Draw the milliseconds that each feature adds, with quartiles."""
    figure, axes = _axes(6.0, xlabel="ms added to a picture without it")
    for place, row in enumerate(rows):
        middle, low, high = added(row, one(rows, feature=row["over"]))
        axes.barh(place, middle, 0.7, color=COLOURS[0])
        axes.plot([low, high], [place, place], color="black", lw=1)
    axes.set_yticks(range(len(rows)), [row["feature"] for row in rows])
    axes.invert_yaxis()
    return figure


def building(rows: list[Row]) -> Any:
    """Draw milliseconds of building, compiling, saving and loading balls against their number."""
    figure, axes = _axes(xscale="log", yscale="log", xlabel="balls in scene C", ylabel="ms")
    for colour, stage in zip((OURS, *COLOURS), values(rows, "stage"), strict=False):
        some = where(rows, shapes="spheres", stage=stage)
        title = stage.replace("_", " ")
        axes.plot([row["n"] for row in some], [median(row) for row in some], "o-", color=colour, ms=3.5, label=title)
    _legend(axes)
    return figure


def figures(result: Any) -> dict[str, Callable[[], Any]]:
    """Return how to draw each plot, by name."""
    rows, makers = result["rows"], (methods, isas, balls, resolution, features, building)
    return {make.__name__: partial(make, rows[make.__name__]) for make in makers}
