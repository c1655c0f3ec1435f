"""The report of a study as one HTML file: table, front, plots, and pictures beside their differences from the truth.

`result` comes before it. Pictures are part of the text, and styles too, so that the file needs no other.
"""

from __future__ import annotations

import base64
import html
import io
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from octomarch import _core, png
from octomarch.colormaps import colormap
from octomarch.machine import resolve_isa
from octomarch.study import flip, plots
from octomarch.study.rows import StudyRow, small
from octomarch.study.settings import Setting

if TYPE_CHECKING:
    from octomarch.study.result import Study

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1c; background: #fff; margin: 2rem auto; max-width: 82rem;
       padding: 0 1.5rem; }
h1, h2 { font-weight: 600; line-height: 1.2; } h2 { margin-top: 2.2rem; }
p { max-width: 46rem; }
.wide { overflow-x: auto; }
table.study { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; white-space: nowrap; }
.study th, .study td { padding: .15rem .6rem; text-align: right; border-bottom: 1px solid #e4e4e4; }
.study th:nth-child(-n+2), .study td:nth-child(-n+2) { text-align: left; }
.study thead th { position: sticky; top: 0; background: #fff; border-bottom: 1px solid #888; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(25rem, 1fr)); gap: 1.2rem 1.5rem; }
figure { margin: 0; } figure img { width: calc(50% - 3px); image-rendering: auto; vertical-align: top; }
figcaption { font-size: 13px; color: #444; }
.plot { max-width: 100%; }
"""


def page(study: Study) -> str:
    """Return the report as a page of HTML.

    Examples
    --------
    >>> import octomarch as om
    >>> study = om.study(om.sphere(1.0), size=(32, 24), groups=("series",), rounds=0)
    >>> page(study).count("<figure>")
    11
    """
    width, height = study.size
    heading = (
        f"<h1>octomarch: speed against accuracy</h1>\n<p>{len(study.table)} settings, {width} × {height} pixels, "
        f"octomarch {html.escape(_core.build_info()['version'])}, {resolve_isa(study._subject.isa)}. "
        f"Truth: {html.escape(study.truth)}.</p>"
    )
    sections = [
        heading,
        _front(study),
        _plots(study),
        _pictures(study),
        f"<h2>All settings</h2>\n{_LEGEND}<div class='wide'>{study.table._repr_html_()}</div>",
    ]
    body = "\n".join(section for section in sections if section)
    return (
        "<!doctype html>\n<html lang='en'>\n<head><meta charset='utf-8'>\n"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>\n"
        f"<title>octomarch: speed against accuracy</title>\n<style>{_STYLE}</style></head>\n"
        f"<body>\n{body}\n</body></html>\n"
    )


def notebook(study: Study) -> str:
    """Return front and table as a notebook shows them."""
    return f"{_front(study)}<details><summary>All settings</summary>{study.table._repr_html_()}</details>"


_LEGEND = (
    "<p>Evaluations of the field are counted per camera ray and the same on every machine; times are medians of "
    "processor time, and their ratios to the base are those of the same rounds. Δt is the error of depth in scene "
    "units over all rays that meet a surface in the picture or in truth, infinite (∞) where only one of the two has "
    "one; a ray that ran out of steps counts with its candidate.</p>"
)


def _front(study: Study) -> str:
    return (
        "<h2>What nothing beats</h2>\n<p>Settings for which no other has at most as many evaluations, as large an "
        f"error of depth and as many rays that end wrong.</p>\n<div class='wide'>{study.front._repr_html_()}</div>"
    )


def _plots(study: Study) -> str:
    """Return error against cost; a word on what to install where matplotlib is missing."""
    if not plots.available():
        return f"<p>{html.escape(plots.INSTALL)}</p>"
    buffer = io.BytesIO()
    study.plot().savefig(buffer, format="png", dpi=130)
    return f"<h2>Error against cost</h2>\n{_img(buffer.getvalue(), 'error of depth against cost', 'plot')}"


def _pictures(study: Study) -> str:
    """Return the pictures of the series, each beside its difference from the truth, after the true one."""
    rows = list(study.table.of("series"))
    if not rows:
        return ""
    true = study._truth.image.to_srgb()
    figures = [_figure("the truth", true)]
    for row in rows:
        setting = Setting(row.group, row.name, row.march, row.shading, row.precision)
        picture = study._subject.picture(setting, ("color",)).to_srgb()
        figures.append(_figure(_caption(row), picture, _difference(true, picture)))
    kind = "FLIP, black where nothing differs" if flip.available() else "the difference of brightness"
    return (
        f"<h2>The series</h2>\n<p>Each picture, and how it differs from the truth: {kind}.</p>\n"
        f"<div class='pictures'>\n{''.join(figures)}</div>"
    )


def _caption(row: StudyRow) -> str:
    looks = "" if row.flip is None else f", FLIP {row.flip:.4f}"
    return f"{row.name}: {row.evaluations:.1f} evaluations, Δt p95 {small(row.p95)}{looks}"


def _difference(true: NDArray[np.uint8], picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a picture of how two differ, bright where they do."""
    if flip.available():
        values: NDArray[np.floating] = flip.flip_map(true, picture)
    else:
        values = np.abs(true.astype(np.float32) - picture.astype(np.float32)).mean(axis=-1) / 255
    return png.levels(colormap(values, 0.0, 1.0))


def _figure(caption: str, *pictures: NDArray[np.uint8]) -> str:
    images = " ".join(_img(png.png_bytes(picture), caption) for picture in pictures)
    return f"<figure>{images}<figcaption>{html.escape(caption)}</figcaption></figure>\n"


def _img(data: bytes, alternative: str, name: str = "") -> str:
    css = f" class='{name}'" if name else ""
    return f"<img{css} alt='{html.escape(alternative)}' src='data:image/png;base64,{base64.b64encode(data).decode()}'>"
