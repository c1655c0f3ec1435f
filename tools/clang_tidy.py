"""Run clang-tidy over the C++ sources of a build directory, and only over what changed since they last passed.

``clang_tidy.py BUILD_DIR`` reads BUILD_DIR/compile_commands.json. A source passes under a key: the hash of its compile
command, of .clang-tidy, and of the text of the source and of all project headers that it includes. Passed keys are
files in BUILD_DIR/clang-tidy, so that a second run over unchanged sources takes no time.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CHECKED = ("cpp", "tests/cpp", "benchmarks/cpp")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
# clang warns about options that only GCC knows, and about deprecated parts that GCC's own library uses.
QUIET = [
    "--quiet",
    "--extra-arg=-Wno-unknown-warning-option",
    "--extra-arg=-Wno-ignored-optimization-argument",
    "--extra-arg=-Wno-deprecated-declarations",
]


@cache
def includes(path: Path) -> frozenset[Path]:
    """Return the project files that a file includes with quotes, itself left out."""
    found = set()
    for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
        for folder in (path.parent, ROOT / "cpp"):
            if (folder / name).is_file():
                found.add((folder / name).resolve())
                break
    return frozenset(found)


def with_headers(source: Path) -> list[Path]:
    """Return a source and every project file it includes directly or through others, sorted."""
    reached = {source}
    waiting = [source]
    while waiting:
        new = includes(waiting.pop()) - reached
        reached |= new
        waiting += new
    return sorted(reached)


def key_of(entry: dict[str, str]) -> str:
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    digest.update(entry["command"].encode())
    for path in with_headers(Path(entry["file"])):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def check(entry: dict[str, str], build_dir: Path, passed: Path) -> str:
    """Return what clang-tidy has against one source, "" when it passes."""
    stamp = passed / key_of(entry)
    if stamp.exists():
        return ""
    command = ["clang-tidy", "-p", str(build_dir), *QUIET, entry["file"]]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        stamp.touch()
        return ""
    return done.stdout or done.stderr


def main(build_dir: Path) -> int:
    entries = json.loads((build_dir / "compile_commands.json").read_text())
    wanted = [entry for entry in entries if any(Path(entry["file"]).is_relative_to(ROOT / part) for part in CHECKED)]
    passed = build_dir / "clang-tidy"
    passed.mkdir(exist_ok=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        complaints = [text for text in pool.map(lambda entry: check(entry, build_dir, passed), wanted) if text]
    print(*complaints, sep="\n", end="")
    print(f"clang-tidy: {len(wanted) - len(complaints)} of {len(wanted)} sources pass")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
