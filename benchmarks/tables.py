"""Turn what is kept in benchmarks/results into the tables and plots of README.md and the guide.

``python benchmarks/tables.py`` (or ``make bench-tables``) rewrites what stands between ``<!-- begin: NAME -->`` and
``<!-- end: NAME -->``, and draws docs/images/benchmarks-*.svg; with ``--check`` it only says whether a table is stale.
Damaged results end it with file and key, and nothing is written. cells.py, compare.py, run.py, sweep.py, trade.py,
quality.py, evaluations.py, extremes.py, grid.py, long_work.py and meshing.py come before it.
"""

import argparse
import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cells_tables
import evaluation_tables
import extreme_tables
import grid_tables
import hand_tables
import long_tables
import meshing_tables
import peer_tables
import sweep_rows
import sweep_tables
import trade_tables

ROOT = Path(__file__).resolve().parents[1]
PAGES = (
    "README.md",
    "docs/guide/benchmarks.md",
    "docs/guide/export.md",
    "docs/guide/frames.md",
    "docs/guide/import.md",
    "docs/guide/marching.md",
    "docs/guide/numerics.md",
    "docs/guide/speed.md",
)

KINDS = {
    "cells": cells_tables.check,
    "grid": grid_tables.check,
    "hand": hand_tables.check_by_hand,
    "meshing": meshing_tables.check,
    "peers": peer_tables.check,
    "sweep": sweep_rows.check,
    "trade": trade_tables.check,
    "long": long_tables.check,
}
"""What the files in benchmarks/results begin with, and what they have to be."""

_BLOCK = re.compile(r"(<!-- begin: (?P<name>[a-z-]+) -->\n).*?(<!-- end: (?P=name) -->)", re.DOTALL)
_MARKER = re.compile(r"<!-- (begin|end): ")


def load(path: Path, check: Callable[[Any, str], None]) -> Any:
    """Read a file of results. Raise ValueError where it is not what `check` expects."""
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise ValueError(f"{path.name}: not JSON: {error}") from None
    check(result, path.name)
    return result


def kept(results: Path, kind: str) -> list[Any]:
    """Return all runs of a program of KINDS, the newest last."""
    check = KINDS[kind]
    found = [load(path, check) for path in sorted(results.glob(f"{kind}-*.json"))]
    if not found:
        raise ValueError(f"{results}: no {kind}-*.json")
    return sorted(found, key=lambda result: str(result["machine"]["date"]))


def newest(results: Path, kind: str) -> Any:
    return kept(results, kind)[-1]


def by_hand(results: Path) -> list[Any]:
    """Return the runs of run.py of the newest one's day and commit."""
    runs = kept(results, "hand")

    def of(run: Any) -> tuple[str, str]:
        return run["machine"]["date"][:10], run["machine"]["commit"]

    return [run for run in runs if of(run) == of(runs[-1])]


def blocks(results: Path) -> dict[str, str]:
    """Return the text of every block by name."""
    peers = newest(results, "peers")
    pictures = peer_tables.pictures(peers)
    return {
        "by-hand": hand_tables.by_hand(by_hand(results)),
        "quality": hand_tables.quality(load(results / "quality.json", hand_tables.check_quality)),
        "evaluations": evaluation_tables.table(load(results / "evaluations.json", evaluation_tables.check)),
        "meshing": meshing_tables.table(newest(results, "meshing")["rows"]),
        **extreme_tables.blocks(load(results / "extremes.json", extreme_tables.check)),
        **cells_tables.blocks(newest(results, "cells")),
        **grid_tables.blocks(newest(results, "grid")),
        "peers-how": peer_tables.how(peers),
        "peers-summary": peer_tables.summary_table(peers),
        "peers-winners": peer_tables.winners(peers),
        "peers-versions": peer_tables.versions(peers),
        "peers-growth": peer_tables.sweep_table(peers),
        **sweep_tables.blocks(newest(results, "sweep")),
        **trade_tables.blocks(newest(results, "trade")),
        **long_tables.blocks(newest(results, "long")),
        **{f"peers-{scene.lower()}": peer_tables.scene_table(peers, scene, n) for scene, n in pictures},
    }


def filled(text: str, name: str, found: dict[str, str]) -> str:
    """Return a page with its blocks filled. Raise ValueError where a marker has no partner, or a block no text."""

    def fill(match: re.Match[str]) -> str:
        if match["name"] not in found:
            raise ValueError(
                f"{name}: no results for the block {match['name']!r}; there are {', '.join(sorted(found))}"
            )
        return f"{match[1]}\n{found[match['name']]}\n\n{match[3]}"

    result, count = _BLOCK.subn(fill, text)
    if len(_MARKER.findall(text)) != 2 * count:
        raise ValueError(f"{name}: a marker begin or end of a block has no partner")
    return result


def update(root: Path, results: Path, write: bool) -> list[str]:
    """Fill the pages below `root` and return which of them change."""
    found = blocks(results)
    texts = {page: (root / page).read_text(encoding="utf-8") for page in PAGES}
    fresh = {page: filled(text, page, found) for page, text in texts.items()}
    stale = [page for page in PAGES if fresh[page] != texts[page]]
    if write:
        for page in stale:
            (root / page).write_text(fresh[page], encoding="utf-8")
    return stale


def draw(results: Path, folder: Path) -> None:
    """Draw all plots into `folder`."""
    import plots  # here, since tables need no matplotlib
    import sweep_plots
    import trade_plots

    figures = plots.figures(newest(results, "peers")) | sweep_plots.figures(newest(results, "sweep"))
    figures |= trade_plots.figures(newest(results, "trade"))
    for path in plots.draw(figures, folder):
        print(f"{path.relative_to(ROOT)}: drawn")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=ROOT / "benchmarks" / "results", metavar="DIR")
    parser.add_argument("--check", action="store_true", help="write nothing, and fail if a table is stale")
    parser.add_argument("--no-plots", action="store_true", help="tables only, for which matplotlib is not needed")
    chosen = parser.parse_args()
    try:
        stale = update(ROOT, chosen.results, write=not chosen.check)
    except ValueError as error:
        sys.exit(str(error))
    for page in stale:
        print(f"{page}: {'stale' if chosen.check else 'written'}")
    if chosen.check:
        sys.exit(1 if stale else 0)
    if not chosen.no_plots:
        draw(chosen.results, ROOT / "docs" / "images")


if __name__ == "__main__":
    main()
