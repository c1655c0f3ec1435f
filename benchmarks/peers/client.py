"""The other end of worker.py: starts a contender's process, asks it with a time limit, and says why one is no more."""

import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from peers.registry import Contender

BENCHMARKS = Path(__file__).resolve().parents[1]
# One thread each, in the words of every library that has a pool of its own. The processor is pinned besides.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "NPROC"), "1"
)


class GoneError(Exception):
    """A contender cannot go on: the text says why."""


class Client:
    """A running contender. Its home is a new folder, so that no kernel compiled on another day is found again."""

    def __init__(self, contender: Contender, python: Path, cpu: int, patience: float) -> None:
        self.patience = patience
        self.home = tempfile.mkdtemp(prefix="octomarch-peer-")
        self.picture = Path(self.home) / "picture.npy"
        self._log = (Path(self.home) / "log").open("w+", encoding="utf-8", errors="replace")
        self._process = subprocess.Popen(
            [str(python), "-m", "peers.worker", json.dumps(contender.specification()), str(cpu)],
            cwd=BENCHMARKS,
            env=os.environ
            | ONE_THREAD
            | {"HOME": self.home, "XDG_CACHE_HOME": self.home, "PYTHONDONTWRITEBYTECODE": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
        )
        self.greeting = self._answer()

    def ask(self, do: str, **arguments: Any) -> dict[str, Any]:
        """Raise GoneError if the contender fails, ends or does not answer in time; it is stopped then."""
        assert self._process.stdin
        try:
            self._process.stdin.write(json.dumps({"do": do, **arguments}) + "\n")
            self._process.stdin.flush()
        except OSError:
            raise GoneError(self._last_words()) from None
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout
        ready, _, _ = select.select([self._process.stdout], [], [], self.patience)
        if not ready:
            self.close()
            raise GoneError(f"no answer within {self.patience:.0f} s")
        line = self._process.stdout.readline()
        if not line:
            raise GoneError(self._last_words())
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            self.close()
            raise GoneError(answer["error"])
        return answer

    def _last_words(self) -> str:
        code = self._process.wait()
        self._log.flush()
        self._log.seek(0)
        lines = [line.strip() for line in self._log if line.strip()]
        self.close()
        return f"the process ended with {code}: {lines[-1][:300] if lines else 'it said nothing'}"

    def close(self) -> None:
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        for stream in (self._process.stdin, self._process.stdout, self._log):
            if stream and not stream.closed:
                try:
                    stream.close()
                except OSError:
                    print(f"a pipe of process {self._process.pid} was closed already", file=sys.stderr)
        shutil.rmtree(self.home, ignore_errors=True)
