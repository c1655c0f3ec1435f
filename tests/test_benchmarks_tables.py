"""Tables of the documentation come from benchmarks/results: they are fresh, and damaged results are refused."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results"

Damage = Callable[[Any], None]


@pytest.fixture
def tables(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import tables

    return tables


@pytest.fixture
def copy(tables: Any, tmp_path: Path) -> Path:
    """Copy pages and results, so that they may be changed."""
    for page in tables.PAGES:
        (tmp_path / page).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / page, tmp_path / page)
    shutil.copytree(RESULTS, tmp_path / "results")
    return tmp_path


def damage(copy: Path, pattern: str, change: Damage) -> None:
    path = sorted((copy / "results").glob(pattern))[-1]
    result = json.loads(path.read_text())
    change(result)
    path.write_text(json.dumps(result))


def test_tables_of_the_repository_are_what_the_results_say(tables: Any):
    assert tables.update(ROOT, RESULTS, write=False) == [], "make bench-tables writes them"


def test_tables_are_the_same_when_made_again(tables: Any, copy: Path):
    for page in tables.PAGES:  # stale, so that the first time has something to do
        text = (copy / page).read_text()
        (copy / page).write_text(text.replace("| **octomarch", "| **stale"))
    assert tables.update(copy, copy / "results", write=True) == list(tables.PAGES[:2])
    texts = {page: (copy / page).read_text() for page in tables.PAGES}
    assert tables.update(copy, copy / "results", write=True) == []
    assert texts == {page: (ROOT / page).read_text() for page in tables.PAGES}


def test_tables_are_taken_from_the_newest_run(tables: Any, copy: Path):
    path = sorted((copy / "results").glob("peers-*.json"))[-1]
    result = json.loads(path.read_text())
    result["machine"] |= {"date": "2999-01-01T00:00:00+00:00", "commit": "abcdef"}
    (copy / "results" / "peers-0.json").write_text(json.dumps(result))
    assert "at abcdef" in tables.blocks(copy / "results")["peers-how"]


@pytest.mark.parametrize(
    ("pattern", "change", "message"),
    [
        ("peers-*.json", lambda r: r.pop("rows"), "peers-.*'rows' is missing"),
        ("peers-*.json", lambda r: r["rows"][0].update(contender="nobody"), r"rows\[0\]: unknown contender 'nobody'"),
        ("peers-*.json", lambda r: r["rows"][1].update(status="fine"), r"rows\[1\]: unknown status 'fine'"),
        ("peers-*.json", lambda r: r["rows"][0].pop("median"), r"rows\[0\]: median missing"),
        ("peers-*.json", lambda r: r["rows"][0].update(mode="fog"), r"rows\[0\]: no such picture"),
        ("hand-*.json", lambda r: r.pop("verdicts"), "hand-.*: 'verdicts' is missing"),
        ("hand-*.json", lambda r: r["rows"].clear(), "hand-.*: 'rows' is missing"),
        ("hand-*.json", lambda r: r["rows"][2].pop("median"), r"hand-.*: rows\[2\]: median missing"),
        ("quality.json", lambda r: r.pop("rows"), "quality.json: 'rows' is missing"),
        ("quality.json", lambda r: r["rows"][0].pop("p99"), r"quality.json: rows\[0\]: p99 missing"),
        ("evaluations.json", lambda r: r.pop("rows"), "evaluations.json: 'rows' is missing"),
        ("long-*.json", lambda r: r.pop("latency"), "long-.*'latency' is missing"),
        ("long-*.json", lambda r: r["pictures"][0].pop("peak_bytes"), r"pictures\[0\]: peak_bytes missing"),
        ("evaluations.json", lambda r: r["rows"][0].pop("p95"), r"evaluations.json: rows\[0\]: p95 missing"),
        ("extremes.json", lambda r: r.pop("folds"), "extremes.json: 'folds' is missing"),
        ("extremes.json", lambda r: r["offsets"][0].pop("lost"), r"extremes.json: offsets\[0\]: lost missing"),
        ("extremes.json", lambda r: r["folds"].pop("order"), "extremes.json: folds: order missing"),
        ("sweep-*.json", lambda r: r.pop("settings"), "sweep-.*: 'settings' is missing"),
        ("sweep-*.json", lambda r: r["rows"]["balls"][1].pop("cells"), r"sweep-.*: rows.balls\[1\]: cells missing"),
        ("sweep-*.json", lambda r: r["rows"]["isas"][0]["cpu"].clear(), r"sweep-.*: rows.isas\[0\]: cpu and wall"),
        ("sweep-*.json", lambda r: r["rows"].update(luck=[]), "sweep-.*: rows: unknown sweep 'luck'"),
    ],
)
def test_damaged_results_are_refused(tables: Any, copy: Path, pattern: str, change: Damage, message: str):
    damage(copy, pattern, change)
    with pytest.raises(ValueError, match=message):
        tables.update(copy, copy / "results", write=True)
    assert all((copy / page).read_text() == (ROOT / page).read_text() for page in tables.PAGES)


def test_no_results_are_refused(tables: Any, copy: Path):
    for path in (copy / "results").glob("peers-*.json"):
        path.unlink()
    with pytest.raises(ValueError, match=r"no peers-\*\.json"):
        tables.update(copy, copy / "results", write=True)


def test_marches_by_hand_are_those_of_the_newest_day_and_commit(tables: Any, copy: Path):
    runs = tables.by_hand(copy / "results")
    assert len({run["machine"]["commit"] for run in runs}) == 1
    newer = runs[0] | {"machine": runs[0]["machine"] | {"date": "2999-01-01T00:00:00+00:00"}}
    (copy / "results" / "hand-0.json").write_text(json.dumps(newer))
    assert [run["machine"]["date"][:4] for run in tables.by_hand(copy / "results")] == ["2999"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<!-- begin: by-hand -->\nno end\n", "no partner"),
        ("<!-- begin: nonsense -->\n<!-- end: nonsense -->\n", "no results for the block 'nonsense'"),
    ],
)
def test_damaged_pages_are_refused(tables: Any, text: str, message: str):
    with pytest.raises(ValueError, match=f"README.md: .*{message}"):
        tables.filled(text, "README.md", {"by-hand": "a table"})


def test_command_ends_with_the_file_that_is_no_json(copy: Path):
    (copy / "results" / "quality.json").write_text("{")
    command = [sys.executable, "benchmarks/tables.py", "--check", "--results", str(copy / "results")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("quality.json: not JSON: ")


def test_plots_are_the_same_when_drawn_again(tables: Any, tmp_path: Path):
    pytest.importorskip("matplotlib")
    import plots

    figures = plots.figures(tables.newest(RESULTS, "peers"))
    first, second = ([p.read_bytes() for p in plots.draw(figures, tmp_path)] for _ in range(2))
    assert first == second
