"""How far a picture is from the truth: depth, normals, and rays that end as they should not.

`truth` comes before it, `measure` and `search` after it. A percentile counts every ray that meets a surface in the
picture or in truth; one that does so in only one of them is infinitely wrong, so that no setting looks exact by losing
the rays that are hard.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from octomarch.march import Status

Reals = NDArray[np.floating]
_PERCENTILES = (50, 95, 99)


@dataclass(frozen=True)
class DepthErrors:
    """What is wrong with a depth plane.

    Examples
    --------
    >>> import numpy as np
    >>> depth, status = np.array([1.0, 2.5, np.inf, 4.0]), np.array([0, 0, 1, 0])
    >>> found = depth_errors(depth, status, np.array([1.0, 2.0, 3.0, np.inf]))
    >>> found.rays, found.p50, found.false_hits, found.false_misses
    (4, 0.5, 1, 1)
    """

    rays: int
    """That meet a surface in the picture or in truth."""
    p50: float
    """Error of depth in scene units that half of these rays do not exceed; +inf where one of the two has no depth."""
    p95: float
    p99: float
    false_hits: int
    """Rays that hit where nothing is."""
    false_misses: int
    """Rays that miss a surface that is nearer than the far limit."""
    cut: int
    """Rays that miss a surface since it lies beyond the far limit; no error of depth is counted for them."""


def depth_errors(
    depth: Reals, status: NDArray[np.integer], truth: Reals, max_distance: float = math.inf
) -> DepthErrors:
    """Compare a depth plane with the truth: +inf where nothing is, NaN where it is not known.

    Examples
    --------
    >>> import numpy as np
    >>> depth_errors(np.array([np.inf]), np.array([1]), np.array([70.0]), max_distance=60.0).cut
    1
    """
    errors = ray_errors(depth, truth, max_distance)
    surface, nothing = np.isfinite(truth), truth == np.inf
    beyond = surface & (truth > max_distance)
    missed = surface & (status == Status.MISS)
    p50, p95, p99 = percentiles(errors)
    return DepthErrors(
        rays=int(np.count_nonzero(~np.isnan(errors))),
        p50=p50,
        p95=p95,
        p99=p99,
        false_hits=int(np.count_nonzero(nothing & (status == Status.HIT))),
        false_misses=int(np.count_nonzero(missed & ~beyond)),
        cut=int(np.count_nonzero(missed & beyond)),
    )


def ray_errors(depth: Reals, truth: Reals, max_distance: float = math.inf) -> NDArray[np.float64]:
    """Return the error of each ray's depth; NaN where neither has a surface, the truth is not known, or cut off.

    Examples
    --------
    >>> import numpy as np
    >>> ray_errors(np.array([1.0, np.inf, np.inf, 5.0]), np.array([1.5, 2.0, np.inf, np.nan])).tolist()
    [0.5, inf, nan, nan]
    """
    seen = np.isfinite(depth)
    with np.errstate(invalid="ignore"):  # infinite less infinite: no number, as it should be
        errors = np.abs(depth.astype(np.float64) - truth)
    cut = ~seen & np.isfinite(truth) & (truth > max_distance)
    return np.where(cut, np.nan, errors)


def percentiles(errors: Reals) -> tuple[float, ...]:
    """Return p50, p95 and p99 of what is no NaN: each an error that occurs, 0 where there is none.

    Examples
    --------
    >>> import numpy as np
    >>> percentiles(np.array([np.nan, *range(1, 101)]))
    (50.0, 95.0, 99.0)
    """
    known = errors[~np.isnan(errors)]
    if not known.size:
        return 0.0, 0.0, 0.0
    return tuple(float(p) for p in np.percentile(known, _PERCENTILES, method="inverted_cdf"))


def normal_angles(normal: Reals, truth: Reals) -> NDArray[np.float64]:
    """Return the angles between normals in degrees; NaN where one of them is 0 or not known.

    Examples
    --------
    >>> import numpy as np
    >>> normal_angles(np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]] * 2)).tolist()
    [90.0, nan]
    """
    a, b = normal.astype(np.float64), truth.astype(np.float64)
    # the arc cosine of a dot product would lose all angles below 1e-6 degrees
    across, along = np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1)
    known = a.any(axis=-1) & b.any(axis=-1)
    return np.where(known, np.degrees(np.arctan2(across, along)), np.nan)


def status_counts(status: NDArray[np.integer]) -> dict[str, int]:
    """Return how many rays ended in each way.

    Examples
    --------
    >>> import numpy as np
    >>> status_counts(np.array([0, 0, 1]))
    {'hit': 2, 'miss': 1, 'step_limit': 0, 'inside': 0, 'invalid': 0}
    """
    return {name.name.lower(): int(np.count_nonzero(status == name)) for name in Status}
