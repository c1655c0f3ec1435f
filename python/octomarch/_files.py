"""Files that are written whole or not at all. `image` and `exr` write through it."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_TOKEN = 6  # bytes


@contextmanager
def atomic(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give the name of a new file beside `path`, which takes the place of `path` when the block ends well.

    On any exception, a keyboard interrupt included, the new file is removed and `path` stays as it was. Links are
    followed, and a replaced file's permissions kept.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(f"cannot write {path}: it is a directory")
    if target.exists() and not target.is_file():
        raise OSError(f"cannot write {path}: it is not a regular file")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no directory {target.parent}")
    temporary = temporary_name(target)
    try:
        temporary.open("xb").close()  # here, so that an unwritable directory is a plain OSError
        yield temporary
        if target.exists():
            shutil.copymode(target, temporary)
        temporary.replace(target)
    except BaseException:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise


def temporary_name(target: Path) -> Path:
    """Return a new name beside a file, for what `remove_leftovers` removes if the writer is killed."""
    return target.with_name(f"{_beginning(target)}{secrets.token_hex(_TOKEN)}.tmp{target.suffix}")


def remove_leftovers(paths: Iterable[str | os.PathLike[str]]) -> None:
    """Remove what writers of these files have left beside them that were killed on the way.

    Only for files that nobody is writing any more.
    """
    targets = [Path(os.path.realpath(path)) for path in paths]
    beginnings = {(target.parent, _beginning(target), target.suffix) for target in targets}
    for folder in {target.parent for target in targets}:
        for file in folder.iterdir():
            stem, _, suffix = file.name.rpartition(".tmp")
            if (folder, stem[: -2 * _TOKEN], suffix) in beginnings:
                with suppress(OSError):
                    file.unlink()


def _beginning(target: Path) -> str:
    return f".{target.stem[:100]}."
