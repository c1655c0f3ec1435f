"""`Viewer`: an engine in a notebook. `view` makes one; anywidget carries its messages to `viewer.js`."""

from __future__ import annotations

import contextvars
import functools
from pathlib import Path
from typing import Any

from octomarch import _validate as check
from octomarch.camera import AnyCamera
from octomarch.image import Image
from octomarch.looks import Shown
from octomarch.march import March
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.viewer.engine import Engine
from octomarch.viewer.messages import Message
from octomarch.viewer.pace import Quality
from octomarch.viewer.picking import Pick
from octomarch.viewer.pictures import take, view_of

_HERE = Path(__file__).parent


def view(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (480, 360),
    *,
    march: March | None = None,
    shading: Shading | None = None,
    plane: Shown = "color",
    samples: int = 16,
) -> Viewer:
    """Look at a scene in a notebook, from all sides.

    Dragging orbits, the wheel zooms, dragging with shift pans, a double click tells what the ray of that pixel met;
    arrow keys, plus, minus and Home move the camera too. While it moves, pictures are as coarse as they must be to be
    quick; then they are refined, with shadows, ambient occlusion and many rays a pixel. Sliders change the march, and
    numbers beside them tell what that costs and how wrong the picture is.

    Needs the extra ``notebook``: anywidget.

    Parameters
    ----------
    scene, camera, size, march, shading
        As for `octomarch.render`.
    plane : {"color", "depth", "normal", "steps", "status", "error"}
        What is shown at first; ``"error"`` is how far the depth is from the truth.
    samples : int
        Rays per pixel of the finest picture, 1 to 64.

    Returns
    -------
    Viewer
        Which shows itself as the last value of a cell.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.
    SceneError
        If the shape cannot be compiled.
    ImportError
        If anywidget is not installed.

    Examples
    --------
    >>> import octomarch as om
    >>> viewer = om.view(om.sphere(1.0), size=(64, 48))
    >>> viewer.camera = om.Camera(eye=(0, 0, 3), target=(0, 0, 0))
    >>> viewer.image
    <Image 64×48: color, depth, normal, steps, status>
    """
    _widget_class()  # told before anything else
    return Viewer(scene, camera, size, march=march, shading=shading, plane=plane, samples=samples)


class Viewer:
    """A window on a scene, in a notebook; made by `octomarch.view`, which has the parameters.

    What is changed in the notebook is seen here, and the other way round.

    Examples
    --------
    >>> import octomarch as om
    >>> viewer = om.view(om.sphere(1.0), size=(64, 48))
    >>> viewer.scene = om.sphere(1.0) - om.box(1.2)
    >>> viewer.march = om.March(max_steps=64)
    >>> viewer
    <Viewer 64×48: color>
    """

    def __init__(
        self,
        scene: Shape | Scene,
        camera: AnyCamera | None = None,
        size: tuple[int, int] = (480, 360),
        *,
        march: March | None = None,
        shading: Shading | None = None,
        plane: Shown = "color",
        samples: int = 16,
    ) -> None:
        first = view_of(scene, camera, size, march, shading, plane)
        self._context = contextvars.copy_context()
        self._engine = Engine(first, check.integer("samples", samples, 1, 64), self._send)
        self._widget = _widget_class()()
        self._widget.on_msg(self._receive)

    @property
    def scene(self) -> Shape | Scene:
        """What is seen. Another is seen from where the last one was."""
        return self._engine.view.scene

    @scene.setter
    def scene(self, scene: Shape | Scene) -> None:
        self._engine.change(scene=scene)

    @property
    def camera(self) -> AnyCamera:
        """From where it is seen now. To set it to None frames the scene."""
        return self._engine.view.camera

    @camera.setter
    def camera(self, camera: AnyCamera | None) -> None:
        self._engine.change(camera=camera)

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        return self._engine.view.size

    @size.setter
    def size(self, size: tuple[int, int]) -> None:
        self._engine.change(size=size)

    @property
    def march(self) -> March:
        """How rays find the surface; the sliders change it."""
        return self._engine.view.march

    @march.setter
    def march(self, march: March | None) -> None:
        self._engine.change(march=march)

    @property
    def shading(self) -> Shading:
        """How surfaces are lit in refined pictures."""
        return self._engine.view.shading

    @shading.setter
    def shading(self, shading: Shading | None) -> None:
        self._engine.change(shading=shading)

    @property
    def plane(self) -> Shown:
        """What is shown: a plane, or the error of depth."""
        return self._engine.view.plane

    @plane.setter
    def plane(self, plane: Shown) -> None:
        self._engine.change(plane=plane)

    @property
    def image(self) -> Image:
        """The finest picture of what is seen now, with the planes color, depth, normal, steps and status.

        It is that of `octomarch.render`, bit for bit; rendered now, if the viewer has not come so far yet.
        """
        return self._engine.image()

    @property
    def picked(self) -> Pick | None:
        """What was met by the ray of the pixel that was clicked twice last; None before."""
        return self._engine.picked

    @property
    def widget(self) -> Any:
        """The widget itself, an ``ipywidgets.DOMWidget``, to be put into boxes beside others."""
        return self._widget

    def close(self) -> None:
        """Take the viewer out of the notebook and end its work."""
        self._engine.close()
        self._widget.close()

    def __repr__(self) -> str:
        width, height = self.size
        return f"<Viewer {width}×{height}: {self.plane}>"

    def _repr_mimebundle_(self, **_: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Show the widget, or, where widgets do not run, a picture."""
        found = self._widget._repr_mimebundle_() or {}
        data, metadata = found if isinstance(found, tuple) else (found, {})
        view = self._engine.view
        picture = take(view, Quality(), whole=True)
        shown = picture if view.plane == "error" else Image({view.plane: getattr(picture, view.plane)})
        self._widget.picture = png = shown._repr_png_()
        return {**data, "text/plain": repr(self), "image/png": png}, metadata

    def _receive(self, _: Any, message: Message, __: list[Any]) -> None:
        self._context = contextvars.copy_context()
        self._engine.receive(message)

    def _send(self, message: Message, data: bytes | None) -> None:
        # Kernels know by the context what they answer. Without it they would have the front end send what follows to
        # the thread that runs cells, and the viewer would stand still while one runs.
        self._context.run(self._widget.send, message, None if data is None else [data])


@functools.cache
def _widget_class() -> Any:
    """Return the class of widgets whose front end is ``viewer.js``."""
    try:
        import anywidget  # here, since few need it
        import traitlets
    except ImportError as error:
        raise ImportError("viewers need anywidget: pip install 'octomarch[notebook]'") from error

    class Widget(anywidget.AnyWidget):  # type: ignore[misc, unused-ignore]
        """What the notebook knows of a viewer."""

        _esm = _HERE / "viewer.js"
        _css = _HERE / "viewer.css"
        picture = traitlets.Bytes().tag(sync=True)  # shown until the kernel answers, or for ever where there is none

    return Widget
