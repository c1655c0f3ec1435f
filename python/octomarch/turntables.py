"""`turntable`: cameras that go round a scene once, for `frames.render_frames`."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from octomarch import _validate as check
from octomarch.camera import AnyCamera, or_framing
from octomarch.program import compile
from octomarch.scene import Scene
from octomarch.shapes import Shape


def turntable(
    scene: Shape | Scene, frames: int = 60, *, camera: AnyCamera | None = None, degrees: float = 360.0
) -> list[AnyCamera]:
    """Return cameras that go round the target of a camera, about its ``up``, so that the scene seems to turn.

    Parameters
    ----------
    scene : Shape or Scene
        What is seen.
    frames : int
        How many, ≥ 1.
    camera : Camera, OrthographicCamera or PanoramicCamera, optional
        The first of them; None: the one that frames the scene.
    degrees : float
        How far round, in equal steps, of which the last is left to begin anew. Above 0 the camera goes to its right.

    Returns
    -------
    list of Camera, OrthographicCamera or PanoramicCamera

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.
    SceneError
        If the scene cannot be compiled.

    Examples
    --------
    >>> import octomarch as om
    >>> cameras = om.turntable(om.box(1.0), frames=4, camera=om.Camera((0, 1, 4), (0, 0, 0)))
    >>> [camera.eye for camera in cameras]
    [(0.0, 1.0, 4.0), (4.0, 1.0, 0.0), (0.0, 1.0, -4.0), (-4.0, 1.0, 0.0)]
    """
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    count = check.integer("frames", frames, 1)
    whole = check.finite("degrees", degrees)
    first = or_framing(camera, compile(scene), (640, 480))
    return [first if i == 0 else _turned(first, whole * i / count) for i in range(count)]


def _turned(camera: AnyCamera, degrees: float) -> AnyCamera:
    """Return a camera turned about the line through its target along its ``up``."""
    target, axis = np.array(camera.target), np.array(check.direction("up", camera.up))
    arm = np.array(camera.eye) - target
    along = axis * (arm @ axis)
    out = arm - along
    cosine, sine = _cosine_and_sine(degrees)
    eye = target + along + cosine * out + sine * np.cross(axis, out) + 0.0  # + 0 makes -0 plain 0
    return dataclasses.replace(camera, eye=tuple(eye.tolist()))


def _cosine_and_sine(degrees: float) -> tuple[float, float]:
    """Return both, exact at right angles."""
    quarters = round(degrees / 90)
    angle = math.radians(degrees - 90 * quarters)
    cosine, sine = math.cos(angle), math.sin(angle)
    for _ in range(quarters % 4):
        cosine, sine = -sine, cosine
    return cosine, sine
