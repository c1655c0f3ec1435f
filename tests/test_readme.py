"""The README: its code makes its picture, its commands run, its links lead somewhere."""

import re
import shlex
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from octomarch.cli import main

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
CODE = re.findall(r"^```python\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)
NOTICED = 4
"""Levels of 255 by which a picture may differ in most of its pixels before another should be shown."""
COMMANDS = [line.strip() for line in re.findall(r"^ +octomarch .*", TEXT, re.MULTILINE)]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_code_makes_the_picture(folder: Path):
    (code,) = CODE
    assert len([line for line in code.splitlines() if line]) <= 8
    exec(compile(code, "README.md", "exec"), {})
    with PIL.Image.open(folder / "readme.png") as made, PIL.Image.open(ROOT / "docs/images/readme.png") as shown:
        levels = np.abs(np.asarray(made, int) - np.asarray(shown, int))
    assert np.mean(levels > NOTICED) < 1e-3, "copy readme.png to docs/images"


@pytest.mark.usefixtures("folder")
def test_commands_run():
    exec(compile(CODE[0].replace("samples=16", "samples=1"), "README.md", "exec"), {})
    assert len(COMMANDS) == 3
    for command in COMMANDS:
        program, *arguments = shlex.split(command)
        assert (program, main(arguments)) == ("octomarch", 0)


def test_extras_are_those_that_there_are():
    named = set(re.findall(r"^\| `(\w+)` \| ", TEXT, re.MULTILINE))
    pyproject = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    section = pyproject.split("[project.optional-dependencies]")[1].split("\n[")[0]
    assert named == set(re.findall(r"^(\w+) = \[", section, re.MULTILINE)) - {"test", "dev", "docs"}


@pytest.mark.parametrize("link", sorted(set(re.findall(r"\]\(([^)#]+)\)", TEXT))))
def test_links_lead_somewhere(link: str):
    assert (ROOT / link).exists()
