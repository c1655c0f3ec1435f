"""Triangles as shapes: distances and signs of meshes that have closed forms, files, and meshes that are not closed."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose

import octomarch as om
from test_messages import refuse_nonsense

RESOLUTION = 48
POINTS = np.random.default_rng(41).uniform(-1.2, 1.2, (4000, 3))

BALL = trimesh.creation.icosphere(subdivisions=5)
BOX = trimesh.creation.box((2, 1, 1.5))
RING = trimesh.creation.torus(0.8, 0.25, major_sections=256, minor_sections=96)

SOLIDS = {
    "ball": (BALL, om.sphere(1.0)),
    "box": (BOX, om.box((2, 1, 1.5))),
    "ring": (RING, om.torus(0.8, 0.25, axis="z")),
    "cylinder": (trimesh.creation.cylinder(0.5, 1.5, sections=512), om.cylinder(0.5, 1.5, axis="z")),
}


def within(shape: om.Shape) -> np.ndarray:
    """Return points of the grid's box."""
    lo, hi = shape.bounds()
    return POINTS[(np.clip(POINTS, lo, hi) == POINTS).all(axis=1)]


@pytest.mark.parametrize("kind", ["linear", "cubic"])
@pytest.mark.parametrize("name", SOLIDS)
def test_distances_are_those_of_the_solid(name: str, kind: str):
    """Off by a tenth of a cell between samples, at edges and in the middle by half of one."""
    mesh, solid = SOLIDS[name]
    shape = om.from_mesh(mesh, RESOLUTION, interpolation=kind)
    cell = 2.0 / RESOLUTION
    p = within(shape)
    error = np.abs(shape.distance(p) - solid.distance(p))
    assert len(p) > 500
    assert np.quantile(error, 0.95) < 0.1 * cell
    assert error.max() < 0.5 * cell
    far = np.abs(solid.distance(p)) > cell
    assert ((shape.distance(p) < 0) == (solid.distance(p) < 0))[far].all()
    assert 1 <= om.compile(shape).lipschitz < (1.8 if kind == "linear" else 2.5)


@pytest.mark.parametrize("name", SOLIDS)
def test_beyond_the_grid_distances_are_lower_bounds(name: str):
    mesh, solid = SOLIDS[name]
    shape = om.from_mesh(mesh, RESOLUTION)
    p = np.random.default_rng(42).normal(size=(3000, 3)) * np.geomspace(2, 200, 3000)[:, None]
    p = p[np.abs(p).max(axis=1) > 1.2]
    found, true = shape.distance(p), solid.distance(p)
    assert (found <= true * (1 + 1e-6) + 0.1 / RESOLUTION).all()
    assert (found > 0.5 * true).all()


def test_grid_fits_the_mesh():
    shape = om.from_mesh(BOX, resolution=20)
    assert_allclose(shape.bounds(), [(-1.2, -0.7, -0.95), (1.2, 0.7, 0.95)], atol=1e-9)
    assert shape._node.texels.shape == (25, 15, 20)
    wide = om.from_mesh(BOX, resolution=20, padding=1)
    assert_allclose(wide.bounds(), [(-2, -1.5, -1.75), (2, 1.5, 1.75)], atol=1e-9)
    tight = om.from_mesh(BOX, resolution=20, padding=0)
    assert_allclose(tight.bounds(), [(-1, -0.5, -0.75), (1, 0.5, 0.75)], atol=1e-9)


def test_shapes_come_back_from_their_meshes():
    part = (om.box((2, 1.4, 1)) - om.cylinder(0.4, 3)).union(om.sphere(0.4, center=(1, 0.5, 0)), smooth=0.2)
    again = om.from_mesh(part.mesh(64), resolution=64)
    p = within(again)
    cell = float(np.ptp(part.bounds(), axis=0).max()) / 64
    near = np.abs(part.distance(p)) < cell
    assert np.abs(again.distance(p) - part.distance(p))[near].max() < cell
    camera = om.Camera((2, 2, 3), (0, 0, 0), fov=45)
    hits = [np.isfinite(om.render(s, camera, size=(64, 48), planes=("depth",)).depth) for s in (part, again)]
    assert (hits[0] != hits[1]).mean() < 0.01


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb", "off"])
def test_meshes_are_read_from_files(suffix: str, tmp_path: Path):
    path = tmp_path / f"ring.{suffix}"
    RING.export(path)
    shape = om.from_mesh(path, 32)
    p = within(shape)
    assert_allclose(shape.distance(p), om.from_mesh(RING, 32).distance(p), atol=1e-5)
    assert om.from_mesh(str(path), 32) == shape


def test_scenes_are_read_with_their_parts_where_they_stand(tmp_path: Path):
    scene = trimesh.Scene()
    scene.add_geometry(BOX, transform=trimesh.transformations.translation_matrix((-2, 0, 0)))
    scene.add_geometry(BALL, transform=trimesh.transformations.translation_matrix((2, 0, 0)))
    scene.export(tmp_path / "scene.glb")
    for shape in (om.from_mesh(scene, 64), om.from_mesh(tmp_path / "scene.glb", 64)):
        assert_allclose(shape.distance([[-2, 0, 0], [2, 0, 0], [0, 0, 0]]), [-0.5, -1, 1], atol=0.05)


def test_cavities_overlaps_and_meshes_inside_out_have_their_inside():
    cavity = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    cavity.invert()
    hollow = trimesh.util.concatenate([BALL, cavity])
    moved = BALL.copy()
    moved.apply_translation((0.7, 0, 0))
    both = trimesh.util.concatenate([BALL, moved])
    inverted = BALL.copy()
    inverted.invert()
    assert_allclose(om.from_mesh(hollow).distance([[0, 0, 0], [0.75, 0, 0]]), [0.5, -0.25], atol=0.02)
    assert (om.from_mesh(both).distance([[0, 0, 0], [0.35, 0, 0], [0.7, 0, 0], [-0.6, 0, 0]]) < 0).all()
    assert om.from_mesh(inverted) == om.from_mesh(BALL)


def test_triangles_with_vertices_of_their_own_are_joined():
    soup = trimesh.Trimesh(BALL.triangles.reshape(-1, 3), np.arange(3 * len(BALL.faces)).reshape(-1, 3), process=False)
    assert not soup.is_watertight
    assert_allclose(om.from_mesh(soup, 24).distance(POINTS), om.from_mesh(BALL, 24).distance(POINTS), atol=1e-6)


def test_many_points_are_asked_about_in_slabs(monkeypatch: pytest.MonkeyPatch):
    whole = om.from_mesh(BALL, 20)
    monkeypatch.setattr("octomarch.meshes._AT_ONCE", 1500)
    assert om.from_mesh(BALL, 20) == whole


def opened(*missing: int) -> trimesh.Trimesh:
    keep = np.delete(np.arange(len(BALL.faces)), missing)
    return trimesh.Trimesh(BALL.vertices, BALL.faces[keep], process=False)


def turned() -> trimesh.Trimesh:
    faces = BALL.faces.copy()
    faces[7] = faces[7][::-1]
    return trimesh.Trimesh(BALL.vertices, faces, process=False)


@pytest.mark.parametrize(
    ("build", "error", "message"),
    [
        (
            lambda: om.from_mesh(opened(0)),
            ValueError,
            r"mesh must be closed, got 3 edges without .*, around 1 hole; .*fill_holes",
        ),
        (
            lambda: om.from_mesh(opened(0, 9000)),
            ValueError,
            "mesh must be closed, got 6 edges without .*, around 2 holes; ",
        ),
        (
            lambda: om.from_mesh(turned()),
            ValueError,
            r"mesh must have an inside, got 3 edges .* opposite ways.*fix_normals",
        ),
        (lambda: om.from_mesh(trimesh.Trimesh()), ValueError, "mesh must have triangles, got none"),
        (
            lambda: om.from_mesh(trimesh.Trimesh(BOX.vertices * np.nan, BOX.faces, process=False)),
            ValueError,
            "mesh must have finite",
        ),
        (
            lambda: om.from_mesh(trimesh.Trimesh(BOX.vertices * 0, BOX.faces, process=False)),
            ValueError,
            "mesh must have an extent",
        ),
        (lambda: om.from_mesh(5), TypeError, "mesh must be a trimesh.Trimesh or a file, got 5"),
        (lambda: om.from_mesh(BOX, 0), ValueError, r"resolution must lie in \[1, 1024\], got 0"),
        (lambda: om.from_mesh(BOX, 2.5), TypeError, "resolution must be an integer, got 2.5"),
        (lambda: om.from_mesh(BOX, padding=-1), ValueError, "padding must be ≥ 0, got -1"),
        (
            lambda: om.from_mesh(BOX, padding=1e6),
            ValueError,
            r"padding must leave fewer than 2\*\*31 samples, got 1000000.0",
        ),
        (lambda: om.from_mesh(BOX, interpolation="none"), ValueError, "interpolation must be one of 'linear', 'cubic'"),
    ],
)
def test_bad_arguments_are_named(build, error, message: str):
    with pytest.raises(error, match=f"^{message}"):
        build()


def test_files_that_are_no_meshes_are_named(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match=r"nothing\.stl"):
        om.from_mesh(tmp_path / "nothing.stl")
    odd = tmp_path / "text.xyzw"
    odd.write_text("no mesh")
    with pytest.raises(ValueError, match=r"^mesh must be a file that trimesh reads, got '.*text.xyzw'"):
        om.from_mesh(odd)
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF")
    with pytest.raises(ValueError, match=r"^mesh must be a file that trimesh reads, got '.*broken.glb'"):
        om.from_mesh(broken)


def test_nonsense_is_told_by_name_and_value(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    refuse_nonsense(om.from_mesh, {"mesh": BOX, "resolution": 8, "padding": 0.1, "interpolation": "linear"})


def test_missing_libraries_are_answered_with_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "igl", None)
    with pytest.raises(ImportError, match=r'pip install "octomarch\[mesh\]"'):
        om.from_mesh(BOX, 8)
