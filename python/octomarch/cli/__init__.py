"""The command ``octomarch``.

Each command is a module of this package with a function `add`, listed in `COMMANDS`. They come last of all modules, and
build on what is public. `parser` has what commands are made of, `options` the options that several of them share,
`subjects` says what a scene on the command line is, and `changes` what ``--set`` changes of it.

Exit statuses are those of `Exit`.
"""

from __future__ import annotations

import argparse
import os
import sys
import traceback
import warnings
from collections.abc import Sequence

import octomarch as om
from octomarch.cli import animate, demo, glsl, info, listing, mesh, render, study, view
from octomarch.cli.parser import Exit, Parser, ScriptError

COMMANDS = (render, view, animate, study, mesh, glsl, listing, info, demo)
"""In the order of the help. To add one: a module with ``add(commands)``, which calls `octomarch.cli.parser.command`."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status, one of `Exit`.

    Examples
    --------
    >>> main(["listing", "no-such-scene"])
    1
    """
    with warnings.catch_warnings():
        warnings.showwarning = _tell
        return int(_status(whole_parser().read(arguments)))


def whole_parser() -> Parser:
    """Return what reads the command line.

    Examples
    --------
    >>> whole_parser().read(["listing", "blend"]).scene
    'blend'
    """
    whole = Parser(
        prog="octomarch",
        description="A SIMD ray marcher for signed distance fields.",
        epilog="octomarch COMMAND --help has the options of a command, and examples.",
    )
    whole.add_argument("--version", action="version", version=f"octomarch {om.__version__}")
    commands = whole.add_subparsers(required=True, metavar="COMMAND", dest="command")
    for module in COMMANDS:
        module.add(commands)
    for command in commands.choices.values():
        command.add_argument("--traceback", action="store_true", help="show where in the code an error was raised")
    return whole


def _status(options: argparse.Namespace) -> Exit:
    try:
        options.run(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return _failed("interrupted", Exit.INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else Python's last flush complains
        return Exit.PIPE
    except om.FramesError as error:
        return _failed(error, Exit.PART, options.traceback)
    except MemoryError as error:
        return _failed(f"{error}" or "there is not enough memory", Exit.ERROR, options.traceback)
    except (OSError, ValueError, TypeError, ImportError, om.SceneError, ScriptError) as error:
        return _failed(error, Exit.ERROR, options.traceback)
    return Exit.OK


def _failed(reason: object, status: Exit, with_traceback: bool = False) -> Exit:
    if with_traceback:
        traceback.print_exc()
    print(f"octomarch: {' '.join(str(reason).split()) or type(reason).__name__}", file=sys.stderr)
    return status


def _tell(message: Warning | str, *_: object, **__: object) -> None:
    """Show a warning in one line: where in the package it was raised helps nobody."""
    print(f"octomarch: warning: {' '.join(str(message).split())}", file=sys.stderr)
