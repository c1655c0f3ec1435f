"""The peers' virtual environment: made once, from PyPI, package by package."""

import subprocess
import sys
import venv
from pathlib import Path

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
_INSTALLED = "import importlib.metadata as m; print(*(d.metadata['Name'].lower() for d in m.distributions()))"


def requirements() -> dict[str, str]:
    """Return requirements by the name of the package."""
    lines = [line.strip() for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines()]
    return {line.partition(">=")[0]: line for line in lines if line and not line.startswith("#")}


def python_of(folder: Path) -> Path:
    return folder / "bin" / "python"


def make(folder: Path) -> dict[str, str]:
    """Create what is missing, and return why a package is missing still, by its name."""
    python = python_of(folder)
    if not python.exists():
        venv.create(folder, with_pip=True)
    present = subprocess.run([python, "-c", _INSTALLED], capture_output=True, text=True, check=True).stdout.split()
    failures = {}
    for name, requirement in requirements().items():
        if name in present:
            continue
        print(f"installing {requirement}", file=sys.stderr)
        command = [str(python), "-m", "pip", "--disable-pip-version-check", "install", "--quiet", requirement]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            lines = [line for line in done.stderr.splitlines() if line.startswith("ERROR")] or ["pip gave no reason"]
            failures[name] = f"not installed: {lines[-1].removeprefix('ERROR: ')[:300]}"
    return failures
