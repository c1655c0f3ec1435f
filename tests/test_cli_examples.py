"""The examples in the help of commands run, and the page about them says what the help says."""

import importlib.util
import re
import shlex
from pathlib import Path

import pytest

import octomarch as om
from octomarch.cli import COMMANDS, main

ROOT = Path(__file__).parents[1]
SCRIPT = """
import octomarch as om

ball = om.sphere(1.0)


def make_scene():
    return om.Scene(ball - om.box(1.3), lights=[om.DirectionalLight((-1, -2, -1))])


def growing(t):
    return ball.union(om.box(1.2), smooth=0.01 + t)
"""
MOVIES = {".gif": "imageio", ".webp": "imageio", ".mp4": "imageio_ffmpeg"}
"""What examples need by the files that they write."""

spec = importlib.util.spec_from_file_location("command_line", ROOT / "tools" / "command_line.py")
assert spec is not None
assert spec.loader is not None
page = importlib.util.module_from_spec(spec)
spec.loader.exec_module(page)
EXAMPLES = [example for parser in page.commands().values() for example in parser.examples]


@pytest.mark.parametrize("example", EXAMPLES)
def test_example_runs(
    example: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    for suffix, module in MOVIES.items():
        if suffix in example:
            pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("webbrowser.open", lambda address: address.startswith("http://127.0.0.1:"))
    monkeypatch.setattr("octomarch.cli.view._follow", lambda *_: None)  # which ends with Ctrl-C only
    Path("scene.py").write_text(SCRIPT)
    scene = om.Scene(om.sphere(1.0) - om.box(1.3), lights=[om.DirectionalLight((-1, -2, -1))])
    om.Shot(scene, om.Camera((2, 2, 4), (0, 0, 0)), (64, 48)).save("shot.json")
    program, *arguments = shlex.split(example)
    assert program == "octomarch"
    assert main(arguments) == 0, capsys.readouterr().err
    named = [arguments[place + 1] for place, word in enumerate(arguments) if word in ("-o", "--keep")]
    for pattern in named:
        assert list(tmp_path.glob(re.sub(r"\{.*\}", "*", pattern))), pattern
    assert not list(tmp_path.glob(".*")), "work is left behind"


def test_every_command_has_examples():
    commands = page.commands()
    assert len(commands) == len(COMMANDS)
    assert [name for name, parser in commands.items() if not parser.examples] == []
    assert [text for name, parser in commands.items() for text in parser.examples if text.split()[1] != name] == []


def test_page_is_as_the_help():
    text = page.PAGE.read_text(encoding="utf-8")
    assert page.rewritten(text) == text, "run python tools/command_line.py"


@pytest.mark.parametrize("name", [*page.commands(), ""])
def test_help_ends_well(name: str, capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as ended:
        main([name, "--help"] if name else ["--help"])
    assert ended.value.code == 0
    output = capsys.readouterr().out
    assert all(len(line) <= 100 or line.startswith("  octomarch") for line in output.splitlines())
