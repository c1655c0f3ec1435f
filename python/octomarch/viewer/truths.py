"""How far pictures are from the truth, quickly enough to be seen while settings change.

The truth of a view does not depend on the settings that are tried, so it is found once. `Truth.grow` asks the scalar
reference, ray by ray, for as many pixels as time allows; `Truth.depths` has all pixels by the kernels in float64, for
pictures of the error. `study` is what measures thoroughly.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from octomarch import reference
from octomarch.empty import expected
from octomarch.image import Image
from octomarch.march import Status
from octomarch.render import render
from octomarch.study.errors import DepthErrors, depth_errors
from octomarch.study.truth import truth_march
from octomarch.viewer.pictures import ALWAYS, View, resolved
from octomarch.viewer.turns import Turn

SAMPLE = 400
"""Pixels that are asked for."""
LEAST = 40
"""Pixels that have to be known before errors are told."""
_STEPS = np.array([0.7548776662466927, 0.5698402909980532])  # Roberts' R2: any beginning of it is well spread


class Truth:
    """What is known of the depths of a view.

    Examples
    --------
    >>> import octomarch as om
    >>> from octomarch.viewer.pictures import take, view_of
    >>> from octomarch.viewer.pace import Quality
    >>> view = view_of(om.sphere(1.0), size=(64, 48))
    >>> truth = Truth(view)
    >>> truth.grow(Turn(), seconds=60)
    >>> errors = truth.errors(take(view, Quality()))
    >>> errors.p95 < 1e-5, errors.false_hits, errors.false_misses
    (True, 0, 0)
    """

    def __init__(self, view: View) -> None:
        self._view = view
        self._march = truth_march(resolved(view), view.extent)
        self._pixels = _spread(view.size)
        self._known: list[float] = []
        self._pictures: dict[tuple[int, int], NDArray[np.float64]] = {}

    def is_of(self, view: View) -> bool:
        """Tell whether it is the truth of that view too."""
        return view.scene is self._view.scene and _about(view) == _about(self._view)

    @property
    def is_complete(self) -> bool:
        """Whether all pixels of the sample are known."""
        return len(self._known) == len(self._pixels)

    def grow(self, turn: Turn, seconds: float) -> None:
        """Find the truth at further pixels until that much time has passed or the turn is late."""
        end = time.perf_counter() + seconds
        while not self.is_complete and time.perf_counter() < end and not turn.is_late:
            x, y = (int(i) for i in self._pixels[len(self._known)])
            view = self._view
            found = reference.render(
                view.scene, view.camera, view.size, self._march, planes=("depth", "status"), crop=(x, y, 1, 1)
            )
            self._known.append(float(_depths(found)[0, 0]))

    def errors(self, image: Image) -> DepthErrors | None:
        """Return what is wrong with the sampled pixels of a picture; None where not enough is known.

        The picture has to be as large as the view: pixels of a coarser one are elsewhere.
        """
        count = len(self._known)
        if image.size != self._view.size or count < min(LEAST, len(self._pixels)):
            return None
        x, y = self._pixels[:count].T
        limit = self._march.max_distance
        assert limit is not None
        return depth_errors(image.depth[y, x], image.status[y, x], np.array(self._known), limit)

    def depths(self, size: tuple[int, int], turn: Turn) -> NDArray[np.float64]:
        """Return the true depth of each pixel of a picture of any size: NaN where it is not known.

        Raises
        ------
        CancelledError
            If the turn is late.
        """
        if size not in self._pictures:
            view = self._view
            with expected():
                image = render(
                    view.scene,
                    view.camera,
                    size,
                    march=self._march,
                    planes=ALWAYS,
                    precision="float64",
                    progress=turn.progress(),
                )
            self._pictures[size] = _depths(image)
        return self._pictures[size]


def _about(view: View) -> tuple[object, ...]:
    """Return what the truth depends on beside the scene: neither how long steps are, nor where a ray has hit."""
    march = view.march
    limits = march.min_distance, march.max_distance, march.method == "fixed" and march.step
    return view.camera, view.size, limits


def _depths(image: Image) -> NDArray[np.float64]:
    return np.where(image.status <= Status.MISS, image.depth, np.nan)


def _spread(size: tuple[int, int]) -> NDArray[np.int64]:
    """Return distinct pixels (n, 2) in an order whose beginnings are spread evenly over the picture."""
    count = min(SAMPLE, size[0] * size[1])
    places = (0.5 + np.arange(1, 2 * count + 1)[:, None] * _STEPS) % 1.0
    pixels = (places * size).astype(np.int64)
    _, first = np.unique(pixels, axis=0, return_index=True)
    chosen: NDArray[np.int64] = pixels[np.sort(first)][:count]
    return chosen
