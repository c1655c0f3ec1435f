"""The pages of the API reference, written from the table `docs/reference.toml` before Sphinx looks for pages.

Each topic becomes `docs/reference/PAGE.rst`: a summary of its names, then the docstring of each. `tests/test_docs.py`
holds the table against what octomarch exports.
"""

import enum
import inspect
import tomllib
from operator import attrgetter
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

import octomarch

HERE = Path(__file__).parents[1]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("config-inited", _write_pages)
    app.connect("autodoc-process-signature", _without_internals)
    return {"parallel_read_safe": True}


def _write_pages(*_: object) -> None:
    folder = HERE / "reference"
    folder.mkdir(exist_ok=True)
    topics = tomllib.loads((HERE / "reference.toml").read_text())["topics"]
    pages = {f"{topic['page']}.rst": _page(topic) for topic in topics}
    pages["index.rst"] = _index(topics)
    for path in folder.iterdir():
        if path.name not in pages:
            path.unlink()
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:  # an unchanged page need not be read again
            path.write_text(text)


def _index(topics: list[dict[str, Any]]) -> str:
    lines = [*_heading("Reference"), "Every public name, by topic; all are reached as ``om.NAME`` after", ""]
    lines += ["::", "", "   import octomarch as om", "", ".. toctree::", "   :hidden:", ""]
    lines += [f"   {topic['page']}" for topic in topics]
    for topic in topics:
        lines += ["", f":doc:`{topic['page']}`", f"   {topic['text']}", ""]
        lines += ["   " + ", ".join(f":py:obj:`~octomarch.{name}`" for name in topic["names"])]
    return "\n".join([*lines, ""])


def _page(topic: dict[str, Any]) -> str:
    lines = [*_heading(topic["title"]), topic["text"], "", ".. currentmodule:: octomarch", ""]
    lines += [".. autosummary::", "", *(f"   {name}" for name in topic["names"]), ""]
    for name in topic["names"]:
        lines += _entry(name)
    return "\n".join([*lines, ""])


def _heading(title: str) -> list[str]:
    return [title, "=" * len(title), ""]


def _entry(name: str) -> list[str]:
    """Return the directive that shows one docstring."""
    thing = attrgetter(name)(octomarch)
    if inspect.isclass(thing) and issubclass(thing, BaseException):
        return [f".. autoexception:: octomarch.{name}", ""]
    if inspect.isclass(thing) and issubclass(thing, enum.Enum):
        return [f".. autoclass:: octomarch.{name}()", "   :members:", ""]
    if inspect.isclass(thing):
        return [f".. autoclass:: octomarch.{name}", "   :members:", "   :inherited-members:", ""]
    if inspect.ismodule(thing):
        described = inspect.getdoc(thing) or ""
        return [f".. py:module:: octomarch.{name}", "", ".. currentmodule:: octomarch", "", described, ""]
    if callable(thing):
        return [f".. autofunction:: octomarch.{name}", ""]
    return [f".. autodata:: octomarch.{name}", ""]


def _without_internals(_app: Sphinx, kind: str, _name: str, thing: Any, *_: object) -> tuple[str, None] | None:
    """Leave out the arguments of classes that users do not construct: those whose docstring names none."""
    if kind == "class" and "Parameters\n" not in (inspect.getdoc(thing) or ""):
        return "", None
    return None
