"""`Scene`: a shape together with what lights it. `render` takes it, with a camera, to make a picture."""

from __future__ import annotations

import functools
import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import ColorLike, Vec3
from octomarch.lights import DirectionalLight, Light, PointLight, SpotLight
from octomarch.shapes import Shape
from octomarch.skies import AnySky, ConstantSky, Sky

if TYPE_CHECKING:
    from octomarch.camera import AnyCamera
    from octomarch.march import March
    from octomarch.shading import Shading


@dataclass(frozen=True, init=False)
class Scene:
    """What a picture is of.

    Parameters
    ----------
    shape : Shape
        All that can be seen; its paints are its materials.
    sky : Sky, ConstantSky, GradientSky, EnvironmentMap or CustomSky, optional
        Seen by rays that hit nothing; None for ``Sky()``.
    ambient : float or sequence of three floats
        Light from all sides, linear RGB ≥ 0, dimmed by ambient occlusion; one number means grey.
    lights : iterable of DirectionalLight, PointLight or SpotLight
        Kept as a tuple. Each costs a shadow ray for each point that it may reach.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> sun = om.DirectionalLight(direction=(-1, -2, -1))
    >>> scene = om.Scene(om.sphere(1.0), ambient=0.2, lights=[sun])
    >>> scene.ambient, len(scene.lights)
    ((0.2, 0.2, 0.2), 1)
    """

    shape: Shape
    sky: AnySky
    ambient: Vec3
    lights: tuple[Light, ...]

    def __init__(
        self, shape: Shape, sky: AnySky | None = None, ambient: ColorLike = 0.1, lights: Iterable[Light] = ()
    ) -> None:
        if not isinstance(shape, Shape):
            raise TypeError(f"shape must be an om.Shape, got {check.shown(shape)}")
        sky = Sky() if sky is None else sky
        if not isinstance(sky, AnySky):
            raise TypeError(f"sky must be a sky such as om.Sky, got {check.shown(sky)}")
        sources = check.sequence("lights", lights, "a sequence of lights")
        for light in sources:
            if not isinstance(light, (DirectionalLight, PointLight, SpotLight)):
                raise TypeError(f"lights must be lights such as om.PointLight, got {check.shown(light)}")
        check.set_fields(self, shape=shape, sky=sky, ambient=check.color("ambient", ambient), lights=tuple(sources))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save as a scene file, for `octomarch.load` and the command ``octomarch render``.

        JSON that says all that the scene is made of, bit for bit, each part once; it appears whole or not at all. To
        keep a camera and settings along with it, save a `Shot`.

        Parameters
        ----------
        path : str or path-like
            Ends in ``.json``; a file that is there is replaced.

        Raises
        ------
        ValueError
            If the suffix is another.
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> import octomarch as om, pathlib, tempfile
        >>> scene = om.Scene(om.sphere(1.0), lights=[om.PointLight((2, 5, 2), 30)])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "scene.json")
        ...     scene.save(path)
        ...     om.load(path).lights == scene.lights
        True
        """
        from octomarch.scenefile import write  # here, since scenefile builds on this module

        write(path, self)

    def _repr_png_(self) -> bytes | None:
        """Show a small picture in notebooks, framed by default."""
        from octomarch.render import render  # here, since rendering builds on this module

        return render(self, size=(480, 360))._repr_png_()

    def glsl(
        self,
        camera: AnyCamera | None = None,
        *,
        march: March | None = None,
        shading: Shading | None = None,
        size: tuple[int, int] = (640, 480),
    ) -> str:
        """Return a picture of the scene as a fragment shader, in the manner of ShaderToy.

        GLSL ES 3.00 for WebGL 2, as browsers run it, with the function ``mainImage(out vec4 color, in vec2 pixel)``. It
        needs ``iResolution`` and nothing else. Each node of the shape is a line with a name. Materials, lights,
        shadows, occlusion, the sky and reflections are those of `octomarch.render`, and so is the picture, up to
        roundings: hits may lie elsewhere within the hit tolerance, and exact normals become differences.

        Parameters
        ----------
        camera, march, shading
            As for `octomarch.render`. Any method but ``"certified"``.
        size : (int, int)
            Width and height of the picture for which a camera is found where none is given.

        Returns
        -------
        str

        Raises
        ------
        TypeError, ValueError
            If an argument is of a wrong type or outside its range.
        SceneError
            If something cannot be part of a shader, which is told: images of more than 4096 texels together, grids, a
            shape of more than 2048 nodes.

        Examples
        --------
        >>> import octomarch as om
        >>> scene = om.Scene(om.sphere(1.0), lights=[om.PointLight((2, 5, 2), 30)])
        >>> shader = scene.glsl(om.Camera((0, 0, 4), (0, 0, 0)))
        >>> "color += point_light(vec3(2.0, 5.0, 2.0), vec3(30.0), 2, o, n, d, m);" in shader
        True
        """
        from octomarch.glsl import shader  # here, since it builds on this module

        return shader(self, camera, size, march, shading)

    def _native(self) -> _core.Scene:
        return _core.Scene([light._native() for light in self.lights], self.sky._native(), self.ambient)


@functools.cache
def unlit() -> _core.Scene:
    """Return what stands for lights and sky where no colour is asked for; theirs take as long as a small picture."""
    return _core.Scene([], ConstantSky(0)._native(), (0.0, 0.0, 0.0))
