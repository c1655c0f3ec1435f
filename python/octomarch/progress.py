"""How far long work has come, told while it goes on, and how it is ended from elsewhere.

`render`, `frames` and `bands` call what `reporting` gives them every 20 ms, on the thread that called them. What such a
call raises ends the work at once: that is how `Progress.cancel` and Ctrl-C do it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeAlias

from octomarch import _validate as check

Callback: TypeAlias = Callable[[int, int], None]
"""Called with (done, all)."""

_outer: ContextVar[Callable[[], None] | None] = ContextVar("outer", default=None)
_LARGEST_PLAIN = 10_000  # of numbers that bars show as they are: above that 12.3k


class CancelledError(Exception):
    """Work was ended by `Progress.cancel`.

    Examples
    --------
    >>> import octomarch as om
    >>> work = om.Progress()
    >>> work.cancel()
    >>> om.render(om.sphere(1.0), progress=work)
    Traceback (most recent call last):
    octomarch.progress.CancelledError: cancelled before it began
    """


class Progress:
    """Follows one piece of work, and ends it from any other thread.

    To be handed over as ``progress=`` of whatever takes that, a new one each time.

    Parameters
    ----------
    callback : callable, optional
        Called with (done, all) from time to time, on the thread that does the work.

    Raises
    ------
    TypeError
        If `callback` is neither callable nor None.

    Examples
    --------
    >>> import octomarch as om, threading
    >>> work = om.Progress()
    >>> timer = threading.Timer(0.05, work.cancel)  # or the button of a window
    >>> timer.start()
    >>> om.render(om.sphere(1.0), size=(16000, 16000), progress=work)
    Traceback (most recent call last):
    octomarch.progress.CancelledError: cancelled at ...%
    >>> 0 <= work.fraction < 1
    True
    """

    done: int
    """How much is done."""
    total: int
    """How much there is to do, in the same unit; 0 until it is known."""

    def __init__(self, callback: Callback | None = None) -> None:
        if callback is not None and not callable(callback):
            raise TypeError(f"callback must be callable or None, got {check.shown(callback)}")
        self.done, self.total = 0, 0
        self._callback = callback
        self._cancelled = threading.Event()

    @property
    def fraction(self) -> float:
        """What part is done, in [0, 1].

        Examples
        --------
        >>> import octomarch as om
        >>> work = om.Progress()
        >>> image = om.render(om.sphere(1.0), progress=work)
        >>> work.fraction
        1.0
        """
        return self.done / self.total if self.total else 0.0

    @property
    def cancelled(self) -> bool:
        """Whether `cancel` was called."""
        return self._cancelled.is_set()

    def cancel(self) -> None:
        """End the work within a tenth of a second: it raises `CancelledError` where it was called.

        May be called from any thread, more than once, and before the work begins.

        Examples
        --------
        >>> import octomarch as om
        >>> work = om.Progress()
        >>> work.cancel()
        >>> work.cancelled
        True
        """
        self._cancelled.set()

    def __call__(self, done: int, total: int) -> None:
        """Note how far the work has come; it calls this itself."""
        if self.cancelled:
            raise CancelledError(f"cancelled at {self.fraction:.0%}" if self.total else "cancelled before it began")
        self.done, self.total = done, total
        if self._callback is not None:
            self._callback(done, total)


@contextmanager
def reporting(
    progress: bool | Callback | None, title: str, unit: str, size: int | None = None, tasks: str = ""
) -> Iterator[Callback | None]:
    """Give what work is to call with (done, all) for a user's ``progress=``; None where nobody listens.

    A bar counts in `unit`, of which there are `size` in all; None: as many as the work says, which it may call `tasks`
    beside the bar. Work that is part of other
    work and is given no listener of its own asks that of the whole whether to go on.
    """
    if progress is None or progress is False:
        outer = _outer.get()
        yield None if outer is None else lambda *_: outer()
    elif progress is True:
        import tqdm.auto  # here, since most work shows no bar; this one is for terminals and notebooks

        scaled = size is not None and size > _LARGEST_PLAIN
        with tqdm.auto.tqdm(desc=title, unit=unit, unit_scale=scaled, leave=False, total=size) as bar:

            def report(done: int, total: int) -> None:
                if size is None:
                    bar.total = total
                if tasks:
                    bar.set_postfix_str(f"{done} of {total} {tasks}", refresh=False)
                bar.update((done if size is None else done * size // total) - bar.n)

            yield report
    elif callable(progress):
        with _asked(progress) as telling:
            yield telling
    else:
        raise TypeError(f"progress must be True, a callable or None, got {check.shown(progress)}")


def ask() -> None:
    """Ask the listener of the work that this is part of, if there is one: what it raises ends the work.

    Examples
    --------
    >>> ask()
    """
    outer = _outer.get()
    if outer is not None:
        outer()


@contextmanager
def _asked(progress: Callback) -> Iterator[Callback]:
    """Have parts of the work ask a listener by telling it again what it was told last."""
    last = (0, 0)
    is_told = False  # a listener may well render something itself

    def report(done: int, total: int) -> None:
        nonlocal last, is_told
        last, is_told = (done, total), True
        progress(done, total)
        is_told = False

    def again() -> None:
        if last[1] and not is_told:
            report(*last)

    token = _outer.set(again)
    try:
        yield report
    finally:
        _outer.reset(token)
