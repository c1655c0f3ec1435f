"""Work on a thread of its own: the latest wins, and nobody waits."""

import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest

from octomarch.progress import CancelledError
from octomarch.viewer.turns import Turn, Turns

PATIENCE = 20.0
"""Seconds that a thread may take on a machine that does much else."""


class Desk:
    """Work whose turns the test lets begin and end."""

    def __init__(self) -> None:
        self.begun = threading.Semaphore(0)
        self.go_on = threading.Semaphore(0)
        self.turns: list[Turn] = []
        self.queue = Turns(self.work)

    def work(self, turn: Turn) -> None:
        self.turns.append(turn)
        self.begun.release()
        assert self.go_on.acquire(timeout=PATIENCE)

    def wait(self) -> Turn:
        assert self.begun.acquire(timeout=PATIENCE)
        return self.turns[-1]


@pytest.fixture
def desk() -> Iterator[Desk]:
    made = Desk()
    yield made
    made.go_on.release(100)
    made.queue.close()


def test_no_thread_before_somebody_asks():
    before = threading.active_count()
    Turns(lambda turn: None).close()
    assert threading.active_count() == before


def test_asking_during_a_turn_brings_about_one_more(desk: Desk):
    desk.queue.ask()
    first = desk.wait()
    assert not first.is_late
    for _ in range(10):
        desk.queue.ask()
    assert first.is_late
    desk.go_on.release()
    second = desk.wait()
    assert second is not first
    assert not second.is_late
    desk.go_on.release()
    assert not desk.begun.acquire(timeout=0.1)
    assert len(desk.turns) == 2


def test_work_that_may_be_left_out_ends(desk: Desk):
    desk.queue.ask()
    turn = desk.wait()
    turn.pause(0)
    under_way = turn.progress()
    under_way(1, 4)
    desk.queue.ask()
    assert under_way.cancelled
    with pytest.raises(CancelledError, match="cancelled at 25%"):
        under_way(2, 4)
    with pytest.raises(CancelledError, match="newer work"):
        turn.pause(PATIENCE)
    assert turn.progress().cancelled


def test_a_cancelled_turn_is_no_error():
    done = threading.Event()
    turns: list[Turn] = []

    def work(turn: Turn) -> None:
        turns.append(turn)
        if len(turns) == 1:
            raise CancelledError("there is newer work")
        done.set()

    queue = Turns(work)
    queue.ask()
    while not turns:
        pass
    queue.ask()
    assert done.wait(PATIENCE)
    queue.close()


def test_errors_are_told_and_work_goes_on(monkeypatch: pytest.MonkeyPatch):
    told: list[threading.ExceptHookArgs] = []
    monkeypatch.setattr(threading, "excepthook", told.append)
    done = threading.Event()

    def work(_: Turn) -> None:
        if not told:
            raise ValueError("not today")
        done.set()

    queue = Turns(work)
    queue.ask()
    while not told:
        pass
    queue.ask()
    assert done.wait(PATIENCE)
    queue.close()
    assert str(told[0].exc_value) == "not today"


def test_closing_ends_the_turn_and_the_thread(desk: Desk):
    desk.queue.ask()
    turn = desk.wait()
    threading.Timer(0.05, desk.go_on.release).start()
    desk.queue.close()
    assert turn.is_late
    assert desk.queue._thread is not None
    assert not desk.queue._thread.is_alive()
    desk.queue.ask()
    assert not desk.begun.acquire(timeout=0.05)
    desk.queue.close()


def test_python_ends_while_a_picture_is_rendered():
    script = """
import octomarch as om, threading
from octomarch.viewer.turns import Turns
begun = threading.Event()
def work(turn):
    begun.set()
    om.render(om.sphere(1.0), size=(16000, 16000), progress=turn.progress())
turns = Turns(work)
turns.ask()
begun.wait()
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
