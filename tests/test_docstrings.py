"""Every public name says what it is, and every example in a docstring runs and gives what it shows."""

import doctest
import importlib
import inspect
import pkgutil
from pathlib import Path

import pytest

import octomarch as om

MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(om.__path__, "octomarch.")
    if module.name not in ("octomarch._core", "octomarch.__main__")
)
NEEDED = {
    "octomarch.meshes": "igl",
    "octomarch.movies": "imageio",
    "octomarch.outlines": "matplotlib",
    "octomarch.viewer.widget": "anywidget",
}
"""Modules of extras that examples need."""
PUBLIC = [name for name in om.__all__ if callable(getattr(om, name)) and name != "SceneError"]


@pytest.mark.parametrize("name", ["octomarch", *MODULES])
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    if name in NEEDED:
        pytest.importorskip(NEEDED[name])
    monkeypatch.chdir(tmp_path)
    result = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert result.failed == 0


@pytest.mark.parametrize("name", PUBLIC)
def test_public_names_have_an_example(name: str):
    documentation = inspect.getdoc(getattr(om, name)) or ""
    assert ">>>" in documentation


@pytest.mark.parametrize("name", PUBLIC)
def test_public_members_are_documented(name: str):
    thing = getattr(om, name)
    if inspect.isclass(thing):
        members = {
            key: value
            for part in inspect.getmro(thing)[:-1]
            for key, value in vars(part).items()
            if not key.startswith("_") and (inspect.isfunction(value) or isinstance(value, property))
        }
        assert [key for key, value in members.items() if not inspect.getdoc(value)] == []


def test_modules_say_what_they_do():
    for name in MODULES:
        assert importlib.import_module(name).__doc__
