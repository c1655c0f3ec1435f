"""The sweeps of the benchmarks: a quick run has every row, tables and plots take it, and sentences follow figures."""

import json
import subprocess
import sys
import weakref
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import pytest

import octomarch as om
from octomarch.march import Method

ROOT = Path(__file__).parents[1]


@pytest.fixture(autouse=True)
def _benchmarks_are_importable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Run the command once, as ``make bench`` does but quickly."""
    out = tmp_path_factory.mktemp("sweep") / "sweep.json"
    command = [sys.executable, "benchmarks/sweep.py", "--quick", "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "| scene | method | ms |" in done.stdout
    return json.loads(out.read_text())


def test_quick_run_has_all_rows(quick: Any):
    import sweep_rows

    sweep_rows.check(quick, "quick")
    rows = quick["rows"]
    assert set(rows) == set(sweep_rows.COLUMNS)
    assert {(row["scene"], row["method"]) for row in rows["methods"]} == {
        (s, m) for s in "ABC" for m in get_args(Method)
    }
    assert {row["isa"] for row in rows["isas"]} == set(om.isas())
    assert {row["precision"] for row in rows["isas"]} == {"float32", "float64"}
    assert {row["n"] for row in rows["balls"]} == set(quick["settings"]["counts"])
    assert {row["picture"] for row in rows["balls"]} == {"first", "again", "turned", "whole"}
    assert {row["side"] for row in rows["resolution"]} == set(quick["settings"]["sides"])


def test_all_methods_find_the_surfaces_of_the_truth(quick: Any):
    pixels = quick["settings"]["size"][0] * quick["settings"]["size"][1]
    for row in quick["rows"]["methods"]:
        # certified brackets grow with what roundings of float32 may come to at the worst
        assert row["error"]["p50"] < (1e-3 if row["method"] == "certified" else 1e-4), row
        assert row["error"]["false_hits"] + row["error"]["false_misses"] < 0.01 * pixels, row


def test_features_cost_nothing_when_they_are_off(quick: Any):
    rows = quick["rows"]["features"]
    assert sum(row["off_pairs"] for row in rows) > 10
    assert [row["feature"] for row in rows if row["different_counts"] or row["different_pixels"]] == []


def test_counts_that_differ_are_counted():
    from sweeps.features import AMBIENT, DEPTH, LIT, different_counts, different_pixels

    lit, ambient, depth = (setting.render((32, 24)) for setting in (LIT, AMBIENT, DEPTH))
    assert different_counts(lit.stats, ambient.stats) == 1  # gradients
    assert different_pixels(lit, ambient) > 100
    assert different_counts(depth.stats, depth.stats) == different_pixels(depth, depth) == 0


def test_first_pictures_of_balls_are_of_new_shapes(monkeypatch: pytest.MonkeyPatch):
    """Nothing that a shape keeps from picture to picture may be there when the next round begins."""
    from sweeps import balls
    from sweeps.plan import QUICK
    from sweeps.views import View, view

    made: list[weakref.ref[object]] = []

    def watched(name: str, n: int) -> View:
        assert [node for node in made if node()] == []
        seen = view(name, n)
        made.append(weakref.ref(seen.shape._node))
        return seen

    monkeypatch.setattr(balls, "view", watched)
    balls.measure(replace(QUICK, rounds_of_counts=3))
    assert len(made) == 3 * len(QUICK.counts)


def test_tables_of_a_part_have_no_more(quick: Any):
    import sweep_tables

    part = {**quick, "rows": {"threads": quick["rows"]["threads"]}}
    assert set(sweep_tables.blocks(part)) == {"sweep-how", "sweep-threads", "sweep-summary"}


def test_sentences_say_who_wins(quick: Any):
    import sweep_words

    rows = [row | {"cpu": [2.0 if row["method"] == "auto" else 3.0]} for row in quick["rows"]["methods"]]
    assert sweep_words.methods(rows).count("nothing is faster than the default") == 3
    next(row for row in rows if row["method"] == "relaxed")["cpu"] = [1.0]
    assert "- A: `relaxed` wins, with 0.50 of the time of the default" in sweep_words.methods(rows)


def test_sentences_say_where_the_whole_program_wins(quick: Any):
    import sweep_words

    rows = [
        row | {"cells": 9, "cpu": [{"first": 3.0, "again": 1.0}.get(row["picture"], 2.0)]}
        for row in quick["rows"]["balls"]
    ]
    text = sweep_words.balls(rows)
    assert "- 60 balls: **the whole program wins** over a first picture in parts, which takes 1.50 times" in text
    assert "- 60 balls: one that follows in parts takes 0.50 of the time of the whole program." in text


def test_sentence_tells_of_what_costs_although_it_is_off(quick: Any):
    import sweep_words

    rows = [dict(row) for row in quick["rows"]["features"]]
    assert "so that what is off costs nothing" in sweep_words.features(rows)
    rows[5]["different_counts"] = 2
    assert "2 counts of `image.stats`" in sweep_words.features(rows)
    assert "costs although it is off" in sweep_words.features(rows)


def test_plots_are_drawn(quick: Any, tmp_path: Path):
    pytest.importorskip("matplotlib")
    import plots
    import sweep_plots

    drawn = plots.draw(sweep_plots.figures(quick), tmp_path)
    assert {path.name for path in drawn} >= {"benchmarks-balls.svg", "benchmarks-features.svg"}


def test_threads_are_tried_up_to_all_processors():
    from sweeps.threads import numbers

    assert numbers(1) == [1]
    assert numbers(12) == [1, 2, 3, 4, 5, 6, 7, 8, 12]
    assert numbers(64)[-4:] == [8, 16, 32, 64]


def test_results_are_never_overwritten(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    import machine

    monkeypatch.setattr(machine, "RESULTS", tmp_path)
    description = {"date": "2030-01-02T03:04:05+00:00", "processor": {"model": "Some (R) CPU"}}
    names = []
    for _ in range(3):
        path = machine.result_file(description, "sweep-")
        path.write_text("{}")
        names.append(path.name)
    first = "sweep-2030-01-02-some-r-cpu"
    assert names == [f"{first}.json", f"{first}-2.json", f"{first}-3.json"]
