"""Plots of a study: error against cost. `result` comes before it; matplotlib is an extra."""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING, Any

import numpy as np

from octomarch.study.rows import StudyTable

if TYPE_CHECKING:
    from octomarch.study.result import Study

INSTALL = "plots need matplotlib: pip install 'octomarch[study]'"
_COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#17becf", "#7f7f7f", "#bcbd22")
_FRONT = "#c02020"
_LABELS = {
    "evaluations": "evaluations per camera ray",
    "depth_ms": "depth alone, ms of processor time",
}


def available() -> bool:
    """Tell whether matplotlib is installed.

    Examples
    --------
    >>> isinstance(available(), bool)
    True
    """
    return importlib.util.find_spec("matplotlib") is not None


def figure(study: Study) -> Any:
    """Return a figure of depth p95 over evaluations, and over milliseconds where there are some.

    Rings are settings whose far limit cuts surfaces off.
    """
    try:
        from matplotlib.figure import Figure  # of no window system: nothing of the user's pyplot changes
        from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
    except ImportError as error:
        raise ImportError(INSTALL) from error
    from octomarch.study.result import MARCHING

    rows = study.table.of(*MARCHING)
    costs = [name for name in _LABELS if np.isfinite(rows.column(name)).any()]
    drawn = Figure(figsize=(5.2 * len(costs) + 1.6, 4.2), layout="constrained")
    axes = drawn.subplots(1, len(costs), sharey=True, squeeze=False)[0]
    if not _drawable(rows).any():
        axes[0].set_title("no error is finite and above 0")
        return drawn
    for place, cost in zip(axes, costs, strict=True):
        _scatter(place, rows, cost)
        _staircase(place, study.pareto(cost, "p95"), cost)
        place.set(xscale="log", yscale="log", xlabel=_LABELS[cost])
        place.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        place.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        place.xaxis.set_minor_locator(NullLocator())
        place.grid(alpha=0.25)
        place.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("95th percentile of |Δt|, scene units")
    axes[-1].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return drawn


def _scatter(axes: Any, rows: StudyTable, cost: str) -> None:
    groups = list(dict.fromkeys(row.group for row in rows))
    for index, group in enumerate(groups):
        some = rows.of(group)
        cut = some.column("cut") > 0
        style = {"color": _COLOURS[index % len(_COLOURS)], "ms": 4.5, "alpha": 0.8}
        for kept, fill in ((_drawable(some) & ~cut, {"label": group}), (_drawable(some) & cut, {"mfc": "none"})):
            axes.plot(some.column(cost)[kept], some.column("p95")[kept], "o", **style, **fill)


def _staircase(axes: Any, front: StudyTable, cost: str) -> None:
    """Draw the least error that each cost buys."""
    kept = _drawable(front)
    axes.step(
        front.column(cost)[kept], front.column("p95")[kept], where="post", color=_FRONT, lw=1.4, label="Pareto front"
    )


def _drawable(rows: StudyTable) -> Any:
    """Tell which rows have a place on a logarithmic axis of errors."""
    errors = rows.column("p95")
    return np.isfinite(errors) & (errors > 0)
