"""The object files of the kernels: no function compiled for one instruction set can stand in for another's.

The linker keeps one copy of each weak symbol. Were a function the same symbol in the AVX-512 object and elsewhere, that
copy could be the one that runs on a processor without AVX-512. So nothing weak in a kernel object may be defined
anywhere else in the extension, and no container, stream or GLM code may be in a kernel object at all.
"""

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOREIGN = re.compile(
    r"\b(glm::|std::(__cxx11::)?(basic_string|basic_\w*stream|vector|deque|map|set|list|function|shared_ptr|unique_ptr|"
    r"unordered_|locale|__detail::|__throw_))"
)
WEAK = set("WVuv")  # weak function, weak object, unique global, as `nm` writes them


def build_dir() -> Path | None:
    """Return the build directory that OCTOMARCH_BUILD_DIR names, else the newest in build/ with kernel objects."""
    if named := os.environ.get("OCTOMARCH_BUILD_DIR"):
        return ROOT / named
    candidates = [objects.parent.parent for objects in ROOT.glob("build/*/CMakeFiles/octomarch_isa_scalar.dir")]
    return max(candidates, key=lambda path: (path / "CMakeCache.txt").stat().st_mtime, default=None)


def isa_of(path: Path) -> str | None:
    found = re.search(r"/octomarch_isa_(\w+)\.dir/", path.as_posix())
    return found[1] if found else None


@cache
def objects() -> list[Path]:
    """Return every object file that is linked into the extension."""
    folder = build_dir()
    if folder is None or shutil.which("nm") is None:
        pytest.skip("needs the build directory of the extension and nm")
    targets = folder.glob("CMakeFiles/*.dir")
    return sorted(path for target in targets for path in target.rglob("*.o"))


@cache
def defined(path: Path) -> dict[str, str]:
    """Return the demangled symbols that an object file defines for the linker, with their nm type."""
    listing = subprocess.run(["nm", "--defined-only", "--demangle", path], capture_output=True, text=True, check=True)
    symbols = {}
    for line in listing.stdout.splitlines():
        _, kind, name = line.split(" ", 2)
        if kind.isupper() or kind in WEAK:
            symbols[name] = kind
    return symbols


def weak(path: Path) -> set[str]:
    return {name for name, kind in defined(path).items() if kind in WEAK and not name.startswith("DW.ref.")}


def kernels() -> Iterator[tuple[str, Path]]:
    for path in objects():
        if isa := isa_of(path):
            yield isa, path


def test_every_isa_of_the_machine_was_built() -> None:
    import octomarch as om

    assert {isa for isa, _ in kernels()} >= set(om.isas())


def test_kernels_share_no_weak_symbol_with_other_objects() -> None:
    shared = [
        f"{name}: in the {isa} kernels and in {other.relative_to(other.parents[2])}"
        for isa, path in kernels()
        for other in objects()
        if other != path
        for name in sorted(weak(path) & defined(other).keys())
    ]
    assert shared == []


def test_kernels_hold_no_foreign_code() -> None:
    foreign = [f"{isa}: {name}" for isa, path in kernels() for name in defined(path) if FOREIGN.search(name)]
    assert foreign == []


def test_kernels_define_their_own_namespace_only() -> None:
    strangers = [
        f"{isa}: {name}"
        for isa, path in kernels()
        for name in defined(path)
        if "octomarch::" in name and isa not in name
    ]
    assert strangers == []
