"""Meshes: closed, on the surface, with exact normals and colours, from few evaluations; and what goes wrong.

Closed means that every edge has two triangles. trimesh asks that of the indices, and again of what comes back from a
file that has none.
"""

import builtins
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings

import octomarch as om
from gallery_scenes import SCRIPTS, rendered
from octomarch import png
from samples import Sample
from strategies import nested

ON_SURFACE = 1e-5
"""Of the box's diagonal: how far a vertex may lie from the surface, as the field tells it."""

PART = om.box((2, 1.4, 1)).paint(om.Material(color=(0.8, 0.2, 0.1))) - om.cylinder(0.4, 3).paint(
    om.Material(color=(0.1, 0.3, 0.9))
)


def diagonal(mesh: trimesh.Trimesh) -> float:
    return float(np.linalg.norm(np.diff(mesh.bounds, axis=0)))


def about_focus(shape: om.Shape) -> Any:
    """Return bounds that cut off what is endless, None where nothing is."""
    lo, hi = shape.bounds()
    if np.isfinite(hi - lo).all():
        return None
    focus = om.compile(shape).focus
    lo, hi = np.array(focus if focus is not None else ((-12.0, -12.0, -12.0), (12.0, 12.0, 12.0)))
    return lo - 0.3, hi + 0.31


def distinct_shapes() -> list[Any]:
    """Return the gallery's shapes, each once, by the name of the first script that shows it."""
    shapes: dict[om.Shape, str] = {}
    for script in SCRIPTS:
        shapes.setdefault(rendered(script).scene.shape, script.stem)
    return [pytest.param(shape, id=name) for shape, name in shapes.items()]


@pytest.mark.parametrize("shape", distinct_shapes())
def test_mesh_of_the_gallery_is_closed_and_on_the_surface(shape: om.Shape):
    bounds = about_focus(shape)
    mesh = shape.mesh(resolution=48, bounds=bounds)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    part = shape if bounds is None else shape & om.box(bounds[1] - bounds[0]).translate(*(bounds[0] + bounds[1]) / 2)
    assert np.abs(part.distance(mesh.vertices)).max() <= ON_SURFACE * diagonal(mesh)


@pytest.mark.parametrize("suffix", ["stl", "ply", "obj", "glb"])
def test_mesh_in_a_file_stays_closed(suffix: str, tmp_path: Path):
    mesh = PART.mesh(resolution=40)
    mesh.export(tmp_path / f"part.{suffix}")
    again = trimesh.load_mesh(tmp_path / f"part.{suffix}")
    assert again.is_watertight
    assert again.volume == pytest.approx(mesh.volume, rel=1e-5)  # files hold float32


def test_mesh_measures_what_the_solid_does():
    ball = om.sphere(1.0).mesh(resolution=64)
    assert ball.volume == pytest.approx(4 / 3 * np.pi, rel=1e-3)
    assert ball.area == pytest.approx(4 * np.pi, rel=1e-3)
    assert ball.euler_number == 2
    assert om.torus(1.0, 0.3).mesh(resolution=48).euler_number == 0


def test_mesh_has_exact_normals():
    mesh = om.sphere(1.0, center=(3, 0, 1)).mesh(resolution=32)
    expected = (mesh.vertices - (3, 0, 1)) / np.linalg.norm(mesh.vertices - (3, 0, 1), axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.vertex_normals, expected, atol=1e-12)
    # faces agree with them, so the outside is out
    along = np.einsum("ij,ij->i", mesh.face_normals, mesh.vertex_normals[mesh.faces[:, 0]])
    assert along.min() > 0


def test_mesh_has_the_colors_of_its_materials():
    mesh = PART.mesh(resolution=32)
    drilled = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 2]) < 0.4 + 1e-6
    sure = ~drilled | (np.abs(mesh.vertices[:, 1]) < 0.7 - 1e-6)  # on the hole's edge it may be either
    red, blue = png.levels(np.array([[0.8, 0.2, 0.1], [0.1, 0.3, 0.9]]))
    expected = np.where(drilled[:, np.newaxis], blue, red)
    np.testing.assert_array_equal(mesh.visual.vertex_colors[sure, :3], expected[sure])
    linear = PART.mesh(resolution=32, colors="linear").visual.vertex_colors[~drilled]
    np.testing.assert_array_equal(linear, np.broadcast_to([204, 51, 26, 255], linear.shape))
    assert PART.mesh(resolution=32, colors=None).visual.kind is None


def test_mesh_has_the_colors_of_textures():
    x, _, _ = om.coordinates()
    shape = om.box(2.0).paint(om.Material(color=om.clamp(0.5 + 0.5 * x, 0, 1))).rotate(90, axis="y")
    colors = shape.color([[0, 1, 0.5], [0, 1, -0.5]])  # x of the box is −z of the world
    np.testing.assert_allclose(colors, [[0.25] * 3, [0.75] * 3], atol=1e-12)


def test_color_is_what_a_picture_shows_of_ambient_light():
    shape = (
        om.sphere(1.0)
        .paint(om.Material(om.checker(0.2, (0.9, 0.5, 0.1), size=0.3)))
        .union(om.box(1.2).translate(1, 0, 0).paint(om.Material((0.1, 0.2, 0.9))), smooth=0.4)
    )
    scene = om.Scene(shape, ambient=1.0)
    image = om.render(
        scene,
        size=(32, 24),
        planes=("color", "position", "status"),
        shading=om.Shading(occlusion=0),
        precision="float64",
    )
    hit = image.status == om.Status.HIT
    np.testing.assert_allclose(shape.color(image.position[hit]), image.color[hit], atol=1e-5)


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_color_keeps_the_shape_and_the_precision(precision: Any):
    colors = PART.color(np.zeros((4, 2, 3)), precision=precision)
    assert colors.shape == (4, 2, 3)
    assert colors.dtype == precision


@pytest.mark.parametrize("resolution", [9, 16, 31])
def test_mesh_keeps_edges_and_corners(resolution: int):
    box = om.box((2, 1.5, 1)).mesh(resolution)
    assert box.volume == pytest.approx(3, rel=1e-8)
    assert box.area == pytest.approx(13, rel=1e-8)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-0.75, 0.75) for z in (-0.5, 0.5)])
    nearest = np.linalg.norm(box.vertices[:, np.newaxis] - corners, axis=2).min(axis=0)
    assert nearest.max() < 1e-8


def test_mesh_keeps_edges_that_lean_and_that_go_inward():
    angle = om.box(2.0) - om.box(2.0).translate(1, 1, 0)
    mesh = angle.rotate(33, axis=(1, 2, 3)).mesh(48)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(6, rel=1e-4)  # a few corners that cells share stay cut


def test_mesh_of_a_round_shape_is_not_dented():
    ball = om.sphere(1.0).mesh(24)
    along = np.einsum("ij,ij->i", ball.face_normals, ball.triangles_center)
    slivers = ball.area_faces < 0.02 * ball.area_faces.max()
    assert along[~slivers].min() > 0.95
    assert along.min() > 0


@settings(max_examples=20)
@given(nested(3))
def test_mesh_of_random_shapes_is_closed(sample: Sample):
    try:
        mesh = sample.shape.mesh(20, bounds=((-2.03, -2.01, -1.97), (2.02, 1.99, 2.05)), colors=None)
    except ValueError as error:
        assume("no surface was found" not in str(error))
        raise
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    assert np.isfinite(mesh.vertex_normals).all()


def test_mesh_needs_few_evaluations():
    resolution = 128
    ball = om.sphere(1.0).mesh(resolution)
    dense = (resolution + 4) ** 3
    assert ball.metadata["spacing"] == 2 / resolution
    assert ball.metadata["evaluations"] < dense / 3
    # with the square of the resolution
    assert om.sphere(1.0).mesh(2 * resolution).metadata["evaluations"] < 4.2 * ball.metadata["evaluations"]


def test_mesh_skips_by_the_lipschitz_bound():
    """A field that is three times too steep everywhere would hide the surface from who took it for a distance."""
    x, y, z = om.coordinates()
    steep = om.field(3 * (om.length(x, y, z) - 1), lipschitz=3, bounds=((-1.5,) * 3, (1.5,) * 3))
    mesh = steep.mesh(resolution=64)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(4 / 3 * np.pi, rel=5e-3)


def test_mesh_of_an_endless_shape_is_cut_to_its_bounds():
    slab = om.plane().mesh(resolution=48, bounds=((-1, -0.5, -2), (1, 3, 2)))
    assert slab.is_watertight
    assert slab.volume == pytest.approx(2 * 0.5 * 4, rel=0.01)
    np.testing.assert_allclose(slab.bounds, [[-1, -0.5, -2], [1, 0, 2]], atol=1e-6)


def test_mesh_of_a_solid_predicate():
    x, y, z = om.coordinates()
    ball = om.solid(x * x + y * y + z * z <= 1)
    mesh = ball.mesh(resolution=40, bounds=((-1.1,) * 3, (1.1,) * 3))
    assert mesh.is_watertight
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=ON_SURFACE)
    along = np.einsum("ij,ij->i", mesh.vertices, mesh.vertex_normals)
    assert along.min() > 0.9


def test_mesh_far_away_is_that_at_the_origin():
    far = PART.translate(1e6, 0, 0).mesh(resolution=24)
    assert far.is_watertight
    assert far.volume == pytest.approx(PART.mesh(resolution=24).volume, rel=1e-4)


@pytest.mark.parametrize(
    ("shape", "options", "message"),
    [
        (PART, {"resolution": 1}, r"resolution must lie in \[2, 4096\], got 1"),
        (PART, {"resolution": 4097}, r"resolution must lie in \[2, 4096\], got 4097"),
        (PART, {"colors": "rgb"}, "colors must be one of 'srgb', 'linear', None, got 'rgb'"),
        (PART, {"bounds": ((0, 0, 0),)}, r"bounds must be two corners, got \(\(0, 0, 0\),\)"),
        (PART, {"bounds": ((0, 0, 0), (1, 0, 1))}, r"bounds must be two corners \(lo, hi\) with lo < hi, got "),
        (PART, {"bounds": ((0, 0, 0), (1, np.inf, 1))}, r"bounds\[1\] must be finite, got \(1, inf, 1\)"),
        (PART, {"bounds": ((5, 5, 5), (6, 6, 6))}, "no surface was found"),
        (PART & om.sphere(0.1, center=(0, 9, 0)), {}, "no surface was found"),
        (om.plane(), {}, "bounds must be given, since the shape has no end along x, y, z$"),
        (
            om.plane() | om.box(2.0),
            {},
            r"no end along x, y, z, such as bounds=\(\(-1, -1, -1\), \(1, 1, 1\)\)",
        ),
        (om.cylinder(1.0), {}, "no end along y"),
        (
            om.field(om.sqrt(om.coordinates()[0]), lipschitz=1),
            {"bounds": ((-1, -1, -1), (1, 1, 1))},
            r"no distance at \(-.*its field is no number there",
        ),
    ],
)
def test_mesh_refuses(shape: om.Shape, options: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=message):
        shape.mesh(**options)


def test_mesh_refuses_what_is_no_number():
    with pytest.raises(TypeError, match=r"resolution must be an integer, got 64\.5"):
        PART.mesh(64.5)
    with pytest.raises(TypeError, match="bounds must be two corners, got 3"):
        PART.mesh(bounds=3)


@pytest.mark.parametrize("name", ["trimesh", "igl", "scipy.sparse"])
def test_mesh_says_what_to_install(name: str, monkeypatch: pytest.MonkeyPatch):
    real = builtins.__import__

    def without(module: str, *arguments: Any) -> Any:
        if module == name:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return real(module, *arguments)

    monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=rf'meshes need {name}: pip install "octomarch\[mesh\]"'):
        PART.mesh()
