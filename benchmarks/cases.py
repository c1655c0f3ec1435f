"""Six scenes, hard for marchers in six ways, each with a view. evaluations.py counts what marches take there."""

from collections.abc import Callable

import octomarch as om
from scenes import building as tower
from scenes import spheres

View = tuple[om.Shape, om.Camera]


def grazing_plane() -> View:
    """Return a floor that nearly all rays run along, seen from a twentieth of a unit above it."""
    return om.plane(), om.Camera((0, 0.05, 0), (1, 0.02, 0))


def building() -> View:
    """Return scene B: many small edges, one repeated opening."""
    scene = tower()
    return scene.shape, scene.camera


def metaballs() -> View:
    """Return eight balls that melt together; their field is far from a distance where they meet."""
    centers = [(x, y, z) for x in (-0.6, 0.6) for y in (-0.5, 0.5) for z in (-0.4, 0.4)]
    balls = [om.sphere(0.35 + 0.03 * i, center=center) for i, center in enumerate(centers)]
    return om.metaballs(*balls, k=0.3), om.Camera((3, 2, 4), (0, 0, 0))


def thin_shell() -> View:
    """Return a ball's shell, a thousandth of its radius thick, cut open so that its edge and its inside are seen."""
    opened = om.sphere(1.0).shell(0.001) - om.box(2.0).translate(0.8, 1.2, 1.0)
    return opened, om.Camera((3, 2, 4), (0, 0, 0))


def twisted_box() -> View:
    """Return a bar that turns by half about its length, so that its Lipschitz bound is far above most of its slopes."""
    return om.box((1, 3, 1)).twist(60, axis="y"), om.Camera((3, 2, 4), (0, 0, 0))


def spheres_200() -> View:
    """Return scene C with 200 balls."""
    scene = spheres(200)
    return scene.shape, scene.camera


CASES: dict[str, Callable[[], View]] = {
    "grazing plane": grazing_plane,
    "building": building,
    "metaballs": metaballs,
    "thin shell": thin_shell,
    "twisted box": twisted_box,
    "200 spheres": spheres_200,
}
