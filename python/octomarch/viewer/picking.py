"""What the ray of one pixel met: `Pick`. `engine` asks for it where a pixel is clicked twice."""

from __future__ import annotations

from dataclasses import dataclass

from octomarch._validate import Vec3
from octomarch.empty import expected
from octomarch.march import Status
from octomarch.planes import PLANES
from octomarch.program import compile
from octomarch.render import render
from octomarch.viewer.pictures import View


@dataclass(frozen=True)
class Pick:
    """What the ray of a pixel met, with the march of the viewer: the bits of its picture without supersampling.

    Examples
    --------
    >>> import octomarch as om
    >>> from octomarch.viewer.picking import pick
    >>> from octomarch.viewer.pictures import view_of
    >>> found = pick(view_of(om.sphere(1.0), om.Camera((0, 0, 4), (0, 0, 0)), (33, 33)), 16, 16)
    >>> found.status.name, round(found.t, 5), found.object
    ('HIT', 3.0, 'sphere')
    """

    pixel: tuple[int, int]
    """Column and row, from the upper left corner."""
    status: Status
    """What became of the ray."""
    t: float
    """Distance along the ray in scene units; +inf where nothing is met."""
    position: Vec3
    """Point met, world frame; 0 where nothing is met."""
    normal: Vec3
    """Outward unit normal; 0 where nothing is met."""
    object_id: int
    """Index in `Program.objects`; -1 where nothing is met."""
    material_id: int
    """Index in `Program.materials`; -1 where nothing is met."""
    object: str
    """Kind of the primitive that was met; empty where nothing is met."""
    steps: int
    """Evaluations of the field along the ray."""


def pick(view: View, x: int, y: int) -> Pick:
    """Return what the ray of the pixel in column x and row y met."""
    planes = tuple(name for name in PLANES if name != "color")
    with expected():
        image = render(
            view.scene, view.camera, view.size, march=view.march, planes=planes, crop=(x, y, 1, 1), threads=1
        )
    object_id = int(image.object_id[0, 0])
    return Pick(
        pixel=(x, y),
        status=Status(int(image.status[0, 0])),
        t=float(image.depth[0, 0]),
        position=_vector(image.position[0, 0].tolist()),
        normal=_vector(image.normal[0, 0].tolist()),
        object_id=object_id,
        material_id=int(image.material_id[0, 0]),
        object=compile(view.scene).objects[object_id][0] if object_id >= 0 else "",
        steps=int(image.steps[0, 0]),
    )


def _vector(numbers: list[float]) -> Vec3:
    x, y, z = numbers
    return x, y, z
