"""`om.study`: its rows, truth and front, what it keeps when interrupted, and its report."""

import json
import re
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import fields
from html.parser import HTMLParser
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import octomarch as om
from octomarch.cli import main
from octomarch.study import GROUPS, flip, plots
from octomarch.study.rows import Measures
from octomarch.study.truth import find_truth

SIZE = (48, 36)
SOLID = om.sphere(1.0) - om.box(1.2)


def floor_scene() -> om.Scene:
    ball = om.sphere(1.0) | om.box(1.0).translate(2, -0.5, 0)
    return om.Scene(ball | om.plane(point=(0, -1, 0)), lights=[om.DirectionalLight((-1, -2, -1))])


@pytest.fixture(scope="module")
def whole() -> om.Study:
    """Study everything, with times."""
    return om.study(floor_scene(), om.Camera((2, 2, 6), (0, 0, 0)), SIZE, rounds=1, march=om.March(max_distance=200))


def numbers(row: om.StudyRow) -> dict[str, Any]:
    return {field.name: getattr(row, field.name) for field in fields(Measures)}


def test_every_group_is_varied_and_the_base_comes_first(whole: om.Study):
    groups = list(dict.fromkeys(row.group for row in whole.table))
    assert groups == [group for group in GROUPS if group != "step"]
    series = whole.table.of("series")
    assert [row.march.max_steps for row in series] == [32, 64, 128, 256, 512] * 2
    assert {row.march.method for row in series} == {"plain"}
    assert [row.march.max_distance == 200 for row in series] == [True] * 5 + [False] * 5


def test_rows_say_what_a_render_says(whole: om.Study):
    for row in [*whole.table.of("pixel_tolerance"), *whole.table.of("precision"), *whole.table.of("normals")]:
        image = om.render(
            floor_scene(),
            om.Camera((2, 2, 6), (0, 0, 0)),
            SIZE,
            march=row.march,
            shading=row.shading,
            precision=row.precision,
            planes=("color", "depth", "normal", "status"),
        )
        counted = sum(image.stats["stages"][stage]["evaluations"] for stage in ("primary", "cones"))
        assert row.evaluations == counted / image.stats["rays"]
        assert row.hit == (image.status == om.Status.HIT).sum()
        assert row.hit + row.miss + row.step_limit + row.inside + row.invalid == SIZE[0] * SIZE[1]


def test_errors_are_those_of_the_settings(whole: om.Study):
    secant, none = whole.table.of("finish")
    assert none.p95 > 100 * secant.p95 > 0
    tolerances = whole.table.of("pixel_tolerance").column("evaluations")
    assert tolerances[0] < tolerances[-1]
    single, double = whole.table.of("precision")
    assert double.p50 < 1e-3 * single.p50
    exact, *differences = whole.table.of("normals")
    assert exact.normal_p95 <= min(row.normal_p95 for row in differences)
    assert exact.normal_p95 < 1e-3 < max(row.normal_p95 for row in differences)
    assert whole.table.of("base")[0].cut == 0
    assert whole.table.of("series")[-1].cut > 0  # the floor goes on behind what is bounded
    assert not whole.table.column("false_misses")[[row.march.method != "fixed" for row in whole.table]].any()


def test_certified_steps_end_no_ray_wrong_and_are_left_out_where_nothing_can_be_proven(whole: om.Study):
    [certified] = [row for row in whole.table.of("method") if row.march.method == "certified"]
    assert certified.wrong == 0
    x, y, z = om.coordinates()
    field = om.field(om.sqrt(x * x + y * y + z * z) - 1 + 0.01 * om.noise(x, y, z))
    study = om.study(field, size=(16, 12), groups=("method",), rounds=0)
    assert "certified" not in {row.march.method for row in study.table}


def test_times_are_there_when_there_are_rounds(whole: om.Study):
    assert (whole.table.column("depth_ms") > 0).all()
    assert (whole.table.column("picture_ratio") > 0).all()
    still = om.study(SOLID, size=(16, 16), groups=("finish",), rounds=0)
    assert np.isnan(still.table.column("depth_ms")).all()
    assert "ms" not in str(still.table)


def test_front_has_nothing_that_another_row_beats(whole: om.Study):
    costs = np.stack([whole.table.column(name) for name in ("evaluations", "p95", "wrong")], axis=-1)
    taking_part = (whole.table.column("cut") == 0) & np.array([row.precision == "float32" for row in whole.table])
    for row in whole.front:
        own = np.array([row.evaluations, row.p95, row.wrong])
        assert not ((costs <= own).all(axis=1) & (costs < own).any(axis=1) & taking_part).any()
    assert not whole.front.column("cut").any()
    assert (np.diff(whole.front.column("evaluations")) >= 0).all()


def test_truth_is_proven_where_that_is_affordable():
    camera = om.Camera((0, 0, 4), (0, 0, 0))
    march = om.March().resolve(om.compile(SOLID), camera.eye)
    proven = find_truth(om.Scene(SOLID), camera, SIZE, march)
    double = find_truth(om.Scene(SOLID), camera, SIZE, march, kind="float64")
    assert proven.proven.all()
    assert not double.proven.any()
    assert proven.disagreements == 0
    np.testing.assert_allclose(proven.depth, double.depth, rtol=1e-8)
    parts = find_truth(om.Scene(SOLID), camera, SIZE, march, share=0.002)  # of which some lines are proven
    assert 0 < parts.proven.mean() < 0.5
    assert set(parts.proven.mean(axis=1)) == {0.0, 1.0}


def test_truth_of_rays_from_inside_is_not_known():
    camera = om.Camera((0, 0, 0), (0, 0, -1))
    march = om.March().resolve(om.compile(om.sphere(1.0)), camera.eye)
    assert np.isnan(find_truth(om.Scene(om.sphere(1.0)), camera, SIZE, march).depth).all()


def test_solids_are_studied_by_their_steps():
    x, y, z = om.coordinates()
    ball = om.solid(x * x + y * y + z * z <= 1)
    study = om.study(ball, om.Camera((0, 0, 4), (0, 0, 0)), (16, 12), rounds=0, groups=("step", "method", "epsilon"))
    assert {row.group for row in study.table} == {"base", "step"}
    assert study.table.of("step").column("evaluations")[-1] > study.table.of("step").column("evaluations")[0]


class Stop:
    """A progress callable that interrupts, as Ctrl-C would."""

    def __init__(self, after: int) -> None:
        self.after = after
        self.seen: list[tuple[int, int]] = []

    def __call__(self, done: int, total: int) -> None:
        self.seen.append((done, total))
        if done == self.after:
            raise KeyboardInterrupt


def test_an_interrupted_study_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "kept.json"
    options: dict[str, Any] = {"size": SIZE, "groups": ("series", "epsilon"), "rounds": 0, "resume": path}
    with pytest.raises(KeyboardInterrupt):
        om.study(SOLID, **options, progress=Stop(after=4))
    assert len(json.loads(path.read_text())["rows"]) == 4
    calls = []
    original = om.study.__globals__["measure"]
    monkeypatch.setitem(
        om.study.__globals__, "measure", lambda work, _: (calls.append(work.setting.name), original(work))[1]
    )
    resumed = om.study(SOLID, **options)
    assert len(calls) == len(resumed.table) - 4
    calls.clear()
    again = om.study(SOLID, **options)
    assert not calls
    fresh = om.study(SOLID, **{**options, "resume": None})
    assert [numbers(row) for row in again.table] == [numbers(row) for row in resumed.table]
    assert [numbers(row) for row in fresh.table] == [numbers(row) for row in resumed.table]


def test_progress_is_told_to_the_end():
    stop = Stop(after=-1)
    om.study(SOLID, size=(16, 16), groups=("finish",), rounds=0, progress=stop)
    assert sorted(set(stop.seen)) == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert stop.seen == sorted(stop.seen)


def test_what_another_study_has_kept_is_refused(tmp_path: Path):
    path = tmp_path / "kept.json"
    om.study(SOLID, size=SIZE, groups=("finish",), rounds=0, resume=path)
    with pytest.raises(ValueError, match=r"kept\.json: kept by another study, size was \[48, 36\] and is \[16, 16\]"):
        om.study(SOLID, size=(16, 16), groups=("finish",), rounds=0, resume=path)
    with pytest.raises(ValueError, match=r"kept\.json: kept by another study, scene was"):
        om.study(om.sphere(1.0), size=SIZE, groups=("finish",), rounds=0, resume=path)


def test_places_that_cannot_be_written_are_told_at_once(tmp_path: Path):
    stop = Stop(after=0)
    with pytest.raises(FileNotFoundError, match=r"kept\.json: there is no directory"):
        om.study(SOLID, size=SIZE, rounds=0, resume=tmp_path / "none" / "kept.json", progress=stop)
    assert not stop.seen


@pytest.mark.parametrize(
    "camera",
    [
        om.OrthographicCamera((0, 0, 4), (0, 0, 0), height=3),
        om.PanoramicCamera((0, 0, 4), (0, 0, 0)),
        om.Camera((0, 0, 4), (0, 0, 9)),  # which sees nothing
        om.Camera((0.8, 0.1, 0), (0, 0, 9)),  # inside
    ],
    ids=["orthographic", "panoramic", "nothing", "inside"],
)
def test_every_view_can_be_studied(camera: Any):
    study = om.study(SOLID, camera, (24, 16), groups=("series", "method", "precision"), rounds=0)
    assert len(study.table) == 19
    assert len(study.front) >= 1
    study._repr_html_()


def test_fixed_steps_can_be_the_base():
    march = om.March("fixed", step=0.05, max_distance=9)
    study = om.study(SOLID, size=(24, 16), march=march, groups=("series", "step", "method", "finish"), rounds=0)
    assert {row.march.method for row in study.table} == {"fixed"}
    assert {row.group for row in study.table} == {"base", "series", "step", "finish"}


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"study": 9, "subject": {}, "rows": {}}', '{"study": 1'])
def test_damaged_files_are_refused(tmp_path: Path, text: str):
    path = tmp_path / "kept.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"kept\.json: not what a study has kept"):
        om.study(SOLID, size=SIZE, groups=("finish",), rounds=0, resume=path)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"scene": 3}, TypeError, r"scene must be an om\.Shape or om\.Scene, got 3"),
        ({"camera": 3}, TypeError, r"camera must be an om\.Camera.*, got 3"),
        ({"size": (0, 9)}, ValueError, r"size\[0\] must lie in \[1, .*, got 0"),
        ({"march": "plain"}, TypeError, r"march must be an om\.March, got 'plain'"),
        ({"shading": 1}, TypeError, r"shading must be an om\.Shading, got 1"),
        ({"precision": "half"}, ValueError, r"precision must be one of .*, got 'half'"),
        ({"far": -1.0}, ValueError, r"far must be > 0, got -1\.0"),
        ({"groups": ("colour",)}, ValueError, r"groups must be one of 'base', 'series'.*, got 'colour'"),
        ({"groups": 5}, TypeError, r"groups must be names of groups, got 5"),
        ({"truth": "oracle"}, ValueError, r"truth must be one of 'auto', 'certified', 'float64', got 'oracle'"),
        ({"rounds": -1}, ValueError, r"rounds must lie in \[0, 1000\], got -1"),
        ({"rounds": 1.5}, TypeError, r"rounds must be an integer, got 1\.5"),
        ({"threads": 0}, ValueError, r"threads must lie in"),
        ({"isa": "mmx"}, ValueError, r"isa .*mmx"),
        ({"progress": 3}, TypeError, r"progress must be True, a callable or None, got 3"),
    ],
)
def test_wrong_arguments_are_named(arguments: dict[str, Any], error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.study(**{"scene": SOLID, "size": (16, 16), "groups": ("finish",), "rounds": 0, **arguments})


def test_wrong_columns_and_paths_are_named(whole: om.Study, tmp_path: Path):
    with pytest.raises(ValueError, match=r"columns must be one of 'evaluations'.*, got 'beauty'"):
        whole.pareto("beauty")
    with pytest.raises(ValueError, match=r"columns must name at least one number"):
        whole.pareto()
    with pytest.raises(ValueError, match=r"name must be one of .*, got 'beauty'"):
        whole.table.column("beauty")
    with pytest.raises(ValueError, match=r"path must end in \.html, got .*study\.pdf"):
        whole.save(tmp_path / "study.pdf")


def test_tables_show_themselves(whole: om.Study):
    text = str(whole.table)
    assert len(text.splitlines()) == len(whole.table) + 1
    assert all(row.name in text for row in whole.table)
    assert whole.table._repr_html_().count("<tr>") == len(whole.table) + 1
    assert "certified" in str(whole)
    assert repr(whole.table[1:3]) == "<StudyTable of 2 settings>"


class Links(HTMLParser):
    """Collects what a page would load or lead to, and its pictures."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attributes if name in ("src", "href", "srcset", "data", "action")]


def test_report_holds_all_that_it_shows(whole: om.Study, tmp_path: Path):
    whole.save(tmp_path / "study.html")
    text = (tmp_path / "study.html").read_text()
    page = Links()
    page.feed(text)
    assert all(link.startswith("data:image/png;base64,") for link in page.links)
    assert not re.search(r"https?://|url\(|@import|<script|<link", text)
    assert page.tags.count("figure") == 11  # the truth, and ten pictures
    assert len(page.links) == 1 + 10 * 2 + plots.available()
    assert all(row.name in text for row in whole.table)
    assert whole.truth in text


def test_report_without_extras_says_what_to_install(whole: om.Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(plots, "available", lambda: False)
    monkeypatch.setattr(flip, "available", lambda: False)
    whole.save(tmp_path / "study.html")
    assert "pip install &#x27;octomarch[study]&#x27;" in (tmp_path / "study.html").read_text()
    assert om.study(SOLID, size=(16, 16), groups=("finish",), rounds=0).table[0].flip is None


def test_missing_extras_are_named(whole: om.Study, monkeypatch: pytest.MonkeyPatch):
    for module in ("matplotlib.figure", "flip_evaluator"):
        monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(ImportError, match=r"pip install 'octomarch\[study\]'"):
        whole.plot()
    with pytest.raises(ImportError, match=r"FLIP needs .*pip install 'octomarch\[study\]'"):
        flip.flip_map(np.zeros((8, 8, 3), np.uint8), np.zeros((8, 8, 3), np.uint8))


def test_flip_tells_pictures_apart():
    pytest.importorskip("flip_evaluator")
    black, white = np.zeros((24, 32, 3), np.uint8), np.full((24, 32, 3), 255, np.uint8)
    assert not flip.flip_map(black, black).any()
    assert flip.flip_map(black, white).shape == (24, 32)
    assert flip.flip_map(black, white).mean() > 0.9


def test_plots_have_an_axis_for_each_cost(whole: om.Study):
    pytest.importorskip("matplotlib")
    assert len(whole.plot().axes) == 2
    assert len(om.study(SOLID, size=(16, 16), groups=("epsilon",), rounds=0).plot().axes) == 1


def test_command_makes_a_report_and_keeps_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    om.Shot(floor_scene(), om.Camera((2, 2, 6), (0, 0, 0)), march=om.March(max_distance=50)).save(tmp_path / "a.json")
    out = tmp_path / "out.html"
    command = ["study", str(tmp_path / "a.json"), "-o", str(out), "--size", "32x24", "--rounds", "0"]
    assert main([*command, "--groups", "finish,series"]) == 0
    told = capsys.readouterr().out
    assert "secant" in told
    assert str(out) in told
    assert len(json.loads((tmp_path / "out.json").read_text())["rows"]) == 12  # the base is the secant
    assert json.loads(json.loads((tmp_path / "out.json").read_text())["subject"]["base"])[0]["max_distance"] == 50
    assert main(["study", "blend", "-o", str(tmp_path / "out.pdf")]) == 1
    assert "OUT must end in .html" in capsys.readouterr().err
    assert main(["study", "blend", "-o", str(tmp_path / "none" / "out.html")]) == 1
    assert "there is no directory" in capsys.readouterr().err


def test_interrupted_command_says_how_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    module, names = om.study.__globals__, []
    original = module["measure"]

    def twice(work: Any, _: Any) -> Measures:
        if len(names) == 2:
            raise KeyboardInterrupt
        names.append(work.setting.name)
        return original(work)

    om.Scene(SOLID).save(tmp_path / "a.json")
    command = ["study", str(tmp_path / "a.json"), "-o", str(tmp_path / "out.html"), "--size", "16x12", "--rounds", "0"]
    monkeypatch.setitem(module, "measure", twice)
    assert main([*command, "--groups", "epsilon"]) == 130
    assert f"{tmp_path / 'out.json'} has what is done; the same command goes on" in capsys.readouterr().err
    monkeypatch.setitem(module, "measure", original)
    assert main([*command, "--groups", "epsilon"]) == 0
    assert (tmp_path / "out.html").exists()


# Executors -----------------------------------------------------------------------------------------------------------

COUNTS = {"size": (32, 24), "groups": ("series", "finish", "shadows"), "truth": "float64", "rounds": 0}


class Unreliable:
    """Runs each call at once, but fails the first time, and always where a setting is named so."""

    def __init__(self, always: str = "") -> None:
        self.always, self.seen = always, []

    def submit(self, function, work, *rest):
        future = Future()
        if work.setting.name == self.always or work.setting.key not in self.seen:
            self.seen.append(work.setting.key)
            future.set_exception(OSError("the network is down"))
        else:
            future.set_result(function(work, *rest))
        return future


def test_executors_measure_the_same():
    here = om.study(SOLID, **COUNTS)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        there = om.study(SOLID, **COUNTS, executor=pool)
    assert [numbers(row) for row in there.table] == [numbers(row) for row in here.table]
    assert [row.name for row in there.table] == [row.name for row in here.table]


def test_settings_that_fail_are_tried_again_and_the_others_kept(tmp_path: Path):
    here = om.study(SOLID, **COUNTS)
    again = om.study(SOLID, **COUNTS, executor=Unreliable(), retries=1)
    assert [numbers(row) for row in again.table] == [numbers(row) for row in here.table]
    kept = tmp_path / "kept.json"
    with pytest.raises(OSError, match="network") as caught:
        om.study(SOLID, **COUNTS, executor=Unreliable("soft, k 8"), retries=1, resume=kept)
    assert re.match(r"1 of \d+ settings failed, the first was soft, k 8", caught.value.__notes__[0])
    rows = json.loads(kept.read_text())["rows"]
    om.study(SOLID, **COUNTS, executor=Unreliable(), retries=1, resume=kept)
    assert len(json.loads(kept.read_text())["rows"]) == len(rows) + 1


def test_an_interrupted_study_keeps_what_executors_have_measured(tmp_path: Path):
    def stop(done: int, _: int) -> None:
        if done >= 12:
            raise KeyboardInterrupt

    kept = tmp_path / "kept.json"
    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt):
        om.study(SOLID, **COUNTS, executor=pool, progress=stop, resume=kept)
    assert len(json.loads(kept.read_text())["rows"]) >= 4


@pytest.mark.parametrize("options", [{"executor": 4}, {"executor": Unreliable}, {"retries": -1}, {"retries": 1.5}])
def test_wrong_executors_are_refused(options: dict[str, Any]):
    with pytest.raises((TypeError, ValueError), match=next(iter(options))):
        om.study(SOLID, **COUNTS, **options)
