"""Importing the package is quick: what only some users need is loaded when they need it."""

import subprocess
import sys


def loaded_by(statement: str) -> set[str]:
    script = f"import sys; {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_import_loads_no_library_but_numpy():
    modules = loaded_by("import octomarch")
    assert "numpy" in modules
    assert not modules & {"OpenEXR", "PIL", "tqdm", "anywidget", "matplotlib", "octomarch.cli", "octomarch.demo"}


def test_rendering_needs_no_library_but_numpy():
    modules = loaded_by("import octomarch as om; om.render(om.sphere(1.0), size=(8, 8)).to_srgb()")
    assert not modules & {"OpenEXR", "PIL", "tqdm", "matplotlib"}
