"""The scene of the quality series: a street between two endless walls of towers, which rays graze for a long way."""

from _building import GROUND, building

import octomarch as om

CAMERA = om.Camera(eye=(3.0, -7.5, 20), target=(-3.0, -4.5, -20), fov=60)


def street() -> om.Scene:
    """Return the street, in the afternoon."""
    towers = building().repeat((16, 3, 7), counts=(2, 7, None))
    ground = om.plane(point=(0, -10.5, 0)).paint(GROUND)
    sun = om.DirectionalLight(direction=(-1.6, -1.5, -1), color=(1.0, 0.95, 0.85))
    return om.Scene(towers | ground, ambient=(0.35, 0.38, 0.45), lights=[sun])
