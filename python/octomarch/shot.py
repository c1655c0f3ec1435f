"""`Shot`: a scene together with how its picture is taken. `render` does it, `scenefile` keeps it in files."""

from __future__ import annotations

import dataclasses
import os
import typing
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from octomarch import _validate as check
from octomarch._spelling import hint
from octomarch._validate import Precision
from octomarch.camera import AnyCamera
from octomarch.image import Image
from octomarch.march import March
from octomarch.planes import PLANES, PlaneName
from octomarch.progress import Callback
from octomarch.render import render
from octomarch.scene import Scene
from octomarch.shading import Shading


@dataclass(frozen=True, init=False)
class Shot:
    """A scene, the camera that takes its picture, and the settings: all that the picture's bits depend on.

    Parameters
    ----------
    scene : Scene
        What the picture is of.
    camera, size, march, shading, planes, precision, samples, crop
        As for `octomarch.render`.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> shot = om.Shot(om.Scene(om.sphere(1.0)), om.Camera((0, 0, 4), (0, 0, 0)), size=(64, 48))
    >>> shot.render()
    <Image 64×48: color>
    """

    scene: Scene
    camera: AnyCamera | None
    size: tuple[int, int]
    march: March | None
    shading: Shading | None
    planes: tuple[PlaneName, ...]
    precision: Precision
    samples: int
    crop: tuple[int, int, int, int] | None

    def __init__(
        self,
        scene: Scene,
        camera: AnyCamera | None = None,
        size: tuple[int, int] = (640, 480),
        *,
        march: March | None = None,
        shading: Shading | None = None,
        planes: PlaneName | Sequence[PlaneName] | Sequence[str] = ("color",),
        precision: Precision = "float32",
        samples: int = 1,
        crop: Sequence[int] | None = None,
    ) -> None:
        whole = check.size(size)
        check.set_fields(
            self,
            scene=_of("scene", scene, Scene),
            camera=None if camera is None else _of("camera", camera, *typing.get_args(AnyCamera)),
            size=whole,
            march=None if march is None else _of("march", march, March),
            shading=None if shading is None else _of("shading", shading, Shading),
            planes=tuple(check.planes(planes, tuple(PLANES))),
            precision=check.precision(precision),
            samples=check.integer("samples", samples, 1, 64),
            crop=None if crop is None else check.crop(crop, whole),
        )

    def render(
        self,
        *,
        threads: int | None = None,
        isa: str | None = None,
        progress: bool | Callback | None = None,
        **changes: Any,
    ) -> Image:
        """Take the picture; see `octomarch.render`.

        Parameters
        ----------
        threads, isa, progress
            As for `octomarch.render`.
        **changes
            Fields of the shot that are to be others, such as ``size=(320, 240)``.

        Returns
        -------
        Image

        Raises
        ------
        TypeError, ValueError, SceneError
            As `octomarch.render` does.

        Examples
        --------
        >>> import octomarch as om
        >>> shot = om.Shot(om.Scene(om.sphere(1.0)), size=(640, 480))
        >>> shot.render(size=(64, 48), planes=("depth",))
        <Image 64×48: depth>
        """
        names = [field.name for field in dataclasses.fields(self)]
        for name in changes:
            if name not in names:
                told = f"Shot.render() got an unexpected keyword argument {name!r}"
                raise TypeError(told + hint(name, [*names, "threads", "isa", "progress"]))
        shot = dataclasses.replace(self, **changes)
        settings = {field.name: getattr(shot, field.name) for field in dataclasses.fields(shot)}
        return render(**settings, threads=threads, isa=isa, progress=progress)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save the shot as a scene file; see `Scene.save`.

        Examples
        --------
        >>> import octomarch as om, pathlib, tempfile
        >>> shot = om.Shot(om.Scene(om.sphere(1.0)), size=(64, 48), march=om.March(max_steps=64))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "shot.json")
        ...     shot.save(path)
        ...     om.Shot.load(path) == shot
        True
        """
        from octomarch.scenefile import write  # here, since scenefile builds on this module

        write(path, self)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Shot:
        """Load what `save` wrote, or how a saved picture was made; see `octomarch.load`.

        Returns
        -------
        Shot
            Of a file that holds a scene alone, with the defaults of all settings.

        Raises
        ------
        ValueError, OSError
            As `octomarch.load` does.

        Examples
        --------
        >>> import octomarch as om, pathlib, tempfile
        >>> image = om.render(om.sphere(1.0), size=(32, 24), samples=4)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "ball.exr")
        ...     image.save(path)
        ...     again = om.Shot.load(path).render()
        >>> bool((again.color == image.color).all())
        True
        """
        from octomarch.scenefile import read  # here, since scenefile builds on this module

        value = read(path)
        return value if isinstance(value, Shot) else cls(value)


def _of(name: str, value: object, *kinds: type[Any]) -> Any:
    if not isinstance(value, kinds):
        raise TypeError(
            f"{name} must be {' or '.join(f'om.{kind.__name__}' for kind in kinds)}, got {check.shown(value)}"
        )
    return value
