"""Types as users see them: mypy accepts a correct script, and finds the mistakes of a wrong one."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")

SCRIPTS = Path(__file__).parent / "typing"


def mypy(path: Path, cache: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--cache-dir", str(cache), str(path)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=cache)


def test_strict_mypy_accepts_a_users_script(tmp_path: Path):
    done = mypy(SCRIPTS / "user_script.py", tmp_path)
    assert done.returncode == 0, done.stdout


def test_mypy_finds_each_mistake(tmp_path: Path):
    script = SCRIPTS / "wrong_script.py"
    found = {int(line) for line in re.findall(r"wrong_script\.py:(\d+): error", mypy(script, tmp_path).stdout)}
    lines = script.read_text().splitlines()
    assert found == {number for number, line in enumerate(lines, 1) if line.endswith("# wrong")}


def test_stub_names_what_the_native_module_has(tmp_path: Path):
    command = [sys.executable, "-m", "mypy.stubtest", "octomarch._core"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
