"""Certified depth against POV-Ray's, pixel by pixel."""

from pathlib import Path

import numpy as np
import pytest

import octomarch as om
import povray

pytestmark = pytest.mark.skipif(
    povray.PROGRAM is None, reason="povray is not installed; on Debian: apt-get install povray"
)

DEPTH = 1e-6
"""Some quanta of POV-Ray's pictures, and the accuracy of its solvers."""
SIZE = (96, 72)
CAMERA = om.Camera(eye=(3.1, 2.3, 4.7), target=(0.1, 0.05, -0.1), fov=37)


def matrix(columns: np.ndarray) -> str:
    """Return POV-Ray's words for a linear map, which multiplies rows."""
    return "matrix <" + ", ".join(f"{x:.17g}" for x in columns.T.ravel()) + ", 0, 0, 0>"


def turn(degrees: float) -> np.ndarray:
    """Return the rotation about z."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def united() -> tuple[om.Shape, str]:
    ball, brick = om.sphere(0.8).translate(0.3, 0.2, 0.1), om.box((1.2, 0.7, 0.9)).translate(-0.4, -0.1, 0)
    return ball | brick | om.cylinder(1.5, 0.2).translate(0, -0.9, 0), (
        "sphere { <0.3, 0.2, 0.1>, 0.8 } box { <-1, -0.45, -0.45>, <0.2, 0.25, 0.45> }"
        " cylinder { <0, -1, 0>, <0, -0.8, 0>, 1.5 }"
    )


def carved() -> tuple[om.Shape, str]:
    ball = om.sphere(1.1) & om.box((1.7, 1.6, 1.8))
    shape = ball - om.cylinder(0.45, axis="y") - om.cylinder(0.5, 4, axis="z")
    return shape, (
        "difference { intersection { sphere { 0, 1.1 } box { <-0.85, -0.8, -0.9>, <0.85, 0.8, 0.9> } }"
        " cylinder { <0, -9, 0>, <0, 9, 0>, 0.45 } cylinder { <0, 0, -2>, <0, 0, 2>, 0.5 } }"
    )


def turned() -> tuple[om.Shape, str]:
    shape = om.torus(1.0, 0.3).rotate(50, axis="z") | om.capped_cone(0.5, 0.2, 1.2).rotate(-20, axis="z")
    return shape, (
        f"torus {{ 1.0, 0.3 sturm {matrix(turn(50))} }}"
        f" cone {{ <0, -0.6, 0>, 0.5, <0, 0.6, 0>, 0.2 {matrix(turn(-20))} }}"
    )


def repeated() -> tuple[om.Shape, str]:
    shape = om.sphere(0.27).repeat((0.75, 0.6, 0.9), counts=(4, 3, 2)) | om.ellipsoid((1.8, 0.15, 0.4)).translate(
        0, -1, 0
    )
    centres = [(0.75 * (i - 1.5), 0.6 * (j - 1), 0.9 * (k - 0.5)) for i in range(4) for j in range(3) for k in range(2)]
    balls = " ".join(f"sphere {{ <{x:.17g}, {y:.17g}, {z:.17g}>, 0.27 }}" for x, y, z in centres)
    return shape, f"{balls} sphere {{ 0, 1 scale <1.8, 0.15, 0.4> translate <0, -1, 0> }}"


def blended() -> tuple[om.Shape, str]:
    """Two balls and a box, blended: no solid of POV-Ray's, but an isosurface of the same formula."""
    k = 0.4
    left, right = om.sphere(0.7).translate(-0.5, 0, 0), om.sphere(0.5).translate(0.6, 0.3, 0.2)
    shape = om.union(left, right, smooth=k) - om.sphere(0.3).translate(-0.2, 0.6, 0.5)
    ball = "sqrt(pow(x - ({}), 2) + pow(y - ({}), 2) + pow(z - ({}), 2)) - {}".format
    return shape, (
        f"#declare A = function {{ {ball(-0.5, 0, 0, 0.7)} }} #declare B = function {{ {ball(0.6, 0.3, 0.2, 0.5)} }}"
        f" #declare H = function {{ max({k} - abs(A(x, y, z) - B(x, y, z)), 0) }}"
        f" #declare S = function {{ min(A(x, y, z), B(x, y, z)) - H(x, y, z)*H(x, y, z)/{4 * k} }}"
        f" isosurface {{ function {{ max(S(x, y, z), -({ball(-0.2, 0.6, 0.5, 0.3)})) }}"
        " contained_by { box { -2, 2 } } max_gradient 1.1 accuracy 1e-9 }"
    )


@pytest.mark.parametrize("scene", [united, carved, turned, repeated, blended])
def test_silhouettes_and_depths_are_those_of_povray(scene, tmp_path: Path):
    shape, objects = scene()
    found = om.reference.certified_picture(shape, CAMERA, SIZE, max_distance=povray.FARTHEST)
    expected = povray.depth(objects, CAMERA, SIZE, tmp_path)
    assert not np.isin(found.status, (om.reference.Verdict.UNDECIDED, om.reference.Verdict.INSIDE)).any()
    seen = found.status == om.reference.Verdict.HIT
    assert 0.05 < seen.mean() < 0.95
    np.testing.assert_array_equal(seen, np.isfinite(expected))
    assert np.abs(found.t_lo[seen] - expected[seen]).max() <= DEPTH
