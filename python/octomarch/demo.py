"""The two demo scenes, used by ``octomarch demo`` and by whoever wants something to render.

``blend`` shows what one sphere and one box make under each operator; ``building`` is a tower of floors and columns
cut from one box.
"""

from __future__ import annotations

from collections.abc import Callable

from octomarch.camera import Camera
from octomarch.lights import DirectionalLight, PointLight
from octomarch.march import March
from octomarch.materials import Material
from octomarch.primitives import box, cylinder, plane, sphere
from octomarch.scene import Scene
from octomarch.shapes import Shape
from octomarch.shot import Shot
from octomarch.skies import Sky

_SIZE = (960, 540)
# Floors have no end, and sphere tracing needs ever more steps towards the horizon: a ray that skims a floor at height h
# covers at most 256 h in 256 plain steps. So the march ends before the steps do, and the horizon is even.
_MARCH = March(max_distance=1000.0)


def blend() -> Shot:
    """Return a sphere and a box blended, united, intersected and subtracted, side by side on a floor.

    Examples
    --------
    >>> len(blend().scene.lights)
    2
    """
    ball = sphere(1.0)
    cube = box(1.5).translate(0.9, 0.3, 0)
    results = {
        -4.9: ball.union(cube, smooth=0.25).paint(Material((0.85, 0.28, 0.10), roughness=0.35, specular=0.4)),
        -1.5: (ball | cube).paint(Material((0.06, 0.34, 0.38), roughness=0.4)),
        1.6: (ball & cube).paint(Material((0.90, 0.62, 0.14), roughness=0.35, specular=0.4)),
        4.2: (ball - cube).paint(Material((0.50, 0.12, 0.24), roughness=0.4)),
    }
    floor = plane(normal=(0, 1, 0), point=(0, -1, 0)).paint(Material((0.46, 0.45, 0.44), roughness=0.9, specular=0.05))
    row = [shape.translate(x, 0, 0) for x, shape in results.items()]
    scene = Scene(
        floor.union(*row),
        sky=Sky(toward=(0.02, 0.12, 0.30), away=0.02, base=(0.60, 0.64, 0.68)),
        ambient=(0.17, 0.19, 0.22),
        lights=[
            DirectionalLight(direction=(0.45, -1.0, -0.6), color=(0.95, 0.88, 0.78)),
            PointLight(position=(9, 5, 8), color=(16, 20, 26)),
        ],
    )
    return Shot(scene, Camera(eye=(2.5, 3.2, 13.5), target=(0, -0.2, 0), fov=30), _SIZE, march=_MARCH)


def building() -> Shot:
    """Return a tower hollowed by repeated windows and one shaft, on a floor.

    Examples
    --------
    >>> building().camera.eye
    (11.0, 5.0, 14.5)
    """
    windows = box((0.6, 0.8, 0.6)).repeat((1, 1.5, 1))
    tower: Shape = box((4, 12, 4)) - windows - cylinder(1.2)
    floor = plane(normal=(0, 1, 0), point=(0, -6, 0))
    scene = Scene(
        tower.paint(Material((0.72, 0.62, 0.50), roughness=0.8, specular=0.08))
        | floor.paint(Material((0.34, 0.36, 0.33), roughness=1.0, specular=0.0)),
        sky=Sky(toward=(0.02, 0.12, 0.32), away=0.02, base=(0.62, 0.66, 0.70)),
        ambient=(0.20, 0.20, 0.21),
        lights=[DirectionalLight(direction=(-1.0, -1.1, -0.45), color=(1.0, 0.90, 0.74))],
    )
    return Shot(scene, Camera(eye=(11, 5, 14.5), target=(0, -0.4, 0), fov=42), _SIZE, march=_MARCH)


DEMOS: dict[str, Callable[[], Shot]] = {"blend": blend, "building": building}
