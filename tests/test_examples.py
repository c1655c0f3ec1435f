"""Every script under examples/ runs, and writes what it saves into the folder it is run in."""

import runpy
from pathlib import Path

import PIL.Image
import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    for picture in tmp_path.glob("*.png"):
        with PIL.Image.open(picture) as image:
            assert len(image.getcolors(2**24)) > 2, f"{picture.name} is empty"
    assert capsys.readouterr().out or list(tmp_path.iterdir())
