"""`Jobs`: tasks in processes of this machine, one of which may die without harm to the others.

``concurrent.futures.ProcessPoolExecutor`` is broken for good when a process of it dies, and waits for what has begun
when the user wants to end.
"""

from __future__ import annotations

import multiprocessing
import pickle
import queue
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Any, Self

from octomarch import _validate as check

_CONTEXT = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang


class WorkerDiedError(RuntimeError):
    """A process ended in the midst of its task."""


class Jobs:
    """An executor of `count` processes, for ``executor=`` of `octomarch.render_frames` and others.

    Ends all of them at the end of its ``with`` block, whatever they do. A process that dies fails its task, and is
    replaced.

    Examples
    --------
    >>> with Jobs(1) as jobs:
    ...     jobs.submit(abs, -3).result()
    3
    """

    def __init__(self, count: int) -> None:
        self._idle: queue.SimpleQueue[_Worker] = queue.SimpleQueue()
        self._workers = [_Worker() for _ in range(check.integer("count", count, 1, 4096))]
        for worker in self._workers:
            self._idle.put(worker)
        self._threads = ThreadPoolExecutor(count, "octomarch-jobs")

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a process call ``function(*args, **kwargs)``, as soon as one is free."""
        return self._threads.submit(self._call, function, args, kwargs)

    def _call(self, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        worker = self._idle.get()
        try:
            return worker.call(function, args, kwargs)
        finally:
            self._idle.put(worker)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for worker in self._workers:
            worker.end()
        self._threads.shutdown(cancel_futures=True)


@dataclass
class _Process:
    process: BaseProcess
    link: Connection


class _Worker:
    """A process for one call after the other, begun when there is one."""

    def __init__(self) -> None:
        self._running: _Process | None = None
        self._ended = False
        self._lock = threading.Lock()  # of both: a process must not begin after the end

    def call(self, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        running = self._begun()
        try:
            running.link.send((function, args, kwargs))
            value, error = running.link.recv()
        except (EOFError, OSError):
            self._running = None
            running.process.join()
            running.link.close()
            raise WorkerDiedError(f"a process ended with exit code {running.process.exitcode}") from None
        if error is not None:
            raise error
        return value

    def end(self) -> None:
        with self._lock:
            self._ended = True
            if self._running is not None:
                self._running.process.kill()  # files are written whole or not at all

    def _begun(self) -> _Process:
        with self._lock:
            if self._ended:
                raise WorkerDiedError("the processes were ended")
            if self._running is None:
                here, there = _CONTEXT.Pipe()
                process = _CONTEXT.Process(target=_serve, args=(there,), daemon=True)
                process.start()
                there.close()
                self._running = _Process(process, here)
            return self._running


def _serve(link: Connection) -> None:
    """Do calls until nobody is there to ask for them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who asks decides about Ctrl-C, and ends this process
    while True:
        try:
            function, args, kwargs = link.recv()
        except (EOFError, OSError):
            return
        answer: tuple[Any, Exception | None]
        try:
            answer = function(*args, **kwargs), None
        except Exception as error:
            answer = None, error
        try:
            data = pickle.dumps(answer)
        except Exception as error:
            told = answer[1] or error
            data = pickle.dumps((None, RuntimeError(f"{type(told).__name__}: {told}")))
        link.send_bytes(data)
