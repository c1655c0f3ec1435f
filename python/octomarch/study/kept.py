"""What a study has measured so far, in a file beside it: an interrupted study goes on where it was.

`measure` comes before it. The file is rewritten whole after each setting, so that it is sound whenever the run ends.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import octomarch._document as documents
from octomarch import _core
from octomarch import _validate as check
from octomarch._files import atomic
from octomarch.study.rows import Measures
from octomarch.study.settings import Setting

_VERSION = 1


def fingerprint(value: Any) -> str:
    """Return a short text that tells scenes, cameras and settings from others.

    Examples
    --------
    >>> import octomarch as om
    >>> fingerprint(om.Scene(om.sphere(1.0))) == fingerprint(om.Scene(om.sphere(2.0)))
    False
    """
    return hashlib.sha256(json.dumps(documents.document(value)).encode()).hexdigest()[:16]


class Kept:
    """Measures by the key of their setting, and the file that holds them.

    Parameters
    ----------
    path : path-like, optional
        None: memory alone.
    subject : dict
        What all of it is about, as plain data: a file about something else is refused.

    Raises
    ------
    ValueError
        Naming the file, if it is no file of a study, or one of another study.
    OSError
        If the file cannot be read.
    """

    def __init__(self, path: str | os.PathLike[str] | None, subject: dict[str, Any]) -> None:
        self._path = None if path is None else Path(check.path("resume", path))
        self._subject = {**subject, "octomarch": _core.build_info()["version"]}
        self._measures: dict[str, Measures] = {}
        if self._path is None:
            return
        if self._path.exists():
            self._read(self._path)
        elif not self._path.parent.is_dir():  # asked here too, before there is anything to lose
            raise FileNotFoundError(f"cannot write {self._path}: there is no directory {self._path.parent}")

    def get(self, setting: Setting) -> Measures | None:
        """Return what is known of a setting."""
        return self._measures.get(setting.key)

    def add(self, setting: Setting, measures: Measures) -> None:
        """Keep what was measured, in the file too."""
        self._measures[setting.key] = measures
        if self._path is not None:
            rows = {key: _as_json(measures) for key, measures in self._measures.items()}
            text = json.dumps({"study": _VERSION, "subject": self._subject, "rows": rows}, indent=1, allow_nan=False)
            with atomic(self._path) as temporary:
                temporary.write_text(text + "\n", encoding="utf-8")

    def _read(self, path: Path) -> None:
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if content["study"] != _VERSION:
                raise ValueError(f"version {content['study']!r}, not {_VERSION}")
            subject, rows = dict(content["subject"]), dict(content["rows"])
            self._measures = {key: _measures(row) for key, row in rows.items()}
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(f"{path}: not what a study has kept: {error}") from None
        for name, value in self._subject.items():
            if subject.get(name) != json.loads(json.dumps(value)):
                raise ValueError(
                    f"{path}: kept by another study, {name} was {subject.get(name)!r} and is {value!r}: "
                    "give resume another name, or remove the file"
                )


def _as_json(measures: Measures) -> dict[str, Any]:
    """Return numbers as JSON has them, which knows no infinity."""
    return {name: "inf" if value == math.inf else value for name, value in asdict(measures).items()}


def _measures(row: dict[str, Any]) -> Measures:
    values: dict[str, Any] = {field.name: row[field.name] for field in fields(Measures)}
    for name, value in values.items():
        if value is not None and value != "inf" and not isinstance(value, (int, float)):
            raise ValueError(f"{name} must be a number, got {value!r}")
        values[name] = math.inf if value == "inf" else value
    return Measures(**values)
