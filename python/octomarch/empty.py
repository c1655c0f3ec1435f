"""Tells why a picture shows nothing, with what would help: `RenderWarning`.

`render` asks after each picture. What a picture has counted and computed anyway tells whether it may be empty, which
costs next to nothing; only where that is so, the status of rays over the picture is looked at.
"""

from __future__ import annotations

import dataclasses
import itertools
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octomarch.camera import AnyCamera, OrthographicCamera, PanoramicCamera, axes
from octomarch.march import March, Status
from octomarch.program import Program

Arrays = Mapping[str, NDArray[Any]]

_MOST = 0.5
"""Share of rays that makes a picture one of nothing else."""
_LOOKED_AT = 128
"""Pixels along the longer side of what is rendered to find the reason."""
_STEEP = 4.0
"""Lipschitz bound from which on it is worth mentioning."""
_PACKAGE = Path(__file__).parent
_expected = ContextVar("expected", default=False)


class RenderWarning(UserWarning):
    """A picture shows nothing, most likely by mistake. The message says why, and what to change.

    Examples
    --------
    >>> import octomarch as om, warnings
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     image = om.render(om.sphere(2.0), om.Camera(eye=(0, 0, 1), target=(0, 0, 0)), size=(64, 48))
    >>> print(str(caught[0].message)[:59])
    nothing to be seen: 100% of the rays begin inside the solid
    """


@dataclass(frozen=True)
class View:
    """What was rendered, with which settings, all of them resolved."""

    program: Program
    camera: AnyCamera
    size: tuple[int, int]
    march: March


def warn_if_empty(view: View, arrays: Arrays, stats: Mapping[str, Any], look: Callable[[View], NDArray[Any]]) -> None:
    """Warn if a whole picture shows nothing.

    Parameters
    ----------
    view : View
        What was rendered.
    arrays, stats
        What came of it.
    look : callable
        Renders the plane ``status`` of a view.

    Examples
    --------
    >>> import octomarch as om
    >>> ball, camera = om.compile(om.sphere(1.0)), om.Camera((0, 0, 4), (0, 0, 0))
    >>> view = View(ball, camera, (64, 48), om.March().resolve(ball, camera.eye))
    >>> stats = {"rays": 1, "stages": {"primary": {"evaluations": 1}}}
    >>> warn_if_empty(view, {"depth": np.ones((48, 64))}, stats, lambda view: None)
    """
    if _expected.get() or not _may_be_empty(view.march, arrays, stats):
        return
    status = arrays.get("status")
    reason = _reason(view, look(_reduced(view)) if status is None else status)
    if reason:
        warnings.warn(f"nothing to be seen: {reason}", RenderWarning, stacklevel=_level_of_user())


@contextmanager
def expected() -> Iterator[None]:
    """Keep silent about empty pictures: where settings are tried that may well give some.

    Examples
    --------
    >>> import octomarch as om
    >>> with expected():
    ...     image = om.render(om.sphere(2.0), om.Camera(eye=(0, 0, 1), target=(0, 0, 0)), size=(64, 48))
    """
    token = _expected.set(True)
    try:
        yield
    finally:
        _expected.reset(token)


def _may_be_empty(march: March, arrays: Arrays, stats: Mapping[str, Any]) -> bool:
    """Tell whether most rays may have spent their steps, or none may show a surface that it met on its way."""
    if stats["stages"]["primary"]["evaluations"] > _MOST * stats["rays"] * (march.max_steps or 0):
        return True
    if "status" in arrays:
        return not (arrays["status"] == Status.HIT).any()
    if "color" in arrays or "normal" in arrays:
        return bool(stats["stages"]["normals"]["evaluations"] == 0)
    if "depth" in arrays:
        depth = arrays["depth"]
        return not ((depth != np.inf) & (depth != march.min_distance)).any()
    for name in ("object_id", "material_id"):
        if name in arrays:
            return not (arrays[name] >= 0).any()
    return "position" in arrays and not arrays["position"].any()


def _reduced(view: View) -> View:
    """Return the view in so few pixels that it costs little, where rays end as they do in the many."""
    scale = min(1.0, _LOOKED_AT / max(view.size))
    width, height = (max(1, round(scale * pixels)) for pixels in view.size)
    march = dataclasses.replace(view.march, pixel_tolerance=view.march.pixel_tolerance * height / view.size[1])
    return View(view.program, view.camera, (width, height), march)


@np.errstate(over="ignore", invalid="ignore")  # scenes may lie at the ends of numbers
def _reason(view: View, status: NDArray[Any]) -> str | None:
    """Return why nothing is to be seen, and what would help; None where there is something."""
    shares = np.bincount(status.ravel(), minlength=len(Status)) / status.size
    for kind, explained in {Status.INSIDE: _inside, Status.STEP_LIMIT: _step_limit, Status.INVALID: _invalid}.items():
        if shares[kind] > _MOST:
            return f"{shares[kind]:.0%} of the rays {explained(view)}"
    return None if shares[Status.HIT] or shares[Status.STEP_LIMIT] else _missed(view)


def _inside(view: View) -> str:
    return (
        f"begin inside the solid (Status.INSIDE), about the eye {_point(view.camera.eye)}: move the camera's eye out "
        "of it, cut away what is in front, or begin behind that with om.March(min_distance=...)"
    )


def _step_limit(view: View) -> str:
    march = view.march
    hint = "give om.March a larger max_steps"
    if march.step is not None:
        hint += f", or a step longer than {march.step:.3g}"
    elif view.program.lipschitz > _STEEP:
        hint += f"; steps are short because the field's Lipschitz bound is {view.program.lipschitz:.3g}"
    return f"spent all of max_steps={march.max_steps} before they met a surface (Status.STEP_LIMIT): {hint}"


def _invalid(_: View) -> str:
    return (
        "met no number (Status.INVALID): the field is NaN there, as of the root of a negative number, or larger than "
        "numbers are; look at shape.distance(points) along the view"
    )


def _missed(view: View) -> str:
    lo, hi = (np.array(corner) for corner in view.program.bounds)
    origins, march = view.camera._ray_origins(view.size), view.march
    if (lo > hi).any():
        return "the shape is empty: nothing is left of what its operators cut away from each other"
    nearest = np.linalg.norm(np.maximum(0, np.maximum(lo - origins, origins - hi)), axis=1).min()
    farthest = np.linalg.norm(np.maximum(np.abs(lo - origins), np.abs(hi - origins)), axis=1).max()
    if march.max_distance is not None and nearest > march.max_distance:
        return (
            f"everything lies beyond max_distance={march.max_distance:.4g}: the nearest is {nearest:.4g} from the eye "
            f"{_point(view.camera.eye)}; give om.March a larger max_distance, or none, or move the camera nearer"
        )
    if farthest < march.min_distance:
        return (
            f"everything lies nearer than min_distance={march.min_distance:.4g}: the farthest is {farthest:.4g} from "
            f"the eye {_point(view.camera.eye)}; give om.March a smaller min_distance"
        )
    if np.isfinite([lo, hi]).all() and not _is_in_view(view, lo, hi):
        return (
            f"the camera looks past the scene, which lies about {_point((lo + hi) / 2)}: aim its target there, or "
            "render without a camera, which frames the scene"
        )
    return (
        "no ray meets a surface: it lies elsewhere than the camera looks, is thinner than the pixels are apart, or "
        "nothing is left of it; a render without a camera frames what there is"
    )


def _is_in_view(view: View, lo: NDArray[np.float64], hi: NDArray[np.float64]) -> bool:
    """Tell whether a box may be seen: whether no side of the picture has all its corners beyond it."""
    camera, (width, height) = view.camera, view.size
    if isinstance(camera, PanoramicCamera):
        return True
    corners = np.array(list(itertools.product(*zip(lo, hi, strict=True))))
    x, y, depth = np.stack(axes(camera)) @ (corners - camera.eye).T
    if isinstance(camera, OrthographicCamera):
        reach = np.full(len(corners), camera.height / 2)
    else:
        reach = np.tan(np.radians(camera.fov / 2)) * depth
    across = reach * width / height
    return not any(beyond.all() for beyond in (depth < 0, x > across, x < -across, y > reach, y < -reach))


def _point(point: Any) -> str:
    return f"({', '.join(f'{float(number):.4g}' for number in point)})"


def _level_of_user() -> int:
    """Return the stack level, seen from the caller, of who called the package."""
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and Path(frame.f_code.co_filename).is_relative_to(_PACKAGE):
        frame, level = frame.f_back, level + 1
    return level
