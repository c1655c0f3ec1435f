"""Where a picture is taken from: look-at cameras of three kinds, and the framing that stands in when there is none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Vec3, VectorLike
from octomarch.program import Program

Basis: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]

_FRAMING_DIRECTION = (0.62, 0.5, 1.0)  # from the scene to the eye: to the right, above, in front
_FRAMING_FOV = 35.0
_FRAMING_MARGIN = 1.04


@dataclass(frozen=True, init=False)
class Camera:
    """Perspective look-at camera.

    With ``w = unit(target - eye)``, ``u = unit(w × up)`` and ``v = u × w`` the ray of the pixel (i, j) runs along
    ``w + tan(fov/2) (s u + r v)``, ``s = (2 (i + ½) / width - 1) width / height``, ``r = 1 - 2 (j + ½) / height``.

    Parameters
    ----------
    eye, target : sequence of three floats
        World frame, scene units; they must differ.
    up : sequence of three floats
        Of any length but zero, not parallel to the view.
    fov : float
        Vertical field of view in degrees, inside (0, 180).

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> camera = om.Camera(eye=(3, 2, 4), target=(0, 0, 0), fov=45)
    >>> om.render(om.sphere(1.0), camera, size=(32, 24)).size
    (32, 24)
    """

    eye: Vec3
    target: Vec3
    up: Vec3
    fov: float

    def __init__(
        self, eye: VectorLike, target: VectorLike, up: VectorLike = (0.0, 1.0, 0.0), fov: float = 45.0
    ) -> None:
        _look_at(self, eye, target, up)
        angle = check.finite("fov", fov)
        if not 0 < angle < 180:
            raise ValueError(f"fov must lie inside (0, 180) degrees, got {check.shown(fov)}")
        check.set_fields(self, fov=angle)

    def _native(self) -> _core.Camera:
        return _core.Camera("perspective", self.eye, self.target, self.up, self.fov, 360.0, 1.0)

    def _ray_origins(self, size: tuple[int, int]) -> NDArray[np.float64]:
        return np.array([self.eye])


@dataclass(frozen=True, init=False)
class OrthographicCamera:
    """Look-at camera of parallel rays: no perspective, as in a technical drawing.

    Parameters
    ----------
    eye, target : sequence of three floats
        World frame, scene units; they must differ. Rays start in the plane through the eye, so it should lie in
        front of all that is to be seen.
    up : sequence of three floats
        Of any length but zero, not parallel to the view.
    height : float
        Of the picture in scene units, > 0.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> above = om.OrthographicCamera(eye=(0, 9, 0), target=(0, 0, 0), up=(0, 0, -1), height=4)
    >>> image = om.render(om.sphere(1.0), above, size=(32, 32), planes=("depth",))
    >>> round(float(image.depth.min()), 1)
    8.0
    """

    eye: Vec3
    target: Vec3
    up: Vec3
    height: float

    def __init__(
        self, eye: VectorLike, target: VectorLike, up: VectorLike = (0.0, 1.0, 0.0), height: float = 2.0
    ) -> None:
        _look_at(self, eye, target, up)
        check.set_fields(self, height=check.positive("height", height))

    def _native(self) -> _core.Camera:
        return _core.Camera("orthographic", self.eye, self.target, self.up, 45.0, 360.0, self.height)

    def _ray_origins(self, size: tuple[int, int]) -> NDArray[np.float64]:
        """Return the corners of the plane from which rays start."""
        right, above, _ = axes(self)
        s, r = self.height / 2 * size[0] / size[1], self.height / 2
        return np.array([np.array(self.eye) + i * s * right + j * r * above for i in (-1, 1) for j in (-1, 1)])


@dataclass(frozen=True, init=False)
class PanoramicCamera:
    """Look-at camera that sees all around: the equirectangular projection, in which pixels are steps of angles.

    With ``w = unit(target - eye)``, ``u = unit(w × up)`` and ``v = u × w`` the ray of the pixel (i, j) runs along
    ``cos φ (cos λ w + sin λ u) + sin φ v``: the longitude ``λ = ((i + ½) / width - ½) fov[0]`` grows to the right, the
    latitude ``φ = (½ - (j + ½) / height) fov[1]`` upwards [1]_. The target is in the middle of the picture.

    Parameters
    ----------
    eye, target : sequence of three floats
        World frame, scene units; they must differ.
    up : sequence of three floats
        Of any length but zero, not parallel to the view.
    fov : (float, float)
        Horizontal and vertical field of view in degrees, inside (0, 360] and (0, 180]. Pixels are square in angle
        where both have the ratio of the picture's size: 2 : 1 for all of the sphere.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, not finite or outside its range.

    References
    ----------
    .. [1] J. P. Snyder, "Map Projections: A Working Manual", U.S. Geological Survey Professional Paper 1395, 1987,
       p. 90: the equidistant cylindrical projection. doi:10.3133/pp1395

    Examples
    --------
    >>> import octomarch as om
    >>> around = om.PanoramicCamera(eye=(0, 0, 0), target=(0, 0, -1))
    >>> image = om.render(om.sphere(1.0, center=(0, 0, 3)), around, size=(64, 32), planes=("depth",))
    >>> bool(image.depth[15, 0] < 2.1), bool(image.depth[15, 31] < 2.1)  # behind, ahead
    (True, False)
    """

    eye: Vec3
    target: Vec3
    up: Vec3
    fov: tuple[float, float]

    def __init__(
        self,
        eye: VectorLike,
        target: VectorLike,
        up: VectorLike = (0.0, 1.0, 0.0),
        fov: Sequence[float] | NDArray[Any] = (360.0, 180.0),
    ) -> None:
        _look_at(self, eye, target, up)
        angles = check.sequence("fov", fov, "(horizontal, vertical) degrees")
        if len(angles) != 2:
            raise ValueError(f"fov must be (horizontal, vertical) degrees, got {check.shown(fov)}")
        across, down = (check.finite(f"fov[{i}]", angle) for i, angle in enumerate(angles))
        for i, (angle, most) in enumerate(((across, 360), (down, 180))):
            if not 0 < angle <= most:
                raise ValueError(f"fov[{i}] must lie inside (0, {most}] degrees, got {check.shown(angle)}")
        check.set_fields(self, fov=(across, down))

    def _native(self) -> _core.Camera:
        return _core.Camera("panoramic", self.eye, self.target, self.up, self.fov[1], self.fov[0], 1.0)

    def _ray_origins(self, size: tuple[int, int]) -> NDArray[np.float64]:
        return np.array([self.eye])


AnyCamera: TypeAlias = Camera | OrthographicCamera | PanoramicCamera


def or_framing(camera: object, program: Program, size: tuple[int, int]) -> AnyCamera:
    """Return `camera`, once it is found to be one, or the framing of a program in the place of None.

    Examples
    --------
    >>> import octomarch as om
    >>> or_framing(None, om.compile(om.sphere(1.0)), (640, 480)).fov
    35.0
    """
    if camera is None:
        return framing(program, size)
    if not isinstance(camera, (Camera, OrthographicCamera, PanoramicCamera)):
        kinds = "an om.Camera, om.OrthographicCamera or om.PanoramicCamera"
        raise TypeError(f"camera must be {kinds}, got {check.shown(camera)}")
    return camera


def framing(program: Program, size: tuple[int, int]) -> Camera:
    """Return the camera that sees the focus of a program from the front right, above, as large as fits.

    Examples
    --------
    >>> import octomarch as om
    >>> framing(om.compile(om.sphere(1.0)), (640, 480)).target
    (0.0, 0.0, 0.0)
    """
    return framing_box(program.focus, size)


def framing_box(box: tuple[Vec3, Vec3] | None, size: tuple[int, int]) -> Camera:
    """Return the camera that sees a box from there; None: a unit cube about the origin.

    Examples
    --------
    >>> framing_box(((-1, 0, -1), (1, 2, 1)), (640, 480)).target
    (0.0, 1.0, 0.0)
    """
    if box is None:
        lo, hi = np.full(3, -0.5), np.full(3, 0.5)
    else:
        lo, hi = (np.array(corner) for corner in box)
    centre = (lo + hi) / 2
    half = (hi - lo) / 2 if np.any(hi > lo) else np.full(3, 0.5)
    towards_eye = np.array(check.direction("direction", _FRAMING_DIRECTION))
    basis = np.stack(_basis(tuple(towards_eye), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half @ basis.T
    tangent = math.tan(math.radians(_FRAMING_FOV / 2))
    # A corner at depth z along the view lies in the picture when |x| and |y| are at most tangent·(distance + z).
    needed = np.maximum(np.abs(corners[:, 0]) / (tangent * size[0] / size[1]), np.abs(corners[:, 1]) / tangent)
    distance = float(np.max(_FRAMING_MARGIN * needed - corners[:, 2]))
    x, y, z = (float(value) for value in centre + distance * towards_eye)
    return Camera((x, y, z), tuple(centre.tolist()), fov=_FRAMING_FOV)


def _look_at(camera: AnyCamera, eye: VectorLike, target: VectorLike, up: VectorLike) -> None:
    """Set eye, target and up of a camera, which must span a frame."""
    position, aim, above = check.point("eye", eye), check.point("target", target), check.point("up", up)
    with np.errstate(over="ignore"):
        view = np.subtract(aim, position)
    if not np.isfinite(view).all():
        raise ValueError(f"target must lie at a finite distance from eye, got {check.shown((target, eye))}")
    if not view.any():
        raise ValueError(f"target must differ from eye, got {check.shown(target)} for both")
    check.direction("up", above)
    frame = np.linalg.norm(np.cross(check.direction("view", view), check.direction("up", above)))
    if frame < 1e-9:
        raise ValueError(f"up must not be parallel to the view from eye to target, got {check.shown(up)}")
    check.set_fields(camera, eye=position, target=aim, up=above)


def axes(camera: AnyCamera) -> Basis:
    """Return the unit vectors to the right, up and along the view of a camera.

    Examples
    --------
    >>> right, above, along = axes(Camera(eye=(0, 0, 3), target=(0, 0, 0)))
    >>> right.tolist(), along.tolist()
    ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0])
    """
    return _basis(camera.eye, camera.target, camera.up)


def _basis(eye: Vec3, target: Vec3, up: Vec3) -> Basis:
    along = check.direction("view", (target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]))
    right = check.direction("up", _cross(along, check.direction("up", up)))
    # + 0 makes -0 plain 0
    return np.array(right) + 0.0, np.array(_cross(right, along)) + 0.0, np.array(along) + 0.0


def _cross(a: Vec3, b: Vec3) -> Vec3:
    """Return a × b; for three floats numpy's general way takes ten times as long."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
