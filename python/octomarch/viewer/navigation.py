"""How a camera moves under the hand: it orbits its target, comes nearer, moves along. `engine` builds on it.

Ways of the hand are in heights of the picture, to the right and down, so that they do not depend on its size. What is
seen follows the hand.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from octomarch import _validate as check
from octomarch.camera import AnyCamera, OrthographicCamera, PanoramicCamera, axes

Kind = TypeVar("Kind", bound=AnyCamera)

_HALF_TURN = math.pi
"""Radians of orbit for a way as long as the picture is high."""
_STEEPEST = math.radians(89)
"""Elevation above the plane across ``up``: straight above, right and left would not be known."""


def orbit(camera: Kind, right: float, down: float) -> Kind:
    """Turn the camera about its target, or about itself if it is panoramic; ``up`` stays up.

    Examples
    --------
    >>> from octomarch import Camera
    >>> eye = orbit(Camera(eye=(0, 0, 4), target=(0, 0, 0)), -0.5, 0.0).eye
    >>> [round(x, 9) for x in eye]
    [4.0, 0.0, 0.0]
    """
    if isinstance(camera, PanoramicCamera):
        turn = math.radians(camera.fov[1])
        return _placed(camera, camera.eye, _turned(camera.eye, camera.target, camera.up, turn * right, turn * down))
    turn = _HALF_TURN
    return _placed(camera, _turned(camera.target, camera.eye, camera.up, -turn * right, turn * down), camera.target)


def zoom(camera: Kind, factor: float, nearest: float = 0.0, farthest: float = math.inf) -> Kind:
    """Bring the eye to `factor` of its distance from the target, or let the picture show that much of the scene.

    The first holds for perspective, the second for orthographic cameras. A panoramic one goes that way with its target.
    What results stays within `nearest` and `farthest` in scene units, or is no farther beyond than before.

    Examples
    --------
    >>> from octomarch import Camera
    >>> zoom(Camera(eye=(0, 0, 4), target=(0, 0, 0)), 0.5).eye
    (0.0, 0.0, 2.0)
    """
    eye, target = np.array(camera.eye), np.array(camera.target)
    now = camera.height if isinstance(camera, OrthographicCamera) else float(np.linalg.norm(eye - target))
    then = min(max(now * factor, min(nearest, now)), max(farthest, now))
    if isinstance(camera, OrthographicCamera):
        return dataclasses.replace(camera, height=then)
    if isinstance(camera, PanoramicCamera):
        way = (1 - then / now) * (target - eye)
        return _placed(camera, eye + way, target + way)
    return _placed(camera, target + then / now * (eye - target), camera.target)


def pan(camera: Kind, right: float, down: float) -> Kind:
    """Move eye and target across the view, so that what is as far away as the target follows the hand.

    Examples
    --------
    >>> from octomarch import OrthographicCamera
    >>> pan(OrthographicCamera(eye=(0, 0, 4), target=(0, 0, 0), height=3), 1.0, 0.0).target
    (-3.0, 0.0, 0.0)
    """
    across, above, _ = axes(camera)
    way = span(camera) * (down * above - right * across)
    return _placed(camera, np.array(camera.eye) + way, np.array(camera.target) + way)


def span(camera: AnyCamera) -> float:
    """Return how much of the scene the height of the picture shows where the target is, in scene units.

    Examples
    --------
    >>> from octomarch import Camera
    >>> round(span(Camera(eye=(0, 0, 4), target=(0, 0, 0), fov=90)), 9)
    8.0
    """
    if isinstance(camera, OrthographicCamera):
        return camera.height
    distance = math.dist(camera.eye, camera.target)
    if isinstance(camera, PanoramicCamera):
        return distance * math.radians(camera.fov[1])
    return 2 * distance * math.tan(math.radians(camera.fov / 2))


def _turned(centre: Any, point: Any, up: Any, around: float, rise: float) -> NDArray[np.float64]:
    """Return a point turned about a centre: by one angle about ``up``, by another towards it, but never over it."""
    pole, middle = np.array(check.direction("up", up)), np.array(centre)
    offset = np.array(point) - middle
    distance = float(np.linalg.norm(offset))
    sine = float(np.clip(offset @ pole / distance, -1.0, 1.0))
    level = offset / distance - sine * pole
    level /= np.linalg.norm(level)
    elevation = math.asin(sine)
    steepest = max(_STEEPEST, abs(elevation))
    elevation = min(max(elevation + rise, -steepest), steepest)
    level = math.cos(around) * level + math.sin(around) * np.cross(pole, level)
    turned: NDArray[np.float64] = middle + distance * (math.cos(elevation) * level + math.sin(elevation) * pole)
    return turned


def _placed(camera: Kind, eye: Any, target: Any) -> Kind:
    return dataclasses.replace(camera, eye=check.point("eye", eye), target=check.point("target", target))
