"""The scalar reference: what a field, a ray or a picture should be, computed the slow and simple way.

It walks the nodes of a shape one point at a time, in plain C++ with GLM, and shares no code with the compiled programs
and packets of rays behind `Shape.distance` and `octomarch.render`: where the two agree, both are very likely right.
From the program it takes the Lipschitz bound, and where and how large the scene is. It runs on one thread; Ctrl-C stops
it.

`certified` and `certified_picture` go farther, on all cores: they prove where rays first meet a shape, by intervals in
place of steps.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.brackets import Brackets, Verdict, certified, certified_picture
from octomarch.camera import AnyCamera, or_framing
from octomarch.image import Image
from octomarch.march import March
from octomarch.planes import PLANES
from octomarch.program import Program, compile
from octomarch.queries import Floats, Hits, _rays
from octomarch.render import _or_default, lit_by_default
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape

__all__ = [
    "Brackets",
    "Verdict",
    "certified",
    "certified_picture",
    "distance",
    "gradient",
    "raycast",
    "render",
]

ReferencePlane: TypeAlias = Literal["color", "depth", "position", "normal", "material_id", "steps", "status"]

REFERENCE_PLANES: tuple[ReferencePlane, ...] = (
    "color",
    "depth",
    "position",
    "normal",
    "material_id",
    "steps",
    "status",
)


def distance(shape: Shape, points: ArrayLike, dtype: Precision = "float64") -> Floats:
    """Evaluate the field of a shape; see `octomarch.Shape.distance`.

    Parameters
    ----------
    shape : Shape
        Of any depth.
    points : array_like of float, shape (..., 3)
        World frame, scene units.
    dtype : {"float64", "float32"}
        Arithmetic, and type of the result.

    Returns
    -------
    ndarray, shape (...,)
        In scene units, negative inside.

    Raises
    ------
    TypeError, ValueError
        If `shape` is none, `points` are no real numbers or their last axis is not 3, or `dtype` is another.

    Examples
    --------
    >>> import octomarch as om
    >>> om.reference.distance(om.sphere(1.0), [[0, 0, 0], [0, 3, 4]]).tolist()
    [-1.0, 4.0]
    """
    return _evaluate(_core.reference_distance, shape, points, dtype)


def gradient(shape: Shape, points: ArrayLike, dtype: Precision = "float64") -> Floats:
    """Differentiate the field of a shape analytically; see `octomarch.Shape.gradient`.

    On creases and faces, where operands are equal, it is the gradient of one side that has one. It is zero only where
    no direction leads away from the surface, such as the centre of a ball.

    Parameters
    ----------
    shape : Shape
        Of any depth.
    points : array_like of float, shape (..., 3)
        World frame, scene units.
    dtype : {"float64", "float32"}
        Arithmetic, and type of the result.

    Returns
    -------
    ndarray, shape (..., 3)
        Without unit.

    Raises
    ------
    TypeError, ValueError
        As for `distance`.

    Examples
    --------
    >>> import octomarch as om
    >>> om.reference.gradient(om.box(2.0), [[2, 0, 0], [0, -1, 0]]).tolist()
    [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    """
    return _evaluate(_core.reference_gradient, shape, points, dtype)


def raycast(
    shape: Shape,
    origins: ArrayLike,
    directions: ArrayLike,
    march: March | None = None,
    t_max: float = math.inf,
    dtype: Precision = "float64",
) -> Hits:
    """Find the first surface along each ray, by the steps that the march says; see `octomarch.Shape.raycast`.

    Parameters
    ----------
    shape : Shape
        What the rays may hit.
    origins, directions : array_like of float, shape (..., 3)
        World frame, scene units; the shapes are broadcast. `t` counts in lengths of the directions.
    march : March, optional
        Step limit and tolerances; None for the defaults.
    t_max : float
        Farthest ray parameter searched, > 0.
    dtype : {"float64", "float32"}
        Arithmetic, and type of the planes of floats.

    Returns
    -------
    Hits
        Every plane but ``object_id``, with the leading shape of the rays.

    Raises
    ------
    TypeError, ValueError
        If arrays hold no real numbers, their last axis is not 3, or their shapes do not broadcast; if an option is
        of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> hits = om.reference.raycast(om.sphere(1.0), [[0, 0, 3], [0, 3, 0]], [0, 0, -2])
    >>> hits.t.tolist(), hits.status.tolist()
    ([1.0, inf], [0, 1])
    """
    program = _compiled(shape)
    starts, aims, leading = _rays(origins, directions)
    limit = check.number("t_max", t_max)
    if not limit > 0:
        raise ValueError(f"t_max must be > 0, got {check.shown(t_max)}")
    precision = _dtype(dtype)
    native = _or_default(March, "march", march).resolve(program, origins, pixels=False)._native()
    normals = Shading().resolve(program)._native()
    found = _core.reference_raycast(program._native, starts, aims, native, normals, limit, precision)
    return Hits({name: values.reshape(leading + values.shape[1:]) for name, values in found.items()})


def render(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (160, 120),
    march: March | None = None,
    shading: Shading | None = None,
    planes: ReferencePlane | Sequence[ReferencePlane] = ("color",),
    dtype: Precision = "float64",
    samples: int = 1,
    crop: Sequence[int] | None = None,
) -> Image:
    """Render a picture, pixel after pixel; see `octomarch.render`.

    No cones are marched: rays begin at ``min_distance``, so with the method ``"auto"`` the plane ``steps`` differs.

    Parameters
    ----------
    scene : Shape or Scene
        A shape alone is lit as by `octomarch.render`.
    camera : Camera, OrthographicCamera or PanoramicCamera, optional
        None: one that frames the bounded parts of the shape.
    size : (int, int)
        Width and height in pixels.
    march : March, optional
        How rays find the surface; None for the defaults.
    shading : Shading, optional
        How surfaces are lit; None for the defaults.
    planes : sequence of str
        What to compute, of ``color depth position normal material_id steps status``.
    dtype : {"float64", "float32"}
        Arithmetic, and type of the planes of floats.
    samples : int
        Rays per pixel whose colours are averaged, 1 to 64.
    crop : (int, int, int, int), optional
        x, y, width and height of what is rendered, in pixels of the whole picture; None for all of it.

    Returns
    -------
    Image
        With the planes asked for as attributes.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range; an unknown name is answered with those there are.
    KeyboardInterrupt
        Ctrl-C stops a render at once.

    Examples
    --------
    >>> import numpy as np, octomarch as om
    >>> solid = om.sphere(1.0) - om.box(1.2)
    >>> truth = om.reference.render(solid, size=(32, 24), planes=("depth", "status"))
    >>> image = om.render(solid, size=(32, 24), planes=("depth", "status"), precision="float64")
    >>> bool(np.mean(truth.status == image.status) > 0.99)
    True
    """
    width, height = check.size(size)
    window = check.crop(crop, (width, height))
    rays = check.integer("samples", samples, 1, 64)
    names = check.planes(planes, REFERENCE_PLANES)
    if not names:
        raise ValueError("planes must name at least one plane, got none")
    precision = _dtype(dtype)
    march, shading = _or_default(March, "march", march), _or_default(Shading, "shading", shading)
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    program = compile(scene)
    camera = or_framing(camera, program, (width, height))
    if isinstance(scene, Shape):
        scene = lit_by_default(scene, camera)
    arrays = _core.reference_render(
        program._native,
        scene._native(),
        camera._native(),
        march.resolve(program, camera._ray_origins((width, height)))._native(),
        shading.resolve(program)._native(),
        width,
        height,
        window,
        rays,
        names,
        precision,
    )
    settings = {
        "size": (width, height),
        "crop": None if crop is None else window,
        "samples": rays,
        "planes": names,
        "precision": precision,
        "renderer": "reference",
    }
    return Image({name: arrays[name] for name in PLANES if name in arrays}, metadata={"render": settings})


def _evaluate(function: Any, shape: Shape, points: ArrayLike, dtype: Precision) -> Floats:
    where: NDArray[np.float64] = check.points("points", points)
    values: Floats = function(_compiled(shape)._native, where.reshape(-1, 3), _dtype(dtype))
    return values.reshape(where.shape[:-1] + values.shape[1:])


def _compiled(shape: Shape) -> Program:
    if not isinstance(shape, Shape):
        raise TypeError(f"shape must be an om.Shape, got {check.shown(shape)}")
    return compile(shape)


def _dtype(dtype: Precision) -> Precision:
    result: Precision = check.choice("dtype", dtype, ("float32", "float64"))
    return result
