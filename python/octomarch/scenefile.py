"""Scenes as files: JSON that anybody can read and write, and pickles that go the same way.

`_document` says what stands in it, this module how it is written, found and read: a file of its own, or what a picture
knows of how it was made. Reading runs no code and opens no other file.
"""

from __future__ import annotations

import copyreg
import gc
import hashlib
import json
import os
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Never

from octomarch import _document
from octomarch import _validate as check
from octomarch._files import atomic
from octomarch.expressions import Expression
from octomarch.scene import Scene
from octomarch.shapes import Shape
from octomarch.shot import Shot
from octomarch.textures import Texture

_MOST_IN_PICTURES = 4000  # nodes and texels: some 200 kB
_ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False)
_WIDTH = 120  # of lines, nodes excepted
_PICTURES = {b"\x76\x2f\x31\x01": "exr", b"\x89PNG": "png"}


def load(path: str | os.PathLike[str]) -> Scene:
    """Load the scene that `Scene.save` or `Shot.save` wrote, or that a saved picture shows.

    Every shape, material and light comes back bit for bit, and renders to the same bits. Loading runs no code and opens
    no other file, so that files from anybody can be loaded.

    Parameters
    ----------
    path : str or path-like
        A scene file, or an EXR or PNG file that `Image.save` wrote of a scene that was not too large.

    Returns
    -------
    Scene
        Of a shot its scene; `Shot.load` has the camera and the settings as well.

    Raises
    ------
    ValueError
        Naming the file, the place in it such as ``nodes[12].radius``, and the value: if something is missing, unknown
        or outside its range, or the file was written in a later version of the format.
    OSError
        If the file cannot be opened, or is a damaged picture.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> scene = om.Scene(om.sphere(1.0) - om.box(1.2), ambient=0.2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "scene.json")
    ...     scene.save(path)
    ...     om.load(path) == scene
    True
    """
    value = read(path)
    return value.scene if isinstance(value, Shot) else value


def read(path: str | os.PathLike[str]) -> Scene | Shot:
    """Return the scene or shot of a file; see `load`.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "shot.json")
    ...     om.Shot(om.Scene(om.sphere(1.0)), size=(16, 9)).save(path)
    ...     read(path).size
    (16, 9)
    """
    name = check.path("path", path)
    with Path(name).open("rb") as file:
        data = file.read()
    picture = _PICTURES.get(data[:4])
    try:
        value = parsed(data if picture is None else _in_picture(name, picture))
        if not isinstance(value, (Scene, Shot)):
            raise ValueError(f"content must be a Scene or a Shot, got {check.shown(value)}")
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    return value


def write(path: str | os.PathLike[str], value: Scene | Shot) -> None:
    """Write a scene or shot as a file, whole or not at all.

    Examples
    --------
    >>> import octomarch as om, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(pathlib.Path(folder, "ball.json"), om.Scene(om.sphere(1.0)))
    """
    name = check.path("path", path)
    if Path(name).suffix.lower() != ".json":
        raise ValueError(f"path must end in .json, got {check.shown(name)}")
    with _without_collector():
        data = text(_document.document(value)).encode()
    with atomic(path) as temporary:
        temporary.write_bytes(data)


def text_for_picture(shot: Shot) -> str | None:
    """Return what a picture should hold of how it was made; None where that is too much.

    Examples
    --------
    >>> import octomarch as om
    >>> shot = om.Shot(om.Scene(om.sphere(1.0)))
    >>> parsed(text_for_picture(shot)) == shot
    True
    """
    if _document.weight(shot) > _MOST_IN_PICTURES:
        return None
    return _line(_document.document(shot))


def digest(shot: Shot) -> str:
    """Return what tells a shot from all others, and from itself in other versions: a SHA-256 of its document.

    Examples
    --------
    >>> import octomarch as om
    >>> shot = om.Shot(om.Scene(om.sphere(1.0)))
    >>> digest(shot) == digest(om.Shot(om.Scene(om.sphere(1.0)))), digest(shot) == digest(om.Shot(om.Scene(om.box(1))))
    (True, False)
    """
    with _without_collector():
        return hashlib.sha256(_line(_document.document(shot)).encode()).hexdigest()


def text(document: dict[str, Any]) -> str:
    """Return a document as JSON to be read by people too: a line for each node, and for each field of what it holds.

    Examples
    --------
    >>> print(text({"version": 1, "nodes": [{"kind": "sphere", "radius": 1.0}]}))
    {
      "version": 1,
      "nodes": [
        {"kind": "sphere", "radius": 1.0}
      ]
    }
    <BLANKLINE>
    """
    lines = []
    for key, value in document.items():
        value = _nodes(value) if key == "nodes" else _indented(value, "  ")
        lines.append(f"  {_line(key)}: {value}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def parsed(data: str | bytes) -> Any:
    """Return the value of a document in JSON.

    Raises
    ------
    ValueError
        Naming the place, if `data` is no JSON or no document.

    Examples
    --------
    >>> import octomarch as om
    >>> parsed(text(om._document.document(om.PointLight((1, 2, 3)))))
    PointLight(position=(1.0, 2.0, 3.0), color=(1.0, 1.0, 1.0), decay=2)
    """
    try:
        document = data if isinstance(data, str) else data.decode()
        with _without_collector():
            return _document.restored(json.loads(document, object_pairs_hook=_unique, parse_constant=_constant))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"no JSON: {error}") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"no JSON, which is UTF-8: byte {error.start} is not") from None


@contextmanager
def _without_collector() -> Iterator[None]:
    """Let the collector of cyclic garbage wait while many small containers are made, none of them in a cycle.

    It would look at all of them again and again, and take as long as all the rest.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) < len(pairs):
        counts = Counter(key for key, _ in pairs)
        raise ValueError(f"{check.shown(max(counts, key=counts.__getitem__))} stands twice in one object")
    return result


def _constant(name: str) -> Never:
    raise ValueError(f'{name} is no number in JSON; infinities are "inf" and "-inf"')


def _line(value: Any) -> str:
    return _ENCODER.encode(value)


def _nodes(nodes: list[dict[str, Any]]) -> str:
    """Return JSON in which each node has a line."""
    # of one call, which is twice as fast: nodes hold no object, and no text of their own but names and base64
    return "[\n    " + _line(nodes)[1:-1].replace("}, {", "},\n    {") + "\n  ]" if nodes else "[]"


def _indented(value: Any, margin: str) -> str:
    """Return JSON in which what is too long for a line has a line for each item."""
    line, inner = _line(value), margin + "  "
    if len(margin) + len(line) <= _WIDTH or not isinstance(value, (dict, list)):
        return line
    if isinstance(value, dict):
        items = [f"{_line(key)}: {_indented(item, inner)}" for key, item in value.items()]
    else:
        items = [_indented(item, inner) for item in value]
    begin, end = line[0], line[-1]
    return f"{begin}\n{inner}" + f",\n{inner}".join(items) + f"\n{margin}{end}"


def _in_picture(path: str, kind: str) -> str:
    """Return the document that a picture holds."""
    if kind == "exr":
        from octomarch.exr import read_document  # here, since it is not needed to render

        found = read_document(path)["metadata"].get("document")
    else:
        from octomarch.png import read_text

        found = read_text(path)
    if not isinstance(found, str):
        raise ValueError("the picture does not hold its scene: that was too large, or another program wrote it")
    return found


def _reduced(value: object) -> tuple[Callable[[str], Any], tuple[str]]:
    """Return what pickles and copies of a value are made of."""
    with _without_collector():
        return parsed, (_line(_document.document(value)),)


for kind in (Shape, Expression, Texture, *_document.CLASSES.values()):
    copyreg.pickle(kind, _reduced)
