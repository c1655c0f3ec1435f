"""What commands are made of: how arguments are read, how mistakes are told, how a command ends.

Comes before all other modules of the package. A mistake in the usage is one line that suggests what was meant.
"""

from __future__ import annotations

import argparse
import re
import shlex
import sys
from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Any, NoReturn, TypeAlias

from octomarch._spelling import nearest

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"
Run: TypeAlias = Callable[[argparse.Namespace], None]

_WIDTH = 100


class Exit(IntEnum):
    """How a command has ended.

    Examples
    --------
    >>> int(Exit.USAGE)
    2
    """

    OK = 0
    """Done."""
    ERROR = 1
    """Something failed, which is told in one line."""
    USAGE = 2
    """An option or argument is unknown, missing or malformed, which is told in one line."""
    PART = 3
    """Some frames could not be rendered; all others are there."""
    INTERRUPTED = 130
    """Ctrl-C; what can be resumed is kept."""
    PIPE = 141
    """Nobody reads the output any more."""


class ScriptError(Exception):
    """A Python file that was to give a scene raised something; the message says what, and where."""


class Parser(argparse.ArgumentParser):
    """An argument parser that takes no abbreviations, suggests what was meant, and tells mistakes in one line.

    Examples
    --------
    >>> parser = Parser(prog="paint")
    >>> action = parser.add_argument("--color")
    >>> parser.meant("--colour")
    "; did you mean '--color'?"
    """

    examples: tuple[str, ...] = ()
    """Lines of the help that show how the command is used, and run."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"allow_abbrev": False, "formatter_class": _Help, **options})

    def read(self, arguments: Sequence[str] | None = None) -> argparse.Namespace:
        """Read arguments; those that no command knows are mistakes of the command that got them."""
        found, extra = self.parse_known_args(arguments)
        if extra:
            of: Parser = getattr(found, "parser", self)
            of.error(f"unrecognized arguments: {shlex.join(extra)}{of.meant(extra[0])}")
        return found

    def meant(self, word: str) -> str:
        """Return what to add to a message about an option that does not exist."""
        guess = nearest(word.partition("=")[0], [text for action in self._actions for text in action.option_strings])
        return f"; did you mean {guess!r}?" if guess else ""

    def error(self, message: str) -> NoReturn:
        """End with one line."""
        wrong = re.search(r"invalid choice: '(?P<word>[^']*)' \(choose from (?P<words>.*)\)", message)
        guess = wrong and nearest(wrong["word"], re.findall(r"[\w-]+", wrong["words"]))
        told = message + (f"; did you mean {guess!r}?" if guess else "")
        print(f"{self.prog}: {told}; see {self.prog} --help", file=sys.stderr)
        raise SystemExit(int(Exit.USAGE))


def command(
    commands: Commands, name: str, run: Run, *, title: str, description: str = "", examples: Sequence[str] = ()
) -> Parser:
    """Add a command, and return its parser for its arguments.

    Parameters
    ----------
    commands
        What `add` of the command's module gets.
    name : str
        Of the command.
    run : callable
        Does it, given the options; what it raises is told in one line.
    title : str
        What it does, in one line without a full stop.
    description : str
        What else there is to say.
    examples : sequence of str
        Command lines that run where the tests' files are: see tests/test_cli_examples.py.

    Examples
    --------
    >>> whole = Parser(prog="paint")
    >>> wall = command(whole.add_subparsers(), "wall", print, title="paint a wall", examples=["paint wall"])
    >>> whole.read(["wall"]).run is print
    True
    """
    opening = " ".join(f"{title[0].upper()}{title[1:]}. {description}".split())
    epilog = "\n".join(["examples:", *(f"  {example}" for example in examples)]) if examples else ""
    parser = commands.add_parser(name, help=title, description=opening, epilog=epilog)
    parser.examples = tuple(examples)
    parser.set_defaults(run=run, parser=parser)
    return parser


class _Help(argparse.HelpFormatter):
    """Help of one width whatever the terminal's, in which examples keep their lines."""

    def __init__(self, prog: str, **options: Any) -> None:
        super().__init__(prog, max_help_position=28, width=_WIDTH, **options)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if text.startswith("examples:") else super()._fill_text(text, width, indent)
