"""What SCENE on the command line is: a demo, a file, or a name in a Python file."""

from __future__ import annotations

import dataclasses
import re
import runpy
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from octomarch import _validate as check
from octomarch._spelling import nearest
from octomarch.camera import AnyCamera
from octomarch.cli.parser import ScriptError
from octomarch.demo import DEMOS
from octomarch.scene import Scene
from octomarch.scenefile import read
from octomarch.shapes import Shape
from octomarch.shot import Shot

NAMES = ("shot", "scene", "shape")
"""Looked for in Python files."""

_SCRIPT = re.compile(r"(?P<path>.+\.py)(?::(?P<name>\w+))?")


@dataclass(frozen=True)
class Subject:
    """What was found, and where: ``place`` names it in messages, ``script`` is the Python file that defines it.

    ``camera`` is the one that the file has beside it.
    """

    place: str
    value: Any
    script: str | None = None
    camera: AnyCamera | None = None

    @property
    def is_function(self) -> bool:
        """Whether it has to be called first."""
        return callable(self.value) and not isinstance(self.value, type)

    def called(self, *arguments: Any) -> Subject:
        """Return what it gives, if it is a function, else itself; of generators all that they give."""
        with _blaming(self.script or self.place):
            value = self.value(*arguments) if self.is_function else self.value
            return dataclasses.replace(self, value=list(value) if isinstance(value, Iterator) else value)

    def request(self) -> dict[str, Any]:
        """Return what `octomarch.render` is to be called with for it.

        Examples
        --------
        >>> import octomarch as om
        >>> list(Subject("ball.py:make", lambda: om.sphere(1.0)).request())
        ['scene', 'camera']
        """
        value = self.called().value
        if isinstance(value, Shot):
            return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        if isinstance(value, (Shape, Scene)):
            return {"scene": value, "camera": self.camera}
        what = "a shape, a scene or a shot, or a function without arguments that returns one"
        raise ValueError(f"{self.place} must be {what}, got {check.shown(value)}")


def find(text: str, names: tuple[str, ...] = NAMES) -> Subject:
    """Return the demo of that name, what a file holds, or what a name in a Python file is.

    Examples
    --------
    >>> find("building").request()["size"]
    (960, 540)
    """
    if text in DEMOS:
        return Subject(text, DEMOS[text]())
    script = _SCRIPT.fullmatch(text)
    if script:
        return _in_script(script["path"], script["name"], names)
    if Path(text).suffix.lower() in (".json", ".exr", ".png"):
        return Subject(text, read(text))
    guess = nearest(text, DEMOS)
    raise ValueError(
        f"SCENE must be {', '.join(DEMOS)}, FILE.json, FILE.exr, FILE.png or FILE.py[:NAME], got {text!r}"
        + (f"; did you mean {guess!r}?" if guess else "")
    )


@contextmanager
def _blaming(path: str) -> Iterator[None]:
    """Tell what the code of a Python file raises by the file, the line and the exception."""
    try:
        yield
    except Exception as error:
        is_syntax = isinstance(error, SyntaxError) and error.filename == path
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == path]
        line = error.lineno if isinstance(error, SyntaxError) and is_syntax else lines[-1] if lines else None
        told = error.msg if isinstance(error, SyntaxError) else str(error)
        if isinstance(error, AttributeError) and error.name and (meant := nearest(error.name, dir(error.obj))):
            told += f"; did you mean {meant!r}?"
        place = path if line is None else f"{path}:{line}"
        raise ScriptError(f"{place}: {type(error).__name__}{f': {told}' if told else ''}") from error


def _in_script(path: str, name: str | None, names: tuple[str, ...]) -> Subject:
    """Run a Python file, and find one of its names."""
    if not Path(path).is_file():
        raise FileNotFoundError(f"there is no file {path}")
    defined = _run(path)
    camera = defined.get("camera")
    for each in [name] if name else names:
        if each in defined:
            there = camera if isinstance(camera, AnyCamera) else None
            return Subject(f"{path}:{each}", defined[each], path, there)
    raise ValueError(_nothing(path, name, names, defined))


def _run(path: str) -> dict[str, Any]:
    """Run a file as Python does, but that it is not the main program; return what it defines."""
    sys.path.insert(0, str(Path(path).resolve().parent))  # stays: functions may import something later
    arguments, sys.argv = sys.argv, [path]
    try:
        with _blaming(path):
            return runpy.run_path(path, run_name="octomarch_scene")
    finally:
        sys.argv = arguments


def _nothing(path: str, name: str | None, names: tuple[str, ...], defined: Mapping[str, Any]) -> str:
    """Tell that a file does not define what is asked for, and what it defines."""
    those = [each for each, value in defined.items() if isinstance(value, (Shape, Scene, Shot))]
    guess = nearest(name, [*those, *defined]) if name else None
    hint = f"; it has {', '.join(f'{path}:{each}' for each in those)}" if those else ""
    hint = f"; did you mean {path}:{guess}?" if guess else hint
    return f"{path} defines nothing named {name or ' or '.join(names)}{hint}"
