"""Painted shapes, and the colours that their surfaces have by hand-written numpy: `PAINTED`.

Under ambient light alone a picture shows the colour of each surface point, whose position and normal it gives too.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import octomarch as om

Array = NDArray[np.float64]


class Hits(NamedTuple):
    """What was hit: arrays (n, 3)."""

    color: Array
    p: Array
    normal: Array


Oracle = Callable[[Hits], Array]

RED, GREEN, BLUE = np.eye(3)
GREY = np.full(3, 0.8)  # of what has no paint
X, Y, Z = om.coordinates()
CAMERA = om.OrthographicCamera(eye=(5, 6, 4), target=(0, 0, 0), height=3.2)


def paint(shape: om.Shape, color: object) -> om.Shape:
    return shape.paint(om.Material(color=color))


def seen(shape: om.Shape, renderer: Callable[..., om.Image], **options: Any) -> om.Image:
    """Render 20 × 20 pixels whose colour is that of the surface."""
    black = om.Sky(axis=(0, 1, 0), toward=0, away=0, base=0)
    shading = om.Shading(shadows="none", occlusion=0)
    planes = ("color", "position", "normal", "status", "material_id")
    march = om.March(epsilon=1e-9, pixel_tolerance=0, max_steps=2000)
    scene = om.Scene(shape, sky=black, ambient=1)
    return renderer(scene, CAMERA, (20, 20), march=march, shading=shading, planes=planes, **options)


def hits(image: om.Image) -> Hits:
    hit = image.status == om.Status.HIT
    assert hit.sum() > 20
    return Hits(image.color[hit], image.position[hit], image.normal[hit])


def norm(v: Array) -> Array:
    return np.linalg.norm(v, axis=-1)


def share_of_larger(a: Array, b: Array, k: float) -> Array:
    return np.maximum(k - np.abs(a - b), 0) / (2 * k)


def share_of_b(a: Array, b: Array, k: float) -> Array:
    """Of the second operand in a smooth union."""
    return np.where(a < b, share_of_larger(a, b, k), 1 - share_of_larger(a, b, k))


def mixed(share: Array, of_a: Array, of_b: Array) -> Array:
    return (1 - share)[:, None] * of_a + share[:, None] * of_b


A, B = om.sphere(1.0, (-0.3, 0, 0)), om.box((1.4, 1.2, 1.6)).translate(0.3, 0, 0.2)


def a(p: Array) -> Array:
    return norm(p - [-0.3, 0, 0]) - 1


def b(p: Array) -> Array:
    q = np.abs(p - [0.3, 0, 0.2]) - [0.7, 0.6, 0.8]
    return norm(np.maximum(q, 0)) + np.minimum(q.max(axis=1), 0)


K = 0.6
BLENDS: dict[str, tuple[om.Shape, Oracle]] = {
    "union": (
        paint(A, RED).union(paint(B, BLUE), smooth=K),
        lambda at: mixed(share_of_b(a(at.p), b(at.p), K), RED, BLUE),
    ),
    "intersection": (
        paint(A, RED).intersection(paint(B, BLUE), smooth=K),
        lambda at: mixed(share_of_b(-a(at.p), -b(at.p), K), RED, BLUE),
    ),
    "difference": (
        paint(A, RED).difference(paint(B, BLUE), smooth=K),
        lambda at: mixed(share_of_b(-a(at.p), b(at.p), K), RED, BLUE),
    ),
    "metaballs": (
        om.metaballs(paint(A, RED), paint(B, BLUE), k=0.2),
        lambda at: mixed(1 / (1 + np.exp((b(at.p) - a(at.p)) / 0.2)), RED, BLUE),
    ),
    "without paint": (
        paint(A, RED).union(B, smooth=K),
        lambda at: mixed(share_of_b(a(at.p), b(at.p), K), RED, GREY),
    ),
    "outer paint": (
        paint(paint(A, RED).union(B, smooth=K), GREEN),
        lambda at: mixed(share_of_b(a(at.p), b(at.p), K), RED, GREEN),
    ),
    "outer paints": (
        paint(paint(A.union(paint(B, BLUE), smooth=K), GREEN), RED),
        lambda at: mixed(share_of_b(a(at.p), b(at.p), K), GREEN, BLUE),
    ),
    "hard": (paint(A, RED) | paint(B, BLUE), lambda at: np.where((a(at.p) < b(at.p))[:, None], RED, BLUE)),
    "cut": (paint(A, RED) - paint(B, BLUE), lambda at: np.where((a(at.p) > -b(at.p))[:, None], RED, BLUE)),
    "complement": (
        ~((~paint(A, RED)).union(~paint(B, BLUE), smooth=K)),
        lambda at: mixed(share_of_b(-a(at.p), -b(at.p), K), RED, BLUE),
    ),
}


# Colours of the position, in the painted shape's own coordinates: 0.5 + x/4 and so on.
RAINBOW = (0.5 + 0.25 * X, 0.5 + 0.25 * Y, 0.5 + 0.25 * Z)
BALL, SLAB = paint(om.sphere(1.0), RAINBOW), paint(om.box((1, 1.4, 1)), RAINBOW)
C, S = np.cos(np.radians(30)), np.sin(np.radians(30))


def turned(p: Array, angle: Array | float, u: int, v: int) -> Array:
    q = p.copy()
    q[:, u] = np.cos(angle) * p[:, u] - np.sin(angle) * p[:, v]
    q[:, v] = np.sin(angle) * p[:, u] + np.cos(angle) * p[:, v]
    return q


PLACES: dict[str, tuple[om.Shape, Callable[[Array], Array]]] = {
    "as it is": (BALL, lambda p: p),
    "translate": (BALL.translate(0.3, 0.1, -0.2), lambda p: p - [0.3, 0.1, -0.2]),
    "rotate": (SLAB.rotate(30, "y"), lambda p: p @ [[C, 0, S], [0, 1, 0], [-S, 0, C]]),
    "scale": (BALL.scale(1.5), lambda p: p / 1.5),
    "stretch": (BALL.stretch((1.5, 0.5, 1)), lambda p: p / [1.5, 0.5, 1]),
    "repeat": (BALL.scale(0.4).repeat((1, 0, 1)), lambda p: (p - np.floor(p + 0.5) * [1, 0, 1]) / 0.4),
    "mirror": (BALL.translate(0.3, 0, 0).mirror("x"), lambda p: np.abs(p) * [1, 0, 0] + p * [0, 1, 1] - [0.3, 0, 0]),
    "elongate": (BALL.elongate((0.6, 0, 0)), lambda p: p - np.clip(p, [-0.3, 0, 0], [0.3, 0, 0])),
    "twist": (SLAB.twist(40), lambda p: turned(p, np.radians(40) * p[:, 1], 0, 2)),
    "bend": (SLAB.bend(40), lambda p: turned(p, np.radians(40) * p[:, 0], 0, 1)),
    "extrude": (paint(om.circle(1.0), RAINBOW).extrude(1), lambda p: p * [1, 1, 0]),
    "revolve": (
        paint(om.circle(0.5), RAINBOW).revolve(1.0),
        lambda p: np.stack([np.hypot(p[:, 0], p[:, 2]) - 1, p[:, 1], 0 * p[:, 0]], -1),
    ),
    "outside": (paint(om.sphere(1.0).translate(0.3, 0, 0), RAINBOW), lambda p: p),
}


NX, NY, NZ = om.normals()
FACING = (0.5 + 0.5 * NX, 0.5 + 0.5 * NY, 0.5 + 0.5 * NZ)
ROUND, CUBE = paint(om.sphere(1.0), FACING), paint(om.box((1, 1.4, 1)), FACING)


def unit(v: Array) -> Array:
    return v / norm(v)[:, None]


NORMALS: dict[str, tuple[om.Shape, Oracle]] = {
    "as it is": (ROUND, lambda at: at.normal),
    "scale": (ROUND.scale(1.5), lambda at: at.normal),
    "rotate": (CUBE.rotate(30, "y"), lambda at: at.normal @ [[C, 0, S], [0, 1, 0], [-S, 0, C]]),
    "stretch": (ROUND.stretch((1.5, 0.5, 1)), lambda at: unit(at.p / [1.5, 0.5, 1])),
    "mirror": (ROUND.translate(0.3, 0, 0).mirror("x"), lambda at: at.normal * np.where(at.p < 0, [-1, 1, 1], 1)),
    "elongate": (ROUND.elongate((0.6, 0, 0)), lambda at: at.normal),
    "twist": (CUBE.twist(40), lambda at: face_normal(turned(at.p, np.radians(40) * at.p[:, 1], 0, 2))),
    "bend": (CUBE.bend(40), lambda at: face_normal(turned(at.p, np.radians(40) * at.p[:, 0], 0, 1))),
    "revolve": (
        paint(om.circle(0.5), FACING).revolve(1.0),
        lambda at: unit(np.stack([np.hypot(at.p[:, 0], at.p[:, 2]) - 1, at.p[:, 1], 0 * at.p[:, 0]], -1)),
    ),
    "extrude": (paint(om.circle(1.0), FACING).extrude(1), lambda at: at.normal),
}


def face_normal(p: Array) -> Array:
    """Of CUBE's face that is nearest to a point of its surface."""
    nearest = (np.abs(p) - [0.5, 0.7, 0.5]).argmax(axis=1)
    return np.eye(3)[nearest] * np.sign(p)


def color_at(own: Callable[[Array], Array]) -> Oracle:
    return lambda at: np.maximum(0.5 + 0.25 * own(at.p), 0)


def color_of_normal(own: Oracle) -> Oracle:
    return lambda at: 0.5 + 0.5 * own(at)


PAINTED: dict[str, tuple[om.Shape, Oracle]] = {
    **{f"blend: {name}": case for name, case in BLENDS.items()},
    **{f"position: {name}": (shape, color_at(own)) for name, (shape, own) in PLACES.items()},
    **{f"normal: {name}": (shape, color_of_normal(own)) for name, (shape, own) in NORMALS.items()},
}
