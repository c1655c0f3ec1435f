"""Which settings a study measures: one after the other varied about a base, and some combined.

`measure` renders them. Lengths follow from the scene's size, so that a sweep suits any scene.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from octomarch._validate import Precision
from octomarch.camera import AnyCamera
from octomarch.march import March, _is_certifiable
from octomarch.program import Program
from octomarch.shading import Shading

GROUPS = (
    "base",
    "series",
    "method",
    "epsilon",
    "pixel_tolerance",
    "step",
    "finish",
    "prepass",
    "combined",
    "precision",
    "normals",
    "shadows",
    "occlusion",
)
"""What is varied; ``step`` only where steps are fixed, which leaves nothing to vary of methods and hit epsilons."""

SERIES = (32, 64, 128, 256, 512)
"""Steps of the classic series, without and with a far limit."""

_EPSILONS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)  # of the scene's size
_TOLERANCES = (4.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
_STEPS = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4)  # of the scene's size
_SHADOW_SHARPNESS = (2.0, 8.0, 32.0, 128.0)
_OCCLUSION = (0, 3, 5, 8, 16)
_NORMAL_STEPS = (1e-2, 1e-3, 1e-4)  # of the scene's size
_FOCUS_MISSING = 10.0  # sizes of the scene from the eye to the far limit where nothing is bounded


@dataclass(frozen=True)
class Setting:
    """What one row of a study is about.

    Examples
    --------
    >>> Setting("base", "as given", March(), Shading(), "float32").march.method
    'auto'
    """

    group: str
    name: str
    march: March
    shading: Shading
    precision: Precision

    @property
    def key(self) -> str:
        """All that the picture depends on, as text: settings of the same key are measured once."""
        return json.dumps([asdict(self.march), asdict(self.shading), self.precision])


def sweep(base: Setting, program: Program, far: float, groups: Sequence[str] = GROUPS) -> list[Setting]:
    """Return the settings to measure, the base first.

    Examples
    --------
    >>> import octomarch as om
    >>> base = Setting("base", "as given", March(), Shading(), "float32")
    >>> found = sweep(base, om.compile(om.sphere(1.0)), far=8.0, groups=("series",))
    >>> len(found), found[1].name, found[-1].name
    (11, '32 steps', '512 steps, to 8')
    """
    fixed = program.is_solid or base.march.method == "fixed"
    makers = {
        "series": _series,
        "precision": _precision,
        "normals": _normals,
        "shadows": _shadows,
        "occlusion": _occlusion,
        "finish": _finish,
    }
    makers |= {"step": _steps} if fixed else _DISTANCES
    found = [base]
    for group in GROUPS:
        if group in groups and group in makers:
            found += [replace(setting, group=group) for setting in makers[group](base, program.size, far)]
    if _is_certifiable(program):
        return found
    return [setting for setting in found if setting.march.method != "certified"]


def far_limit(program: Program, camera: AnyCamera, size: tuple[int, int], reach: float) -> float:
    """Return how far rays have to go to pass all that is bounded; `reach` at the most.

    Examples
    --------
    >>> import octomarch as om
    >>> floor = om.sphere(1.0) | om.plane(point=(0, -1, 0))
    >>> camera = om.Camera((0, 0, 3), (0, 0, 0))
    >>> round(far_limit(om.compile(floor), camera, (64, 48), 1e4), 2)
    4.25
    """
    origins = camera._ray_origins(size)
    if program.focus is None:
        return float(min(_FOCUS_MISSING * program.size, reach))
    lo, hi = (np.array(corner) for corner in program.focus)
    farthest = np.linalg.norm(np.maximum(np.abs(origins - lo), np.abs(origins - hi)), axis=1).max()
    return float(min(1.001 * farthest, reach))


def changed(march: March, **changes: Any) -> March:
    """Return other settings; a step goes where steps are no longer fixed.

    Examples
    --------
    >>> changed(March("fixed", step=0.1), method="plain").step is None
    True
    """
    if changes.get("method", march.method) != "fixed":
        changes["step"] = None
    return replace(march, **changes)


def _marches(base: Setting, **named: dict[str, Any]) -> Iterator[Setting]:
    for name, changes in named.items():
        yield replace(base, name=name, march=changed(base.march, **changes))


def _series(base: Setting, _size: float, far: float) -> Iterator[Setting]:
    method = {} if base.march.method == "fixed" else {"method": "plain"}
    for limit in ({}, {"max_distance": far}):
        to = f", to {far:.3g}" if limit else ""
        yield from _marches(base, **{f"{n} steps{to}": {**method, "max_steps": n, **limit} for n in SERIES})


def _methods(base: Setting, size: float, far: float) -> Iterator[Setting]:
    methods = ("auto", "plain", "relaxed", "enhanced", "certified")
    yield from _marches(base, **{method: {"method": method} for method in methods})
    fixed = {"method": "fixed", "step": 1e-2 * size, "max_distance": far, "max_steps": None}
    yield from _marches(base, **{f"fixed, step {1e-2 * size:.1g}, to {far:.3g}": fixed})


def _epsilons(base: Setting, size: float, _far: float) -> Iterator[Setting]:
    values = [factor * size for factor in _EPSILONS]
    yield from _marches(base, **{f"{value:.1e}": {"epsilon": value, "pixel_tolerance": 0.0} for value in values})


def _tolerances(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    yield from _marches(base, **{f"{value:g} pixels": {"pixel_tolerance": value} for value in _TOLERANCES})


def _steps(base: Setting, size: float, _far: float) -> Iterator[Setting]:
    for value in (factor * size for factor in _STEPS):
        march = replace(base.march, method="fixed", step=value, max_steps=None)
        yield replace(base, name=f"{value:.1e}", march=march)


def _finish(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    yield from _marches(base, secant={"finish": "secant"}, none={"finish": None})


def _prepass(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    yield from _marches(base, cones={"method": "auto"}, none={"method": "enhanced"})


def _combined(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    for method in ("auto", "plain"):
        for finish in ("secant", None):
            for tolerance in (4.0, 1.0, 0.1, 0.01):
                for steps in (64, 1024):
                    name = f"{method}, {finish or 'no finish'}, {tolerance:g} pixels, {steps} steps"
                    changes = {"method": method, "finish": finish, "pixel_tolerance": tolerance, "max_steps": steps}
                    yield from _marches(base, **{name: changes})


def _precision(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    precisions: tuple[Precision, ...] = ("float32", "float64")
    for precision in precisions:
        yield replace(base, name=precision, precision=precision)


def _normals(base: Setting, size: float, _far: float) -> Iterator[Setting]:
    yield replace(base, name="exact", shading=replace(base.shading, normals="exact"))
    for kind in ("central", "tetrahedron"):
        for step in (factor * size for factor in _NORMAL_STEPS):
            shading = replace(base.shading, normals=kind, normal_step=step)
            yield replace(base, name=f"{kind}, step {step:.1e}", shading=shading)


def _shadows(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    for shadows in ("none", "hard"):
        yield replace(base, name=shadows, shading=replace(base.shading, shadows=shadows))
    for k in _SHADOW_SHARPNESS:
        yield replace(base, name=f"soft, k {k:g}", shading=replace(base.shading, shadows="soft", shadow_k=k))


def _occlusion(base: Setting, _size: float, _far: float) -> Iterator[Setting]:
    for samples in _OCCLUSION:
        yield replace(base, name=f"{samples} samples", shading=replace(base.shading, occlusion=samples))


_DISTANCES = {
    "method": _methods,
    "epsilon": _epsilons,
    "pixel_tolerance": _tolerances,
    "prepass": _prepass,
    "combined": _combined,
}
