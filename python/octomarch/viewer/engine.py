"""`Engine`: what a viewer does, without a widget: it holds the view, takes what the hand does, and sends pictures.

Messages (see `messages`) come on any thread and are answered from one of its own (`turns`), so that whoever brings
them is free at once. While input comes, pictures are as coarse as they must be to be quick (`pace`). Once it has
ceased, they are refined step by step, until new input ends that. `widget` and `server` connect an engine to a front
end.
"""

from __future__ import annotations

import dataclasses
import math
import threading
from collections.abc import Callable
from typing import Any

from octomarch import _validate as check
from octomarch.image import Image
from octomarch.march import March
from octomarch.progress import CancelledError
from octomarch.viewer import messages, navigation
from octomarch.viewer.messages import Message
from octomarch.viewer.pace import Quality
from octomarch.viewer.painting import Painter
from octomarch.viewer.picking import Pick, pick
from octomarch.viewer.pictures import View, take, view_of
from octomarch.viewer.turns import Turn, Turns

Send = Callable[[Message, bytes | None], None]

_REACH = 1e-4, 1e4
"""Nearest and farthest zoom, of the scene's size."""
_SETTINGS = ("max_steps", "epsilon", "pixel_tolerance")


class Engine:
    """Shows a view to a front end, which may change it.

    Parameters
    ----------
    view : View
        What to show first.
    samples : int
        Rays per pixel of the finest picture.
    send : callable
        Brings a message and the bytes that belong to it to the front end; called on several threads, one at a time.

    Examples
    --------
    >>> import octomarch as om
    >>> engine = Engine(view_of(om.sphere(1.0), size=(64, 48)), 4, lambda message, data: None)
    >>> engine.receive({"kind": "input", "number": 1, "orbit": [0.1, 0.0]})
    >>> engine.image()
    <Image 64×48: color, depth, normal, steps, status>
    >>> engine.close()
    """

    def __init__(self, view: View, samples: int, send: Send) -> None:
        self._view, self._home = view, view.camera
        self._samples, self._painter = samples, Painter(samples)
        self._deliver = send
        self._lock = threading.RLock()
        self._sending = threading.Lock()
        self._turns = Turns(self._turn)
        self._is_watched = self._is_new = False
        self._answers: dict[str, int] = {}
        self._clicks: list[tuple[int, int]] = []
        self._picked: Pick | None = None
        self._finest: tuple[View, Image] | None = None

    @property
    def view(self) -> View:
        """What is shown."""
        return self._view

    @property
    def picked(self) -> Pick | None:
        """What the ray of the last pixel that was picked met."""
        return self._picked

    def change(self, **parts: Any) -> None:
        """Show something else from now on; `parts` are arguments of `view_of`.

        Raises
        ------
        TypeError, ValueError, SceneError
            As `view_of` does; then nothing has changed.
        """
        with self._lock:
            fields = {field.name: getattr(self._view, field.name) for field in dataclasses.fields(View)}
            self._view = view_of(**{**fields, **parts})
            if "camera" in parts:
                self._home = self._view.camera
            is_watched = self._is_watched
        if is_watched:
            self._send(messages.state(self._view))
            self._turns.ask()

    def image(self) -> Image:
        """Return the finest picture of what is shown; it is rendered where that has not been done yet."""
        with self._lock:
            view, finest = self._view, self._finest
        if finest is not None and finest[0].is_same_picture(view):
            return finest[1]
        image = take(view, Quality(samples=self._samples), whole=True)
        self._finest = view, image
        return image

    def receive(self, message: Message) -> None:
        """Take a message from the front end, and return at once; a bad one is answered with an error."""
        try:
            if message.get("kind") == "hello":
                with self._lock:
                    self._is_watched = self._is_new = True
                self._send(messages.state(self._view))
            else:
                with self._lock:
                    self._take_input(message)
            self._turns.ask()
        except (TypeError, ValueError) as error:
            self.fail(error)

    def fail(self, error: Exception) -> None:
        """Tell the front end of something that went wrong elsewhere."""
        self._send({**messages.error_message(error), "answers": dict(self._answers)})

    def close(self) -> None:
        """End all work."""
        self._turns.close()

    def _take_input(self, message: Message) -> None:
        """Change the view by what the hand has done."""
        client, number = check.text("client", message.get("client")), check.integer("number", message.get("number"), 0)
        self._answers[client] = number
        view, reach = self._view, self._view.extent
        camera = self._home if message.get("home") else view.camera
        if "orbit" in message:
            camera = navigation.orbit(camera, *check.pair("orbit", message["orbit"]))
        if "pan" in message:
            camera = navigation.pan(camera, *check.pair("pan", message["pan"]))
        if "zoom" in message:
            factor = check.positive("zoom", message["zoom"])
            camera = navigation.zoom(camera, factor, *(limit * reach for limit in _REACH))
        march = view.march
        if "march" in message:
            march = _changed(march, message["march"])
        plane = message.get("plane", view.plane)
        if camera != view.camera or march != view.march or plane != view.plane:
            self._view = view_of(view.scene, camera, view.size, march, view.shading, plane)
        if "march" in message and message["march"] is None:
            self._send(messages.state(self._view))  # back to the defaults, which the sliders have to show
        if "pick" in message:
            self._clicks.append(_pixel(view.size, *check.pair("pick", message["pick"])))

    def _turn(self, turn: Turn) -> None:
        """Answer all that has come; on the thread that renders."""
        with self._lock:
            view, answers, clicks = self._view, dict(self._answers), self._clicks
            self._clicks = []
            if self._is_new:
                self._painter.forget()
            self._is_new = False

        def tell(message: Message, data: bytes | None = None) -> None:
            self._send({**message, "answers": answers}, data)

        try:
            for pixel in clicks:
                self._picked = pick(view, *pixel)
                tell(messages.picked_message(self._picked))
            image = self._painter.paint(view, turn, tell)
            if image is not None and view.plane == "color":
                self._finest = view, image
        except CancelledError:
            raise
        except Exception as error:  # whatever it is, the viewer goes on with the next view
            tell(messages.error_message(error))

    def _send(self, message: Message, data: bytes | None = None) -> None:
        with self._sending:
            self._deliver(message, data)


def _changed(march: March, settings: object) -> March:
    """Return a march with some settings changed; None stands for all defaults."""
    if settings is None:
        settings = {name: getattr(March(), name) for name in _SETTINGS}
    if not isinstance(settings, dict):
        raise TypeError(f"march must be settings by name, got {check.shown(settings)}")
    return dataclasses.replace(march, **{check.choice("march", name, _SETTINGS): settings[name] for name in settings})


def _pixel(size: tuple[int, int], across: float, down: float) -> tuple[int, int]:
    """Return the pixel at shares of the width and the height."""
    x, y = (min(max(math.floor(share * n), 0), n - 1) for share, n in zip((across, down), size, strict=True))
    return x, y
