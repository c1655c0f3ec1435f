"""`Study`: the rows of a study, its Pareto front, and how they are shown and saved."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from octomarch import _validate as check
from octomarch._files import atomic
from octomarch.study.front import pareto_front
from octomarch.study.measure import Subject
from octomarch.study.rows import COLUMNS, Measures, StudyRow, StudyTable
from octomarch.study.settings import Setting
from octomarch.study.truth import Truth

FRONT = ("evaluations", "p95", "wrong")
"""What `Study.front` weighs against each other."""

MARCHING = ("base", "series", "method", "epsilon", "pixel_tolerance", "step", "finish", "prepass", "combined")
"""The groups among which it looks: those that change neither what a ray costs nor what it finds have no say."""


class Study:
    """What settings cost and how far they are from the truth; made by `octomarch.study`.

    Examples
    --------
    >>> import octomarch as om
    >>> study = om.study(om.sphere(1.0), size=(32, 24), groups=("series",), rounds=0)
    >>> study
    <Study of 11 settings, 32×24>
    >>> study.table[-1].march.max_steps
    512
    """

    table: StudyTable
    """All rows, in the order of the groups: ``print(study.table)``, or a row's attributes, see `StudyRow`."""

    def __init__(self, subject: Subject, truth: Truth, rows: Sequence[tuple[Setting, Measures]]) -> None:
        self._subject = subject
        self._truth = truth
        self.table = StudyTable([StudyRow(**vars(measures), **vars(setting)) for setting, measures in rows])

    def __repr__(self) -> str:
        width, height = self.size
        return f"<Study of {len(self.table)} settings, {width}×{height}>"

    def __str__(self) -> str:
        return f"{self.table}\n\nTruth: {self.truth}.\n\nNothing costs less for the same error than\n\n{self.front}"

    def _repr_html_(self) -> str:
        from octomarch.study.report import notebook  # here, since it builds on this module

        return notebook(self)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures in pixels."""
        return self._subject.size

    @property
    def truth(self) -> str:
        """How the truth was found: for how many rays it is proven, and at how many of them float64 says otherwise."""
        return str(self._truth)

    @cached_property
    def front(self) -> StudyTable:
        """Rows that no other beats: fewer evaluations cost depth p95 or rays that end wrong. See `pareto`."""
        return self.pareto(*FRONT)

    def pareto(self, *columns: str) -> StudyTable:
        """Return the rows that no other row beats, by rising first column.

        A row beats another if it is no worse in any column and better in one. Only rows that change how rays are
        marched take part, in the precision of the base; those whose far limit cuts surfaces off show another scene.

        Parameters
        ----------
        *columns : str
            At least one number of `StudyRow`, such as ``"depth_ms", "p99"``; less is better.

        Returns
        -------
        StudyTable

        Raises
        ------
        TypeError, ValueError
            If there is no column or an unknown one.

        Examples
        --------
        >>> import octomarch as om
        >>> study = om.study(om.sphere(1.0), size=(32, 24), groups=("epsilon",), rounds=0)
        >>> fast = study.pareto("evaluations", "p99")
        >>> bool((fast.column("p99")[1:] < fast.column("p99")[:-1]).all())
        True
        """
        if not columns:
            raise ValueError("columns must name at least one number of om.StudyRow, got none")
        names = [check.choice("columns", name, COLUMNS) for name in columns]
        rows = StudyTable([row for row in self.table.of(*MARCHING) if not row.cut])
        indices = pareto_front(np.stack([rows.column(name) for name in names], axis=-1))
        return StudyTable([rows[int(index)] for index in indices])

    def plot(self) -> Any:
        """Plot error against cost: depth p95 over evaluations, and over time where pictures were timed.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ImportError
            Saying what to install, if matplotlib is not.

        Examples
        --------
        >>> import octomarch as om
        >>> study = om.study(om.sphere(1.0), size=(32, 24), groups=("epsilon",), rounds=0)
        >>> study.plot().savefig("epsilon.png")  # doctest: +SKIP
        """
        from octomarch.study.plots import figure  # here, since matplotlib is an extra

        return figure(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save a report: table, front, plots, and the pictures of the series beside their differences from the truth.

        One file that needs no other and no network. Pictures of the series are rendered again for it. Without
        matplotlib there are no plots; without FLIP differences are those of the brightness.

        Parameters
        ----------
        path : str or path-like
            Ends in ``.html``; a file that is there is replaced.

        Raises
        ------
        ValueError
            If the suffix is another.
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> import octomarch as om, pathlib, tempfile
        >>> study = om.study(om.sphere(1.0), size=(32, 24), groups=("finish",), rounds=0)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     study.save(pathlib.Path(folder, "study.html"))
        """
        from octomarch.study.report import page  # here, since it builds on this module

        name = check.path("path", path)
        if Path(name).suffix.lower() != ".html":
            raise ValueError(f"path must end in .html, got {check.shown(name)}")
        with atomic(path) as temporary:
            temporary.write_text(page(self), encoding="utf-8")
