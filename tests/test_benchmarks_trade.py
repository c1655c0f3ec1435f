"""The trade of the benchmarks: a quick run has every row, tables and plots take it, and damaged results are refused."""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(autouse=True)
def _benchmarks_are_importable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Run the command once, as ``make bench`` does but quickly."""
    out = tmp_path_factory.mktemp("trade") / "trade.json"
    command = [sys.executable, "benchmarks/trade.py", "--quick", "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "| scene | steps | finish |" in done.stdout
    return json.loads(out.read_text(), parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))


def test_quick_run_has_all_rows(quick: Any):
    import trade
    import trade_tables

    trade_tables.check(quick, "quick")
    keys = {(row["scene"], row["method"], row["finish"], row["tolerance"]) for row in quick["rows"]}
    assert len(keys) == len(quick["rows"]) == 3 * len(trade.METHODS) * len(trade.FINISHES) * len(trade.TOLERANCES)
    assert all(row["simd"]["cpu"] and row["lane"]["cpu"] for row in quick["rows"])


def test_lanes_change_no_bit_and_finer_plain_steps_are_no_cheaper(quick: Any):
    from sweep_rows import values, where

    assert all(row["same_bits"] for row in quick["rows"])
    for scene in values(quick["rows"], "scene"):
        some = where(quick["rows"], scene=scene, method="plain", finish="secant")
        costs = [row["evaluations"] for row in sorted(some, key=lambda row: -row["tolerance"])]
        assert costs == sorted(costs)


def test_nothing_beats_the_front(quick: Any):
    def costs(row: Any) -> tuple[float, float, int]:
        return (
            row["evaluations"],
            math.inf if row["p95"] is None else row["p95"],
            row["false_hits"] + row["false_misses"],
        )

    for row in quick["rows"]:
        others = [costs(other) for other in quick["rows"] if other["scene"] == row["scene"]]
        beaten = any(all(a <= b for a, b in zip(o, costs(row), strict=True)) and o != costs(row) for o in others)
        assert not (row["front"] and beaten)


def test_words_tell_the_defaults_of_each_scene(quick: Any):
    import trade_tables

    found = trade_tables.blocks(quick)
    assert [line[2] for line in found["trade-summary"].splitlines()] == ["A", "B", "C"]
    assert "which gave the same bits" in found["trade-how"]


def test_plots_are_drawn(quick: Any, tmp_path: Path):
    pytest.importorskip("matplotlib")
    import plots
    import trade_plots

    [path] = plots.draw(trade_plots.figures(quick), tmp_path)
    assert path.read_text().count('<g id="axes_') == 6


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: r.pop("rows"), "quick: 'rows' is missing"),
        (lambda r: r["rows"].clear(), "quick: 'rows' is missing"),
        (lambda r: r["rows"][3].pop("p95"), r"quick: rows\[3\]: p95 missing"),
        (lambda r: r.update(machine=3), "quick: 'machine' is missing"),
    ],
)
def test_damaged_results_are_refused(quick: Any, change: Any, message: str):
    import trade_tables

    damaged = json.loads(json.dumps(quick))
    change(damaged)
    with pytest.raises(ValueError, match=message):
        trade_tables.check(damaged, "quick")
