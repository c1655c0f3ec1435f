"""The notebooks of docs/notebooks: they run in a real kernel, warn of nothing, and are kept without results.

`make docs` runs them too, and shows what they print and draw.
"""

import re
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

DOCS = Path(__file__).parents[1] / "docs"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))

every_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def read(path: Path) -> Any:
    """Return a notebook."""
    return nbformat.read(path, as_version=4)


def prose(path: Path) -> list[str]:
    """Return the texts between the code."""
    return [cell.source for cell in read(path).cells if cell.cell_type == "markdown"]


def complaints(notebook: Any) -> list[str]:
    """Return what the cells wrote as errors; warnings are there too."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [output.text for output in outputs if output.get("name") == "stderr"]


@every_notebook
def test_notebook_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    (tmp_path / "work").mkdir()
    notebook = read(path)
    resources = {"metadata": {"path": str(tmp_path / "work")}}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources=resources).execute()
    assert complaints(notebook) == []
    assert list((tmp_path / "work").iterdir()) == [], "a notebook leaves no files where it is run"


@every_notebook
def test_notebook_is_kept_without_results(path: Path):
    notebook = read(path)
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    for cell in notebook.cells:
        assert cell.get("outputs", []) == []
        assert cell.get("execution_count") is None
        assert cell.metadata == {}


@every_notebook
def test_notebook_has_a_title_and_says_what_next(path: Path):
    texts = prose(path)
    assert texts[0].startswith("# ")
    assert [line for text in texts for line in text.splitlines() if line.startswith("## ")][-1] == "## What next"


@every_notebook
def test_links_of_notebook_lead_somewhere(path: Path):
    targets = re.findall(r"\]\((?!https?:)([^)#]+)", "\n".join(prose(path)))
    assert targets
    missing = [target for target in targets if not (path.parent / target).is_file()]
    assert not missing


def test_all_notebooks_are_on_the_site():
    index = (DOCS / "index.md").read_text()
    assert [path.stem for path in NOTEBOOKS if f"\nnotebooks/{path.stem}\n" not in index] == []
