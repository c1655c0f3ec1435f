"""The site's pages without Sphinx: the reference names all that is public, and the code of pages and gallery is sound.

`make docs` builds the site itself.
"""

import ast
import inspect
import re
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

import octomarch as om

ROOT = Path(__file__).parents[1]
GALLERY = sorted((ROOT / "examples" / "gallery").glob("[0-9]*.py"))
PAGES = sorted([ROOT / "docs" / "index.md", *(ROOT / "docs" / "guide").glob("*.md")])
LINES_AT_MOST = 40
NEEDED = {"frames": "imageio", "notebooks": "anywidget"}
"""Modules of extras that pages need."""


def listed() -> list[str]:
    """Return the names in the table of the reference."""
    topics = tomllib.loads((ROOT / "docs" / "reference.toml").read_text())["topics"]
    return [name for topic in topics for name in topic["names"]]


def public() -> set[str]:
    """Return the names that octomarch exports, and those of its public modules."""
    modules = {name: getattr(om, name) for name in om.__all__ if inspect.ismodule(getattr(om, name))}
    return {*om.__all__, *(f"{name}.{inner}" for name, module in modules.items() for inner in module.__all__)}


def test_reference_names_all_that_is_public():
    missing, unknown = public() - set(listed()), set(listed()) - public()
    assert not missing, f"public, but not in docs/reference.toml: {sorted(missing)}"
    assert not unknown, f"in docs/reference.toml, but not public: {sorted(unknown)}"


def test_reference_names_nothing_twice():
    assert [name for name, count in Counter(listed()).items() if count > 1] == []


def test_guide_speaks_of_all_that_is_public():
    text = "".join(page.read_text() for page in PAGES)
    methods = [name for name, _ in inspect.getmembers(om.Shape, callable) if not name.startswith("_")]
    absent = [
        name for name in sorted(public() - {"__version__"}) if not re.search(rf"\b(om|octomarch)\.{name}\b", text)
    ]
    absent += [f"Shape.{name}" for name in methods if not re.search(rf"\.{name}\(", text)]
    assert not absent, f"public, but nowhere in docs/guide: {absent}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_blocks_of_pages_run(page: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    if page.stem in NEEDED:
        pytest.importorskip(NEEDED[page.stem])
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "_extensions"))
    monkeypatch.chdir(tmp_path)
    import blocks

    render = om.render

    def small(scene: Any, camera: Any = None, size: tuple[int, int] = (640, 480), **options: Any) -> om.Image:
        """Render a sixteenth of the pixels: that the code runs is what counts here."""
        reduced = size if options.get("crop") else (max(size[0] // 4, 1), max(size[1] // 4, 1))
        return render(scene, camera, reduced, **options)

    monkeypatch.setattr(om, "render", small)
    assert blocks.run_page(page) > 0


@pytest.mark.parametrize("script", GALLERY, ids=lambda script: script.stem)
def test_gallery_script_keeps_the_convention(script: Path):
    """What examples/gallery/README.rst asks for."""
    text = script.read_text()
    title, underline, blank, *description = (ast.get_docstring(ast.parse(text)) or "\n\n\n").splitlines()
    assert len(underline) == len(title), "the title is underlined with = in its full length"
    assert set(underline) == {"="}
    assert not blank
    assert description
    assert text.count("\n") <= LINES_AT_MOST
    assert "import octomarch as om\n" in text
    assert text.rstrip().splitlines()[-1].startswith("image.save(sys.argv[1] if sys.argv[1:] else ")
