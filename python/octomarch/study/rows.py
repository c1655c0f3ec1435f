"""The rows of a study, and tables of them: as text in a terminal, as HTML in a notebook and in reports."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import SupportsIndex, overload

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.march import March
from octomarch.shading import Shading


@dataclass(frozen=True)
class Measures:
    """All numbers of a row; `StudyRow` says what they mean."""

    evaluations: float
    """Of the field for each camera ray, cones included: the same on every machine."""
    shading_evaluations: float
    """For each camera ray: gradients, shadows, occlusion, reflections."""
    rays: int
    """That meet a surface, in the picture or in truth."""
    p50: float
    """Error of depth in scene units that half of these rays do not exceed. A ray that meets a surface only in the
    picture, or only in truth, has an infinite error; one that ran out of steps that of its candidate."""
    p95: float
    """The same for 95 of 100 rays."""
    p99: float
    """The same for 99 of 100 rays."""
    normal_p50: float
    """Angle between normals in degrees, where both have one."""
    normal_p95: float
    """The same for 95 of 100 of them."""
    false_hits: int
    """Rays that hit where nothing is."""
    false_misses: int
    """Rays that miss a surface that is nearer than the far limit."""
    cut: int
    """Rays that miss a surface since it lies beyond the far limit; no error of depth is counted for them."""
    hit: int
    """Rays that end as `Status.HIT`."""
    miss: int
    """Rays that end as `Status.MISS`."""
    step_limit: int
    """Rays that end as `Status.STEP_LIMIT`."""
    inside: int
    """Rays that end as `Status.INSIDE`."""
    invalid: int
    """Rays that end as `Status.INVALID`."""
    flip: float | None
    """Mean FLIP between the picture and the true one, from 0 to 1. None: FLIP is not installed."""
    depth_ms: float | None
    """Milliseconds of processor time for the depth alone, the median of the rounds. None: no rounds were asked for."""
    depth_ratio: float | None
    """The median over the rounds of this time divided by the base's in the same round."""
    picture_ms: float | None
    """Milliseconds of processor time for the colours."""
    picture_ratio: float | None
    """The median over the rounds of this time divided by the base's in the same round."""


@dataclass(frozen=True)
class StudyRow(Measures):
    """What one setting costs and how far it is from the truth: a row of `Study.table`.

    Examples
    --------
    >>> import octomarch as om
    >>> study = om.study(om.sphere(1.0), size=(32, 24), groups=("finish",), rounds=0)
    >>> row = study.table[0]
    >>> row.name, row.march == om.March(), row.false_misses
    ('as given', True, 0)
    """

    group: str
    """What is varied: one of the groups of `octomarch.study`."""
    name: str
    """Its value."""
    march: March
    """The settings, for `octomarch.render`."""
    shading: Shading
    precision: Precision

    @property
    def wrong(self) -> int:
        """Rays that should hit and miss, or hit and should not, or end before their surface at the far limit."""
        return self.false_hits + self.false_misses + self.cut


class StudyTable:
    """Rows of a study: ``table[0]``, ``table[3:]``, ``len(table)``, ``for row in table``; it shows itself.

    Examples
    --------
    >>> import octomarch as om
    >>> table = om.study(om.sphere(1.0), size=(32, 24), groups=("finish",), rounds=0).table
    >>> len(table), table.column("false_misses").tolist()
    (3, [0.0, 0.0, 0.0])
    """

    def __init__(self, rows: Sequence[StudyRow]) -> None:
        self._rows = tuple(rows)

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[StudyRow]:
        return iter(self._rows)

    @overload
    def __getitem__(self, index: SupportsIndex) -> StudyRow: ...

    @overload
    def __getitem__(self, index: slice) -> StudyTable: ...

    def __getitem__(self, index: SupportsIndex | slice) -> StudyRow | StudyTable:
        return StudyTable(self._rows[index]) if isinstance(index, slice) else self._rows[index]

    def __repr__(self) -> str:
        return f"<StudyTable of {len(self)} settings>"

    def __str__(self) -> str:
        heads, lines = self._texts()
        widths = [max(map(len, column)) for column in zip(heads, *lines, strict=True)]
        aligned = [
            "  ".join(cell.ljust(width) if i < 2 else cell.rjust(width) for i, (cell, width) in enumerate(cells))
            for cells in (list(zip(line, widths, strict=True)) for line in [heads, *lines])
        ]
        return "\n".join(line.rstrip() for line in aligned)

    def _repr_html_(self) -> str:
        heads, lines = self._texts()
        head = "".join(f"<th title='{html.escape(_TITLES[text])}'>{html.escape(text)}</th>" for text in heads)
        body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in line) + "</tr>\n" for line in lines)
        return f"<table class='study'><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table>"

    def column(self, name: str) -> NDArray[np.float64]:
        """Return one number of all rows, NaN where it was not measured.

        Parameters
        ----------
        name : str
            A number of `StudyRow`, such as ``"p95"``.

        Raises
        ------
        TypeError, ValueError
            If there is no such number.
        """
        check.choice("name", name, COLUMNS)
        values = (getattr(row, name) for row in self._rows)
        return np.array([np.nan if value is None else value for value in values], dtype=np.float64)

    def of(self, *groups: str) -> StudyTable:
        """Return the rows of some groups."""
        return StudyTable([row for row in self._rows if row.group in groups])

    def _texts(self) -> tuple[list[str], list[list[str]]]:
        """Return heads and cells; columns that no row has are left out."""
        shown = [column for column in _SHOWN if any(column[2](row) for row in self._rows) or not self._rows]
        return [head for head, _, _ in shown], [[text(row) for _, _, text in shown] for row in self._rows]


COLUMNS = (*Measures.__dataclass_fields__, "wrong")
"""Names of all numbers of a row."""


def count(value: float) -> str:
    """Return a number of rays as text.

    Examples
    --------
    >>> count(12345), count(0)
    ('12,345', '0')
    """
    return f"{value:,.0f}"


def small(value: float) -> str:
    """Return an error as text.

    Examples
    --------
    >>> small(3.21e-5), small(float("inf")), small(0.0)
    ('3.2e-05', '∞', '0')
    """
    if value == np.inf:
        return "∞"
    return f"{value:.1e}" if value else "0"


def _optional(text: Callable[[float], str], value: float | None) -> str:
    return "" if value is None else text(value)


_SHOWN: tuple[tuple[str, str, Callable[[StudyRow], str]], ...] = (
    ("group", "What is varied", lambda row: row.group),
    ("setting", "Its value", lambda row: row.name),
    ("evals", "Evaluations of the field per camera ray, cones included", lambda row: f"{row.evaluations:.1f}"),
    ("shading", "Evaluations per camera ray for shading", lambda row: f"{row.shading_evaluations:.1f}"),
    ("depth ms", "Processor time of the depth alone", lambda row: _optional("{:.1f}".format, row.depth_ms)),
    ("× base", "That time beside the base's", lambda row: _optional("{:.2f}".format, row.depth_ratio)),
    ("picture ms", "Processor time of the colours", lambda row: _optional("{:.1f}".format, row.picture_ms)),
    ("× base ", "That time beside the base's", lambda row: _optional("{:.2f}".format, row.picture_ratio)),
    ("Δt p50", "Error of depth, scene units, median", lambda row: small(row.p50)),
    ("Δt p95", "Error of depth, scene units, 95th percentile", lambda row: small(row.p95)),
    ("Δt p99", "Error of depth, scene units, 99th percentile", lambda row: small(row.p99)),
    ("normal p95", "Angle between normals, degrees, 95th percentile", lambda row: small(row.normal_p95)),
    ("false hits", "Rays that hit where nothing is", lambda row: count(row.false_hits)),
    ("false misses", "Rays that miss a surface", lambda row: count(row.false_misses)),
    ("cut", "Rays whose surface lies beyond the far limit", lambda row: count(row.cut)),
    ("out of steps", "Rays that end as STEP_LIMIT", lambda row: count(row.step_limit)),
    ("FLIP", "Mean FLIP between the picture and the true one", lambda row: _optional("{:.4f}".format, row.flip)),
)
_TITLES = {head: title for head, title, _ in _SHOWN}
