"""What sphinx-gallery asks of us: where a gallery script shall save its picture, and which picture it then shows.

A script of `examples/gallery` saves one picture under the name that it gets as its argument; `conf.py` names both
functions. The pictures stay in `out/gallery`. Where a script builds on a module that several share, its page shows that
module too.
"""

import re
from pathlib import Path
from typing import Any

import PIL.Image
from sphinx.application import Sphinx

OUTPUT = Path(__file__).parents[2] / "out" / "gallery"


_SHARED = re.compile(r"^ +from (_\w+) import", re.MULTILINE)
_AFTER_CODE = ".. _sphx_glr_download_"


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", _show_shared_modules)
    return {"parallel_read_safe": True}


def output_argument(_: dict[str, Any], script: dict[str, Any]) -> list[str]:
    """Return the arguments that a script is run with."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    picture = _picture_of(script)
    picture.unlink(missing_ok=True)
    return [str(picture)]


def saved_picture(_: tuple[str, str, int], block_vars: dict[str, Any], conf: dict[str, Any]) -> str:
    """Take the picture that a script has saved, and return the RST that shows it."""
    picture = _picture_of(block_vars)
    if not picture.exists():
        raise FileNotFoundError(f"{picture.stem}.py must save its picture under the name it gets as its argument")
    shown = Path(next(block_vars["image_path_iterator"]))
    with PIL.Image.open(picture) as image:
        width = image.width
    shown.write_bytes(picture.read_bytes())
    path = shown.relative_to(conf["src_dir"]).as_posix()
    return f"\n\n.. image:: /{path}\n   :alt: {picture.stem}\n   :width: {width}\n   :class: sphx-glr-single-img\n\n"


def _picture_of(script: dict[str, Any]) -> Path:
    return OUTPUT / Path(script["src_file"]).with_suffix(".png").name


def _show_shared_modules(_: Sphinx, docname: str, source: list[str]) -> None:
    if docname.startswith("gallery/"):
        names = _SHARED.findall(source[0])
        shown = [f"``{name}.py``:\n\n.. literalinclude:: /../examples/gallery/{name}.py\n\n" for name in names]
        source[0] = source[0].replace(_AFTER_CODE, "".join(shown) + _AFTER_CODE, 1)
