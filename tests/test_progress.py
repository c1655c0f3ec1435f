"""Long work tells how far it has come, and ends when it is told to."""

import re
import threading
import time
from pathlib import Path

import pytest

import octomarch as om

BALL, CAMERA = om.sphere(1.0), om.Camera((3, 2, 4), (0, 0, 0))
STAR = om.star(5, 1.0, 0.5).extrude(0.5)
PATIENCE = 1.0
"""Seconds from cancelling to the exception on a machine that does much else; on an idle one it is some hundredths."""


def test_a_bar_counts_rays_and_tells_the_time_left(capsys: pytest.CaptureFixture[str]):
    om.render(BALL, CAMERA, (3000, 2000), samples=2, progress=True)
    bars = capsys.readouterr().err
    assert "12.0M" in bars  # all rays of the colours
    assert re.search(r"\d\d:\d\d<\d\d:\d\d, +[\d.]+[kM] rays/s", bars)


def test_progress_follows_a_render():
    calls: list[tuple[int, int]] = []
    work = om.Progress(lambda *call: calls.append(call))
    assert (work.done, work.total, work.fraction, work.cancelled) == (0, 0, 0.0, False)
    om.render(BALL, CAMERA, (300, 200), progress=work)
    assert work.fraction == 1.0
    assert work.done == work.total == calls[-1][0]


def test_cancel_ends_a_render_from_another_thread():
    work, cancelled = om.Progress(), []

    def cancel() -> None:
        cancelled.append(time.monotonic())
        work.cancel()

    threading.Timer(0.2, cancel).start()
    with pytest.raises(om.CancelledError, match=r"cancelled at \d+%"):
        om.render(BALL, CAMERA, (16000, 16000), progress=work)
    assert time.monotonic() - cancelled[0] < PATIENCE
    assert work.cancelled
    assert 0 < work.fraction < 0.5


def test_cancelled_work_does_not_begin():
    work = om.Progress(lambda *_: pytest.fail("called"))
    work.cancel()
    work.cancel()
    with pytest.raises(om.CancelledError, match="before it began"):
        om.render(BALL, CAMERA, (16000, 16000), progress=work)


SLOW = {
    "truth": lambda stop: om.study(STAR, size=(320, 240), rounds=0, progress=stop),
    "pictures": lambda stop: om.study(
        BALL, CAMERA, (2000, 1500), truth="float64", groups=("base",), rounds=0, progress=stop
    ),
    "search": lambda stop: om.March.for_error(STAR, p95=1e-5, progress=stop),
}


@pytest.mark.parametrize("name", SLOW)
def test_parts_of_long_work_listen_too(name: str):
    """Before anything of it is done, more than once."""
    calls: list[int] = []

    def stop(done: int, _: int) -> None:
        calls.append(done)
        if len(calls) == 3:
            raise om.CancelledError

    with pytest.raises(om.CancelledError):
        SLOW[name](stop)
    assert calls == [0, 0, 0]


def test_listeners_may_render_themselves():
    pictures = []

    def show(*_: int) -> None:
        if len(pictures) < 3:
            pictures.append(om.render(BALL, CAMERA, (300, 200)))

    om.study(BALL, CAMERA, (300, 200), groups=("base",), truth="float64", rounds=0, progress=show)
    assert len(pictures) == 3


def test_bars_of_frames_count_rays(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    om.render_frames(BALL, [CAMERA] * 5, (2000, 1500), out=tmp_path / "{}.exr", samples=2, progress=True)
    bars = capsys.readouterr().err
    assert "30.0M" in bars
    assert re.search(r"rays/s, [1-5] of 5 frames", bars)


def test_bad_callbacks_are_refused():
    with pytest.raises(TypeError, match="callback must be callable or None, got 3"):
        om.Progress(3)  # type: ignore[arg-type]
