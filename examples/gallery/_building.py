"""The building of the gallery, part by part: one storey, 4 × 3 × 4, that repeats upwards and sideways."""

import octomarch as om

STONE = om.Material(color=(0.75, 0.68, 0.56), roughness=0.9, specular=0.05)
GROUND = om.Material(color=(0.35, 0.38, 0.33), roughness=1.0, specular=0.0)
SUN = om.DirectionalLight(direction=(-2, -3, -1.2), color=(1.0, 0.95, 0.85))
CAMERA = om.Camera(eye=(7, 3.6, 9), target=(0, 0, 0), fov=32)


def storey() -> om.Shape:
    """Return a solid block."""
    return om.box((4, 3, 4))


def slots() -> om.Shape:
    """Return what is cut along both walls, so that columns stay."""
    bars = om.box((0.55, 2.4, 5)).repeat((1, None, None), counts=(4, None, None))
    return bars | bars.rotate(90, axis="y")


def arches() -> om.Shape:
    """Return gates through the middle of each wall, round at the top, and windows beside them."""
    gate = om.box((1, 1.2, 5)).translate(0, -0.4, 0) | om.cylinder(0.5, 5, axis="z").translate(0, 0.2, 0)
    window = om.box((0.45, 0.9, 5)).repeat((2.5, None, None), counts=(2, None, None))
    through = gate | window
    return through | through.rotate(90, axis="y")


def rooms() -> om.Shape:
    """Return the inside of a storey: what is left of the block are floor, ceiling and walls."""
    return om.box((3.4, 2.6, 3.4))


def holes() -> om.Shape:
    """Return shafts through floor and ceiling, and a large one in the middle."""
    shaft = om.cylinder(0.3, 4).repeat((2.4, None, 2.4), counts=(2, None, 2))
    return shaft | om.cylinder(0.8, 4)


def building() -> om.Shape:
    """Return all of it together."""
    return (storey() - rooms() - arches() - holes()).paint(STONE)


def scene(shape: om.Shape, ground: float | None = -1.5) -> om.Scene:
    """Return a scene of `shape` in the sun, on the ground at height `ground`."""
    if ground is not None:
        shape = shape | om.plane((0, 1, 0), (0, ground, 0)).paint(GROUND)
    return om.Scene(shape, ambient=(0.30, 0.34, 0.42), lights=[SUN])
