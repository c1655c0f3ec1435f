"""`Quality`: how finely a picture is rendered. `Pace` finds the finest that is quick enough while the hand moves.

`pictures` renders with a quality, `engine` tells a pace how long that took.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass


@dataclass(frozen=True)
class Quality:
    """How finely a picture is rendered.

    Examples
    --------
    >>> Quality(scale=3).size((480, 360))
    (160, 120)
    """

    scale: int = 1
    """Pixels of the window along the side of one that is rendered."""
    is_lit: bool = True
    """With shadows, ambient occlusion and reflections, as the shading says; else with none of them."""
    samples: int = 1
    """Rays per pixel."""

    def size(self, whole: tuple[int, int]) -> tuple[int, int]:
        """Return how large to render a picture for a window."""
        width, height = (max(1, -(-pixels // self.scale)) for pixels in whole)
        return width, height


COARSE = (Quality(), *(Quality(scale, is_lit=False) for scale in (1, 2, 3, 4, 6, 8, 12, 16)))
"""What there is to choose from while the hand moves, finest first."""

_RECENT = 3
"""Pictures of which the quickest counts: other work of the machine makes some slower."""
_LIGHT = 2.5
"""How much dearer shadows and occlusion are thought to make a picture before they have been tried."""
_FORGET = 60
"""Pictures without light after which it is tried again: the view may be another by then."""
_CERTAIN = 0.8
"""Part of the budget that a finer quality may be thought to take, lest it changes to and fro."""


class Pace:
    """Chooses among `COARSE`, by how long the last pictures took.

    Examples
    --------
    >>> pace = Pace(budget=0.02)
    >>> pace.quality.scale
    2
    >>> pace.took(0.09)  # seconds
    >>> pace.quality.scale
    6
    >>> pace.took(0.001)
    >>> pace.quality.scale
    2
    """

    def __init__(self, budget: float = 0.02) -> None:
        self.budget = budget
        """Seconds that a picture may take."""
        self.quality = COARSE[2]
        """What the next picture should be."""
        self._plain: deque[float] = deque(maxlen=_RECENT)  # seconds of a picture of scale 1, without light
        self._lit: deque[float] = deque(maxlen=_RECENT)  # and with it
        self._unlit_pictures = 0

    def took(self, seconds: float) -> None:
        """Tell how long a picture of this quality took."""
        (self._lit if self.quality.is_lit else self._plain).append(seconds * self.quality.scale**2)
        self._unlit_pictures = 0 if self.quality.is_lit else self._unlit_pictures + 1
        if self._unlit_pictures > _FORGET:
            self._lit.clear()
        now = COARSE.index(self.quality)
        for place, quality in enumerate(COARSE):
            if self._expected(quality) <= (self.budget * _CERTAIN if place < now else self.budget):
                break
        self.quality = quality

    def _expected(self, quality: Quality) -> float:
        """Return how many seconds a picture is thought to take."""
        if not quality.is_lit:
            return min(self._plain, default=0.0) / quality.scale**2
        return min(self._lit) if self._lit else _LIGHT * min(self._plain, default=0.0)
