"""The scenes of the benchmarks, as the engine's users write them. cpp/scenes.hpp says A and B by hand, peers/ all."""

from dataclasses import dataclass

import octomarch as om
from spheres import SMOOTH, balls

SIZE = (640, 480)
MAX_STEPS = 256
EPSILON = 1e-3
MAX_DISTANCE = 100.0


@dataclass(frozen=True)
class Scene:
    """A shape and where it is looked at from; the camera looks at the origin, y is up."""

    name: str
    title: str
    shape: om.Shape
    eye: tuple[float, float, float]
    fov: float = 45.0
    max_distance: float = MAX_DISTANCE

    @property
    def camera(self) -> om.Camera:
        return om.Camera(eye=self.eye, target=(0, 0, 0), fov=self.fov)


def blend() -> Scene:
    """Return scene A."""
    ball = om.sphere(1.0)
    cube = om.box(1.5).translate(0.9, 0.3, 0.0)
    floor = om.plane(normal=(0, 1, 0), point=(0, -1, 0))
    return Scene("A", "sphere and box, smoothly united, on a floor", ball.union(cube, smooth=0.25) | floor, (3, 2, 4))


def building() -> Scene:
    """Return scene B."""
    windows = om.box((0.6, 0.8, 0.6)).repeat((1, 1.5, 1))
    tower = om.box((4, 12, 4)) - windows - om.cylinder(1.2, axis="y")
    floor = om.plane(normal=(0, 1, 0), point=(0, -6, 0))
    return Scene("B", "tower minus repeated windows minus a shaft, on a floor", tower | floor, (9, 4, 12))


def spheres(n: int = 200) -> Scene:
    """Return scene C with n balls; it grows with n, at constant density."""
    recipe = balls(n)
    shape = om.spheres(recipe.centers, recipe.radii, smooth=SMOOTH)
    return Scene("C", f"{n:,} balls, smoothly united", shape, recipe.eye, max_distance=recipe.max_distance)


SCENES = {"A": blend, "B": building}
