"""Long work tells how far it has come, and ends when it is told to."""

import re
import threading
import time

import pytest

import octomarch as om

BALL, CAMERA = om.sphere(1.0), om.Camera((3, 2, 4), (0, 0, 0))
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


def test_bad_callbacks_are_refused():
    with pytest.raises(TypeError, match="callback must be callable or None, got 3"):
        om.Progress(3)  # type: ignore[arg-type]
