"""`Turns`: work on a thread of its own, of which only the newest matters. `engine` renders on it.

Whoever asks does not wait. Asking during a turn ends what that turn may leave out, and brings about one more turn,
however often was asked meanwhile.
"""

from __future__ import annotations

import atexit
import sys
import threading
import weakref
from collections.abc import Callable

from octomarch.progress import CancelledError, Progress

_PATIENCE = 2.0  # seconds to wait at the end for a turn that has been told to end


class Turn:
    """One turn, as the work sees it: whether somebody has asked anew.

    Examples
    --------
    >>> turn = Turn()
    >>> turn.is_late
    False
    """

    def __init__(self) -> None:
        self._late = threading.Event()
        self._progress: Progress | None = None

    @property
    def is_late(self) -> bool:
        """Whether there is newer work."""
        return self._late.is_set()

    def pause(self, seconds: float = 0.0) -> None:
        """Wait, and raise `CancelledError` as soon as there is newer work."""
        if self._late.wait(seconds):
            raise CancelledError("there is newer work")

    def progress(self) -> Progress:
        """Return what to hand to work that ends as soon as there is newer work."""
        self._progress = Progress()
        if self.is_late:  # asked after the last line, so that `end` cannot have missed it
            self._progress.cancel()
        return self._progress

    def end(self) -> None:
        """Tell the work that there is newer work."""
        self._late.set()
        if (progress := self._progress) is not None:
            progress.cancel()


class Turns:
    """Calls ``work(turn)`` on a thread of its own as often as it is asked to, but never twice for the same news.

    The thread begins when first asked. What the work raises ends the turn; `CancelledError` does so silently.

    Examples
    --------
    >>> done = threading.Event()
    >>> turns = Turns(lambda turn: done.set())
    >>> turns.ask()
    >>> done.wait(5)
    True
    >>> turns.close()
    """

    def __init__(self, work: Callable[[Turn], None]) -> None:
        self._work = work
        self._condition = threading.Condition()
        self._waiting: Turn | None = None
        self._running: Turn | None = None
        self._thread: threading.Thread | None = None
        self._closed = False

    def ask(self) -> None:
        """Have the work done, soon, and return at once."""
        with self._condition:
            if self._closed:
                return
            if self._waiting is None:
                self._waiting = Turn()
            if self._running is not None:
                self._running.end()
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="octomarch-viewer", daemon=True)
                self._thread.start()
                _close_at_exit(self)
            self._condition.notify()

    def close(self) -> None:
        """End the turn under way, and the thread."""
        with self._condition:
            self._closed, self._waiting = True, None
            if self._running is not None:
                self._running.end()
            self._condition.notify()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(_PATIENCE)

    def _run(self) -> None:
        while True:
            with self._condition:
                self._running = None
                self._condition.wait_for(lambda: self._closed or self._waiting is not None)
                if self._closed:
                    return
                turn, self._waiting = self._waiting, None
                self._running = turn
            assert turn is not None
            try:
                self._work(turn)
            except CancelledError:
                pass
            except Exception:  # told as that of any thread, but this one goes on
                threading.excepthook(threading.ExceptHookArgs((*sys.exc_info(), threading.current_thread())))


def _close_at_exit(turns: Turns) -> None:
    """End the thread before Python ends, which would end it in the midst of native code."""
    reference = weakref.ref(turns)

    def close() -> None:
        if (alive := reference()) is not None:
            alive.close()

    atexit.register(close)
