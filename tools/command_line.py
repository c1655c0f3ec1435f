"""Write what docs/guide/command-line.md says of each command's options from the parser itself.

``python tools/command_line.py`` rewrites what stands between ``<!-- begin: NAME -->`` and ``<!-- end: NAME -->``; with
``--check`` it only says whether something is stale, which a test asks.
"""

import argparse
import re
import sys
from pathlib import Path

from octomarch.cli import whole_parser
from octomarch.cli.parser import Exit, Parser

PAGE = Path(__file__).resolve().parents[1] / "docs" / "guide" / "command-line.md"
_BLOCK = re.compile(r"(<!-- begin: (?P<name>[a-z-]+) -->\n).*?(<!-- end: (?P=name) -->)", re.DOTALL)


def commands() -> dict[str, Parser]:
    """Return the parser of each command."""
    (action,) = (each for each in whole_parser()._actions if isinstance(each, argparse._SubParsersAction))
    return dict(action.choices)


def blocks() -> dict[str, str]:
    """Return the text of every block by its name."""
    parts = {f"command-{name}": of_command(parser) for name, parser in commands().items()}
    return {**parts, "exit-statuses": exit_statuses()}


def of_command(parser: Parser) -> str:
    """Return what a command does, its examples and a table of its options."""
    rows = [_row(action) for action in parser._actions if not isinstance(action, argparse._HelpAction)]
    return "\n".join(
        [parser.description or "", "", "```sh", *parser.examples, "```", "", "| option | |", "|---|---|", *rows, ""]
    )


def exit_statuses() -> str:
    """Return a table of `Exit`, whose lines the source documents."""
    source = (PAGE.parents[2] / "python" / "octomarch" / "cli" / "parser.py").read_text(encoding="utf-8")
    told = dict(re.findall(r'^    ([A-Z]+) = \d+\n    """(.*?)"""', source, re.MULTILINE))
    return "\n".join(["| status | |", "|---|---|", *(f"| {int(each)} | {told[each.name]} |" for each in Exit), ""])


def rewritten(text: str) -> str:
    """Return the page with each block as it should be."""
    texts = blocks()
    found = [match["name"] for match in _BLOCK.finditer(text)]
    if missing := sorted(set(texts) - set(found)):
        raise ValueError(f"{PAGE.name} has no block {', '.join(missing)}")
    return _BLOCK.sub(lambda match: f"{match[1]}\n{texts[match['name']]}\n{match[3]}", text)


def _row(action: argparse.Action) -> str:
    word = action.metavar or ("{" + ",".join(action.choices) + "}" if action.choices else "")
    names = ", ".join(action.option_strings)
    shown = f"{names} {'' if action.nargs == 0 else word}".strip()
    told = (action.help or "").replace("|", "\\|")
    return f"| `{shown}` | {told} |"


def main() -> int:
    before = PAGE.read_text(encoding="utf-8")
    after = rewritten(before)
    if sys.argv[1:] == ["--check"]:
        return int(before != after)
    PAGE.write_text(after, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
