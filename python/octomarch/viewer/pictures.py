"""What is looked at, a `View`, and pictures of it, as fine as a `pace.Quality` says. `engine` asks for them."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from octomarch import _validate as check
from octomarch.camera import AnyCamera, or_framing
from octomarch.empty import expected
from octomarch.image import Image
from octomarch.looks import SHOWN, Shown
from octomarch.march import March
from octomarch.planes import PlaneName
from octomarch.program import compile
from octomarch.progress import Callback
from octomarch.render import _or_default, render
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.viewer.pace import Quality

ALWAYS: tuple[PlaneName, ...] = ("depth", "status")
"""Planes of every picture: its error is measured by them."""
WHOLE: tuple[PlaneName, ...] = ("color", "depth", "normal", "steps", "status")
"""Planes of refined pictures: another is shown without another render."""


@dataclass(frozen=True, eq=False)
class View:
    """What is looked at, from where, and how.

    Examples
    --------
    >>> import octomarch as om
    >>> view = view_of(om.sphere(1.0))
    >>> view.is_same_picture(dataclasses.replace(view, plane="depth"))
    True
    """

    scene: Shape | Scene
    camera: AnyCamera
    size: tuple[int, int]
    march: March
    shading: Shading
    plane: Shown

    def is_same_picture(self, other: View) -> bool:
        """Tell whether pictures of both have the same bits, whichever planes are shown of them."""
        own, others = ((v.camera, v.size, v.march, v.shading) for v in (self, other))
        return self.scene is other.scene and own == others

    @property
    def extent(self) -> float:
        """The scene's size, see `March`."""
        return compile(self.scene).size


def view_of(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (480, 360),
    march: March | None = None,
    shading: Shading | None = None,
    plane: Shown = "color",
) -> View:
    """Return a view, once its parts are found to be right; None stands for the default or, as a camera, the framing.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.
    SceneError
        If the shape cannot be compiled.
    """
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    whole = check.size(size)
    return View(
        scene,
        or_framing(camera, compile(scene), whole),
        whole,
        _or_default(March, "march", march),
        _or_default(Shading, "shading", shading),
        check.choice("plane", plane, SHOWN),
    )


def take(view: View, quality: Quality, progress: Callback | None = None, *, whole: bool = False) -> Image:
    """Take a picture of a view, with all of `WHOLE` or with as few planes as will do.

    Examples
    --------
    >>> import octomarch as om
    >>> take(view_of(om.sphere(1.0)), Quality(scale=4))
    <Image 120×90: color, depth, status>
    """
    plane: tuple[Any, ...] = () if view.plane == "error" else (view.plane,)
    shading = view.shading
    if not quality.is_lit:
        shading = dataclasses.replace(shading, shadows="none", occlusion=0, bounces=0)
    with expected():  # the numbers beside the picture tell how many rays have met nothing
        return render(
            view.scene,
            view.camera,
            quality.size(view.size),
            march=view.march,
            shading=shading,
            planes=WHOLE if whole else (*plane, *ALWAYS),
            samples=quality.samples,
            progress=progress,
        )


def resolved(view: View) -> March:
    """Return the march of a view with every None replaced by its number.

    Examples
    --------
    >>> import octomarch as om
    >>> resolved(view_of(om.sphere(1.0))).max_steps
    256
    """
    return view.march.resolve(compile(view.scene), view.camera._ray_origins(view.size))
