"""Runs many tasks of one kind, here or by an executor, and again those that fail. `frames` and `bands` build on it."""

from __future__ import annotations

import inspect
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar, cast

from octomarch import _validate as check
from octomarch.progress import Callback

Item = TypeVar("Item")

_POLL = 0.02  # seconds: as often as native work listens


class Future(Protocol):
    """What `Executor.submit` returns: that much of ``concurrent.futures.Future``."""

    def done(self) -> bool:
        """Tell whether there is a result or an exception."""

    def result(self) -> Any:
        """Return the result or raise the exception."""

    def cancel(self) -> Any:
        """Keep the call from beginning, where it has not begun."""


class Executor(Protocol):
    """What runs calls elsewhere: of ``concurrent.futures``, Dask, MPI or anyone, as far as it has `submit`."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future:
        """Have a call done, some time."""


Task = Callable[[Item, Callback | None], Any]
Keep = Callable[[int, Any], None]


def run(
    task: Task[Item],
    items: Sequence[Item],
    executor: Executor | None,
    retries: int,
    report: Callback | None,
    keep: Keep = lambda *_: None,
) -> dict[int, Exception]:
    """Call ``task(item, callback)`` for each item, up to ``1 + retries`` times; return the last error of those failed.

    Results go to ``keep(place, result)``, here, as soon as they are known; what that raises ends all.

    With an executor the calls get no callback, and `report` is called from here, every 20 ms, with (tasks done, tasks).
    Without one it is what the calls get, and may be called as often as they call it. What `report` raises, and
    KeyboardInterrupt, ends all that has not begun.

    Examples
    --------
    >>> def task(item, callback):
    ...     if item == 0:
    ...         raise ValueError("nothing to do")
    >>> run(task, [1, 0, 2], None, 3, None)
    {1: ValueError('nothing to do')}
    """
    if executor is None:
        return _run_here(task, items, retries, report, keep)
    return _run_there(task, items, executor, retries, report, keep)


def executor_or_none(name: str, value: object) -> Executor | None:
    """Return `value` if it is None or has a method ``submit``.

    Examples
    --------
    >>> executor_or_none("executor", 4)
    Traceback (most recent call last):
    TypeError: executor must have a method submit, as those of concurrent.futures do, or be None, got 4
    """
    if value is not None and (inspect.isclass(value) or not callable(getattr(value, "submit", None))):
        kinds = "have a method submit, as those of concurrent.futures do, or be None"
        raise TypeError(f"{name} must {kinds}, got {check.shown(value)}")
    return cast("Executor | None", value)


def _run_here(
    task: Task[Item], items: Sequence[Item], retries: int, report: Callback | None, keep: Keep
) -> dict[int, Exception]:
    failures: dict[int, Exception] = {}
    stopped: list[BaseException] = []  # by what the listener raised

    def listen(*_: int) -> None:
        if report is not None:
            try:
                report(place, len(items))
            except BaseException as error:
                stopped.append(error)
                raise

    place = 0
    for place, item in enumerate(items):
        for left in reversed(range(1 + retries)):
            try:
                listen()
                result = task(item, listen)
            except Exception as error:
                if stopped:
                    raise
                if left == 0:
                    failures[place] = error
            else:
                keep(place, result)
                break
    place = len(items)
    listen()
    return failures


def _run_there(
    task: Task[Item], items: Sequence[Item], executor: Executor, retries: int, report: Callback | None, keep: Keep
) -> dict[int, Exception]:
    options = {"pure": False} if _is_dask(executor) else {}  # else a task that is tried again is the one that failed
    failures: dict[int, Exception] = {}
    attempts = [0] * len(items)
    waiting = deque(range(len(items)))
    running: dict[int, Future] = {}
    try:
        while waiting or running:
            while waiting:
                place = waiting.popleft()
                attempts[place] += 1
                try:
                    running[place] = executor.submit(task, items[place], None, **options)
                except Exception as error:  # it is shut down or broken; what it still has is waited for
                    failures.setdefault(place, error)
            if report is not None:
                report(len(items) - len(running), len(items))
            ended = [place for place, future in running.items() if future.done()]
            for place in ended:
                try:
                    result = running.pop(place).result()
                except Exception as error:
                    failures[place] = error
                    if attempts[place] <= retries:
                        waiting.append(place)
                else:
                    failures.pop(place, None)
                    keep(place, result)
            if not ended:
                time.sleep(_POLL)
    finally:
        for future in running.values():
            future.cancel()
    if report is not None:
        report(len(items), len(items))
    return failures


def _is_dask(executor: Executor) -> bool:
    return any(kind.__module__.partition(".")[0] == "distributed" for kind in type(executor).__mro__)
