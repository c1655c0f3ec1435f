"""Every argument of everything public is given all sorts of nonsense: what is refused is told by its name and value.

Numbers out of range, arrays of wrong shapes and the like have tests beside what takes them; here nothing may come
through as an error of numpy, of Python, or of a line deep inside.
"""

import inspect
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import octomarch as om
from calls import calls


class Thing:
    def __repr__(self) -> str:
        return "<a thing>"


HOSTILE: dict[str, Any] = {
    "a thing": Thing(),
    "text": "nonsense",
    "NaN": float("nan"),
    "infinity": float("inf"),
    "negative": -7,
    "a truth value": True,
    "None": None,
    "an empty list": [],
    "an empty array": np.zeros(0),
    "no points": np.zeros((0, 3)),
    "complex": 1j,
    "two numbers": (1, 2),
    "four numbers": (1, 2, 3, 4),
    "words": ["a", "b", "c"],
    "NaNs": (float("nan"),) * 3,
    "a matrix": np.zeros((2, 2)),
    "a cube": np.zeros((2, 3, 4)),
    "a dictionary": {"a": 1},
    "a set": {1, 2},
    "a huge number": 10**400,
    "bytes": b"x",
    "objects": np.array([Thing()] * 3),
    "truth values": (True, False, True),
    "ragged": [[1, 2], [3]],
    "a path": Path("/nowhere/x.abc"),
}
SHOWN = {
    "a thing": "<a thing>",
    "text": "nonsense",
    "NaN": "nan",
    "infinity": "inf",
    "negative": "-7",
    "a truth value": "True",
    "None": "[Nn]one",
    "complex": "1j",
    "a path": "/nowhere",
}
"""What has to stand in the message."""
ONE_BY_ONE = {"corners", "holes", "stops", "lights", "planes", "groups", "scenes", "cameras", "bounds"}
"""Arguments whose items are told alone."""


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return calls(tmp_path_factory.mktemp("calls"))


NAMES = sorted(calls(Path("/tmp")))


def test_everything_public_is_called():
    given = {name for name in om.__all__ if callable(getattr(om, name)) and not isinstance(getattr(om, name), Warning)}
    made = {"Expression", "Hits", "Measured", "Pick", "Program", "Shape", "Study", "StudyRow", "StudyTable", "Status"}
    errors = {"CancelledError", "FramesError", "RenderWarning", "SceneError"}
    of_any_number = {"union", "intersection", "difference", "metaballs", "length", "minimum", "maximum"}
    without = {"build_info", "coordinates", "isas", "normals"}
    extras = {"from_mesh", "from_path", "text", "view", "Viewer", "write_movie"} - set(NAMES)
    assert given - made - errors - of_any_number - without - extras == {name for name in NAMES if "." not in name}


@pytest.mark.parametrize("name", NAMES)
def test_nonsense_is_told_by_name_and_value(
    name: str, table: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)  # some nonsense is a path
    refuse_nonsense(*table[name])


def refuse_nonsense(function: Callable[..., Any], arguments: dict[str, Any]) -> None:
    """Call a function with nonsense for each of some arguments that it takes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", om.RenderWarning)
        function(**arguments)
        for argument in arguments:
            for label, value in HOSTILE.items():
                try:
                    function(**{**arguments, argument: value})
                except (TypeError, ValueError, OSError, om.SceneError) as error:
                    message = str(error)
                    assert "\n" not in message
                    if isinstance(error, OSError):
                        assert str(value) in message, (argument, label)
                        continue
                    assert re.search(rf"\b{argument}\b", message), (argument, label, message)
                    if label in SHOWN and argument not in ONE_BY_ONE:
                        assert SHOWN[label] in message or re.search(SHOWN[label], message), (argument, label, message)


@pytest.mark.parametrize("name", NAMES)
def test_misspelt_arguments_are_suggested(name: str, table: dict[str, Any]):
    function, arguments = table[name]
    for argument in arguments:
        if len(argument) < 3:
            continue
        wrong = argument[:-2] + argument[-1] + argument[-2]
        if wrong == argument:
            wrong = argument + "s"
        renamed = {(wrong if key == argument else key): value for key, value in arguments.items()}
        with pytest.raises(TypeError, match=f"'{wrong}'; did you mean '{argument}'"):
            function(**renamed)


def test_calls_name_all_arguments(table: dict[str, Any]):
    for name, (function, arguments) in table.items():
        parameters = inspect.signature(function).parameters
        lacking = {each for each, parameter in parameters.items() if parameter.kind != parameter.VAR_KEYWORD}
        alternatives = {"direction", "changes", "stats", "metadata", "progress", "sharpness"}
        assert lacking - set(arguments) <= alternatives, name
