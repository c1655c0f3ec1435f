"""Print what pip must install to build, develop or document octomarch, one requirement a line, as pyproject.toml says.

The Makefile calls it before the package itself can be installed, with ``build``, ``dev`` or ``docs``.
"""

import sys
import tomllib
from pathlib import Path

# scikit-build-core fetches these by itself in an isolated build; the Makefile builds without isolation.
BUILD_PROGRAMS = ["cmake>=3.25", "ninja>=1.10"]


def extra(project: dict, name: str) -> list[str]:
    """Return the requirements of an extra, with the extras of octomarch that it names put in their place."""
    found = []
    for requirement in project["optional-dependencies"][name]:
        if requirement.startswith(f"{project['name']}["):
            for other in requirement.split("[")[1].rstrip("]").split(","):
                found += extra(project, other.strip())
        else:
            found.append(requirement)
    return found


def main(kind: str) -> None:
    pyproject = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text())
    if kind == "build":
        lines = pyproject["build-system"]["requires"] + BUILD_PROGRAMS
    else:
        lines = extra(pyproject["project"], kind)
    print(*lines, sep="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
