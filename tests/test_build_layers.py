"""The layers of the C++ sources, read from their includes.

A folder includes only what stands before it in LAYERS. The scalar reference must be able to disagree with the fast
path, so it sees base and graph only; kernels see compiled programs, never the graph; Python, GLM and xsimd stay where
they belong.
"""

import re
from pathlib import Path

import pytest

SOURCE_DIR = Path(__file__).parent.parent / "cpp" / "octomarch"
SOURCES = sorted(path for path in SOURCE_DIR.rglob("*") if path.suffix in {".hpp", ".cpp", ".def"})
INCLUDE = re.compile(r'^\s*#\s*include\s+(["<][^">]+[">])', re.MULTILINE)

LAYERS = ["base", "ops", "graph", "program", "kernels", "render", "bindings"]
ALLOWED = {folder: set(LAYERS[: position + 1]) for position, folder in enumerate(LAYERS)}
ALLOWED["kernels"] -= {"graph"}
ALLOWED["reference"] = {"base", "graph", "reference"}
ALLOWED["bindings"] |= {"reference"}

# What kernel files must not include, directly or through others: each brings functions that are not templates over the
# instruction set, so that the linker may keep the copy compiled for a newer processor than the one it runs on.
FORBIDDEN_IN_KERNELS = re.compile(
    r"<(glm/.*|iostream|ostream|istream|sstream|fstream|format|string|vector|deque|list|map|set|unordered_map|"
    r"unordered_set|functional|memory|mutex|thread|future|regex|locale|random|any|variant|optional|stdexcept)>"
)


def name_of(path: Path) -> str:
    return path.relative_to(SOURCE_DIR).as_posix()


def includes(path: Path) -> list[str]:
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def own_includes(path: Path) -> list[Path]:
    """Return the project's own headers that a file includes, generated ones left out."""
    own = [SOURCE_DIR.parent / name[1:-1] for name in includes(path) if name.startswith('"')]
    return [header for header in own if header.exists()]


def closure(path: Path) -> list[Path]:
    """Return a file and all of the project's own files that it includes, directly or through others."""
    reached = [path]
    for file in reached:
        reached += [header for header in own_includes(file) if header not in reached]
    return reached


def test_sources_exist() -> None:
    assert SOURCES


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_own_headers_are_included_in_quotes_from_the_root(path: Path) -> None:
    assert [name for name in includes(path) if name.startswith('"') != name[1:].startswith("octomarch/")] == []


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_includes_obey_the_layers(path: Path) -> None:
    folder = path.relative_to(SOURCE_DIR).parts[0]
    seen = {name.split("/")[1] for name in includes(path) if name.startswith('"octomarch/')}
    assert seen - ALLOWED[folder] == set()


@pytest.mark.parametrize("path", sorted(SOURCE_DIR.glob("reference/*")), ids=name_of)
def test_reference_sees_base_and_graph_only(path: Path) -> None:
    assert {file.parent.name for file in closure(path)} <= ALLOWED["reference"]


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_libraries_stay_in_their_folders(path: Path) -> None:
    folder = path.relative_to(SOURCE_DIR).parts[0]
    text = path.read_text(encoding="utf-8")
    if folder != "bindings":
        assert not re.search(r"<pybind11/|<Python\.h>|\bpy::|\bpybind11::", text)
    if folder != "reference":
        assert "<glm/" not in text
    if folder != "kernels":
        assert "<xsimd/" not in text


@pytest.mark.parametrize("path", sorted(SOURCE_DIR.glob("kernels/isa_*.cpp")), ids=name_of)
def test_kernels_include_nothing_that_leaks(path: Path) -> None:
    assert "graph" not in {file.parent.name for file in closure(path)}
    leaks = [
        f"{name_of(file)} includes {name}"
        for file in closure(path)
        for name in includes(file)
        if FORBIDDEN_IN_KERNELS.fullmatch(name)
    ]
    assert leaks == []
