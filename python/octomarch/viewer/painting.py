"""`Painter`: pictures of a view, one after the other: a quick one, then finer ones, and how wrong they are.

`engine` has it paint on a thread of its own. What it tells are messages, each with the bytes that belong to it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from octomarch.image import Image
from octomarch.looks import legend, look
from octomarch.study.errors import ray_errors
from octomarch.viewer import messages
from octomarch.viewer.messages import Frame, Message
from octomarch.viewer.pace import Pace, Quality
from octomarch.viewer.pictures import WHOLE, View, take
from octomarch.viewer.truths import Truth
from octomarch.viewer.turns import Turn

Tell = Callable[[Message, bytes | None], None]

_IDLE = 0.15
"""Seconds without input after which refinement begins; between two events of a drag less passes."""
_TRUTH, _TRUTH_AT_REST = 0.5, 3.0
"""Seconds that finding the truth may take between two pictures, and after the last one."""


@dataclass(frozen=True, eq=False)
class _Shown:
    """What was told last."""

    view: View
    image: Image
    quality: Quality

    @property
    def is_whole(self) -> bool:
        """Whether any plane may be shown of it."""
        return set(WHOLE) <= set(self.image.planes)


class Painter:
    """Paints views, the last of which it remembers.

    Parameters
    ----------
    samples : int
        Rays per pixel of the finest picture.

    Examples
    --------
    >>> import octomarch as om
    >>> from octomarch.viewer.pictures import view_of
    >>> painter, told = Painter(samples=4), []
    >>> image = painter.paint(view_of(om.sphere(1.0)), Turn(), lambda message, data: told.append(message))
    >>> [message["samples"] for message in told if message["kind"] == "frame"]
    [1, 1, 4]
    """

    def __init__(self, samples: int) -> None:
        self._samples = samples
        self._pace = Pace()
        self._shown: _Shown | None = None
        self._truth: Truth | None = None

    def forget(self) -> None:
        """Begin anew with the next view, even if it is the last one."""
        self._shown = None

    def paint(self, view: View, turn: Turn, tell: Tell) -> Image | None:
        """Tell a quick picture, unless the view is the last one, and finer ones; return the finest, if there was one.

        Raises
        ------
        CancelledError
            If the turn has become late.
        """
        if self._shown is None or self._shown.view is not view:
            self._paint_quickly(view, turn, tell)
        else:
            tell({"kind": "done"}, None)
        left = self._left()
        if left:
            turn.pause(_IDLE)
        for quality in left:
            image = take(view, quality, turn.progress(), whole=True)
            self._tell_frame(_Shown(view, image, quality), turn, tell)
            self._measure(turn, tell)
        return image if left else None

    def _paint_quickly(self, view: View, turn: Turn, tell: Tell) -> None:
        last = self._shown
        if last is not None and last.is_whole and last.view.is_same_picture(view):  # only the plane is another
            self._tell_frame(_Shown(view, last.image, last.quality), turn, tell)
            return
        begin, quality = time.perf_counter(), self._pace.quality
        self._tell_frame(_Shown(view, take(view, quality), quality), turn, tell)
        self._pace.took(time.perf_counter() - begin)

    def _left(self) -> list[Quality]:
        """Return the qualities of the finer pictures that are still to come."""
        shown = self._shown
        assert shown is not None
        steps = {1, min(4, self._samples), self._samples} if shown.view.plane == "color" else {1}
        least = shown.quality.samples if shown.is_whole or (shown.quality == Quality() and max(steps) > 1) else 0
        return [Quality(samples=count) for count in sorted(steps) if count > least]

    def _tell_frame(self, shown: _Shown, turn: Turn, tell: Tell) -> None:
        view, image = shown.view, shown.image
        wrong = None
        if view.plane == "error":
            wrong = ray_errors(image.depth, self._truth_of(view).depths(image.size, turn))
        self._shown = shown
        frame = Frame(
            image=image,
            view=view,
            quality=shown.quality,
            shown=look(image, view.plane, wrong, view.extent),
            legend=legend(image, view.plane, view.extent),
            errors=self._truth.errors(image) if self._truth is not None and self._truth.is_of(view) else None,
            is_last=not self._left(),
        )
        tell(*messages.frame_message(frame))

    def _measure(self, turn: Turn, tell: Tell) -> None:
        """Find the truth, if it is not known well enough yet, and tell how wrong the last picture is."""
        shown = self._shown
        assert shown is not None
        truth = self._truth_of(shown.view)
        if not truth.is_complete:
            truth.grow(turn, _TRUTH if self._left() else _TRUTH_AT_REST)
            turn.pause()
            tell({"kind": "errors", "errors": messages.errors(truth.errors(shown.image))}, None)

    def _truth_of(self, view: View) -> Truth:
        if self._truth is None or not self._truth.is_of(view):
            self._truth = Truth(view)
        return self._truth
