"""`study`: what settings cost in a scene, and how far each is from the truth.

`settings` says what is varied, `truth` what is right, `errors` and `measure` hold one against the other, `rows`,
`front`, `plots` and `report` show it; `search` finds the settings for an error that is wanted (`March.for_error`).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from octomarch import _validate as check
from octomarch._tasks import Executor, executor_or_none, run
from octomarch._validate import Precision
from octomarch.camera import AnyCamera, or_framing
from octomarch.march import March
from octomarch.program import Program, compile
from octomarch.progress import Callback, reporting
from octomarch.render import _or_default, lit_by_default
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.study.kept import Kept, fingerprint
from octomarch.study.measure import Measurement, Subject, measure
from octomarch.study.result import Study
from octomarch.study.rows import Measures, StudyRow, StudyTable
from octomarch.study.sample import Measured
from octomarch.study.settings import GROUPS, Setting, far_limit, sweep
from octomarch.study.truth import TRUTH_KINDS, Truth, TruthKind, find_truth

__all__ = ["GROUPS", "Measured", "Study", "StudyRow", "StudyTable", "study"]


def study(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (160, 120),
    *,
    march: March | None = None,
    shading: Shading | None = None,
    precision: Precision = "float32",
    far: float | None = None,
    groups: Sequence[str] = GROUPS,
    truth: TruthKind = "auto",
    rounds: int = 3,
    resume: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
    retries: int = 3,
    threads: int | None = None,
    isa: str | None = None,
    progress: bool | Callback | None = None,
) -> Study:
    """Measure what settings cost in a scene, and how far each is from the truth.

    Varied are, about the settings given: the classic series of 32 to 512 plain steps, without and with a far limit; the
    method, the hit epsilon, the pixel tolerance, the finish, cones before rays, some of these together; the precision,
    normals, shadows, and samples of ambient occlusion. Costs are evaluations of the field, which are the same on every
    machine, and processor time beside that of the base, both in the same rounds.

    The truth is a picture in float64 with plain steps, a hit epsilon of 1e-9 of the scene's size and steps enough for
    every ray. Where that is affordable, `octomarch.reference.certified_picture` proves the depth, and counts.

    Parameters
    ----------
    scene : Shape or Scene
        A shape alone is lit as by `octomarch.render`.
    camera : Camera, OrthographicCamera or PanoramicCamera, optional
        None: one that frames the bounded parts of the shape.
    size : (int, int)
        Width and height of the pictures in pixels.
    march, shading, precision : optional
        What settings are varied about; None for the defaults. The true picture has this shading, with exact normals.
    far : float, optional
        The far limit of the series in scene units, > 0. None: where all that is bounded has been passed.
    groups : sequence of str
        What to vary, of ``base series method epsilon pixel_tolerance step finish prepass combined precision normals
        shadows occlusion``. The base is always measured; ``step`` stands in for methods and hit epsilons where steps
        are fixed.
    truth : {"auto", "certified", "float64"}
        Prove the depth of as many lines of pixels as some seconds allow, of all, or of none. What was proven is told
        in `Study.truth`.
    rounds : int
        How often pictures are timed, 0 to 1000; 0 for counts and errors alone.
    resume : path-like, optional
        File that keeps what has been measured, after each setting. If it is there, only what it lacks is measured, so
        that an interrupted study goes on: Ctrl-C leaves in it what is done.
    executor : object with a method submit, optional
        What measures the settings, each as one task, as for `render_frames`. It need not see the same files. Times are
        of processor time where a task runs, so an executor of threads needs ``rounds=0``, and workers that share a
        machine disturb each other. None: one setting after the other, here.
    retries : int
        How often a setting that fails with an executor is tried again, ≥ 0.
    threads, isa
        As for `octomarch.render`.
    progress : bool, callable or Progress, optional
        True shows a bar. A callable gets (settings done, settings in all) from time to time, and what it raises ends
        the work. A `Progress` can be cancelled.

    Returns
    -------
    Study
        ``table``, ``front``, ``plot()`` and ``save("study.html")``.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range, or `resume` was kept by a study of something else.
    SceneError
        If the shape cannot be compiled.
    OSError
        If `resume` cannot be read or written.
    KeyboardInterrupt, CancelledError
        Ctrl-C and `Progress.cancel` stop a study at once.

    Examples
    --------
    >>> import octomarch as om
    >>> study = om.study(om.sphere(1.0) - om.box(1.2), size=(64, 48), groups=("series", "finish"), rounds=0)
    >>> print(study.truth)
    certified for 100.0% of the rays; float64 says otherwise at 0 of them
    >>> secant, none = study.table.of("finish")
    >>> secant.p95 < none.p95
    True
    """
    plan = _plan(scene, camera, size, march, shading, precision, far, groups)
    kind: TruthKind = check.choice("truth", truth, TRUTH_KINDS)
    executor, tries = executor_or_none("executor", executor), check.integer("retries", retries, 0)
    subject = Subject(
        plan.scene,
        plan.camera,
        plan.size,
        check.integer("rounds", rounds, 0, 1000),
        check.threads(threads) or None,
        check.isa(isa) or None,
    )
    kept = Kept(resume, _about(subject, plan.base, plan.far, kind))
    with reporting(progress, "study", " settings") as report:
        if report is not None:
            report(0, len(plan.settings))
        true = find_truth(
            plan.scene,
            plan.camera,
            plan.size,
            plan.base.march.resolve(plan.program, plan.camera._ray_origins(plan.size)),
            replace(plan.base.shading, normals="exact"),
            kind=kind,
            threads=subject.threads,
        )
        rows = _measure_all(subject, plan, true, kept, executor, tries, report)
    return Study(subject, true, rows)


@dataclass(frozen=True)
class _Plan:
    """What is rendered, and with which settings."""

    scene: Scene
    camera: AnyCamera
    size: tuple[int, int]
    program: Program
    base: Setting
    far: float
    reach: float
    settings: list[Setting]


def _plan(
    scene: Shape | Scene,
    camera: AnyCamera | None,
    size: tuple[int, int],
    march: March | None,
    shading: Shading | None,
    precision: Precision,
    far: float | None,
    groups: Sequence[str],
) -> _Plan:
    whole = check.size(size)
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    base = Setting(
        "base",
        "as given",
        _or_default(March, "march", march),
        _or_default(Shading, "shading", shading),
        check.precision(precision),
    )
    names = [groups] if isinstance(groups, str) else check.sequence("groups", groups, "names of groups")
    for name in names:
        check.choice("groups", name, GROUPS)
    limit = None if far is None else check.positive("far", far)
    program = compile(scene)
    camera = or_framing(camera, program, whole)
    reach = base.march.resolve(program, camera._ray_origins(whole)).max_distance or 0.0
    limit = far_limit(program, camera, whole, reach) if limit is None else limit
    lit = lit_by_default(scene, camera) if isinstance(scene, Shape) else scene
    return _Plan(lit, camera, whole, program, base, limit, reach, sweep(base, program, limit, names))


def _about(subject: Subject, base: Setting, far: float, truth: TruthKind) -> dict[str, Any]:
    """Return what decides about the figures of a study, as plain data."""
    return {
        "scene": fingerprint(subject.scene),
        "camera": repr(subject.camera),
        "size": list(subject.size),
        "base": base.key,
        "far": far,
        "truth": truth,
        "rounds": subject.rounds,
        "threads": subject.threads,
        "isa": subject.isa,
    }


def _measure_all(
    subject: Subject,
    plan: _Plan,
    truth: Truth,
    kept: Kept,
    executor: Executor | None,
    retries: int,
    report: Callback | None,
) -> list[tuple[Setting, Measures]]:
    """Measure every setting that is not kept yet."""
    lacking = list({setting.key: setting for setting in plan.settings if kept.get(setting) is None}.values())
    answer = truth.answer()

    def telling(done: int, of: int) -> None:
        if report is not None:
            report(len(plan.settings) - of + done, len(plan.settings))

    failures = run(
        measure,
        [Measurement(subject, setting, plan.base, answer, plan.reach) for setting in lacking],
        executor,
        0 if executor is None else retries,  # here it would fail again
        telling,
        lambda place, measures: kept.add(lacking[place], measures),
    )
    for place, error in failures.items():
        error.add_note(f"{len(failures)} of {len(lacking)} settings failed, the first was {lacking[place].name}")
        raise error
    found = [(setting, kept.get(setting)) for setting in plan.settings]
    return [(setting, measures) for setting, measures in found if measures is not None]
