"""What image.stats tells of the stages of a picture: sums that add up, and zeros for what was not asked for."""

import numpy as np
import pytest

import octomarch as om
from octomarch.planes import PLANES

STAGES = ("cones", "primary", "normals", "objects", "materials", "occlusion", "shadow", "reflection", "sky")
FLOOR = om.plane(point=(0, -1, 0)).paint(om.Material(om.checker(0.1, 0.9), reflectivity=0.3))
FEW = om.sphere(1.0) | om.box(1.0).translate(2, 0, 0) | FLOOR
BALLS = om.spheres(np.random.default_rng(3).uniform(-2, 2, (300, 3)), np.full(300, 0.2))
MANY = BALLS | om.octahedron(0.2) | FLOOR
CAMERA = om.Camera((4, 3, 8), (0, 0, 0))
SIZE = (96, 64)


def stats(shape: om.Shape, planes: str | tuple[str, ...] = tuple(PLANES), size=SIZE, **options) -> dict:
    scene = om.Scene(shape, lights=[om.DirectionalLight((-1, -2, -1))], ambient=0.3)
    options = {"shading": om.Shading(bounces=1)} | options
    return om.render(scene, CAMERA, size, planes=planes, **options).stats


@pytest.mark.parametrize("shape", [FEW, MANY], ids=["few", "many"])
def test_stages_add_up(shape: om.Shape, isa: str, precision: str):
    found = stats(shape, isa=isa, precision=precision)
    stages = found["stages"]
    assert tuple(stages) == STAGES
    for name in ("evaluations", "instructions", "packets"):
        assert found[name] == sum(stage[name] for stage in stages.values())
    assert found["cells"] == sum(stage["cells_made"] for stage in stages.values())
    assert found["rays"] == stages["primary"]["count"] == SIZE[0] * SIZE[1]
    for name, stage in stages.items():
        assert stage["count"] > 0, name
        assert 0 < stage["occupancy"] <= 1, name
        assert stage["instructions"] >= stage["evaluations"] > 0, name
        assert 0 <= stage["refills"] <= stage["packets"], name
        assert (stage["packets"] > 0) == (name in ("cones", "primary", "shadow", "reflection")), name
        assert 0 < stage["seconds"] < 60, name
        assert 0 <= stage["seconds_cells"] <= stage["seconds"], name
        assert (stage["cells_visited"] > 0) >= (stage["cells_made"] > 0), name


def test_the_search_for_balls_counts_its_blocks_and_no_evaluations():
    stage = stats(BALLS | FLOOR)["stages"]["cones"]
    assert stage["count"] == SIZE[0] * SIZE[1] // 64
    assert stage["seconds"] > 0
    assert not any(stage[name] for name in ("evaluations", "instructions", "packets", "refills", "cells_visited"))


def test_counts_do_not_depend_on_threads_and_instruction_sets():
    counts = []
    for isa in om.isas():
        for threads in (1, 2):
            stages = stats(MANY, isa=isa, threads=threads)["stages"]
            counts.append({name: (stage["count"], stage["evaluations"]) for name, stage in stages.items()})
    assert all(count == counts[0] for count in counts)


def test_short_programs_have_no_cells_and_run_whole():
    found = stats(FEW)
    assert found["cells"] == found["cell_bytes"] == found["seconds_cells"] == 0
    program = om.compile(FEW)
    occlusion = found["stages"]["occlusion"]
    slots = occlusion["evaluations"] / occlusion["occupancy"]
    assert occlusion["instructions"] == pytest.approx(slots * program.instructions)


def test_long_programs_tell_of_their_cells():
    shape = MANY.translate(0, 0.25, 0)  # a program that no other test has run
    first, again = (stats(shape, size=(480, 320)) for _ in range(2))  # many rays share a cell
    assert first["cells"] > again["cells"] >= 0
    assert first["cell_bytes"] > 0
    assert first["seconds_cells"] > 0
    for found in (first, again):
        assert found["stages"]["primary"]["cells_visited"] > 0
    whole = om.compile(shape).instructions
    for name in ("primary", "shadow", "normals"):
        stage = first["stages"][name]
        assert stage["instructions"] < 0.55 * whole * stage["evaluations"] / stage["occupancy"], name


@pytest.mark.parametrize("normals", ["exact", "central", "tetrahedron"])
def test_points_without_a_gradient_are_counted(normals: str, isa: str):
    x, y, z = om.coordinates()
    step = om.field(om.where(x * x + y * y + z * z < 1, -0.5, 0.01), lipschitz=1, bounds=((-2, -2, -2), (2, 2, 2)))
    shading = om.Shading(normals=normals, normal_step=1e-4)
    options = {"planes": ("normal", "status"), "shading": shading, "isa": isa}
    image = om.render(step, om.OrthographicCamera((0, 0, 5), (0, 0, 0), height=1), (33, 21), **options)
    assert (image.status == om.Status.HIT).all()
    faces_ray = (image.normal == (0, 0, 1)).all(axis=-1)
    assert 0.99 * faces_ray.size < image.stats["without_gradient"] <= faces_ray.sum()  # differences may cross the edge
    smooth = om.render(om.sphere(2.0), om.Camera((0, 0, 5), (0, 0, 0)), (33, 21), **options)
    assert smooth.stats["without_gradient"] == 0


@pytest.mark.parametrize(
    ("planes", "stages"),
    [
        ("depth", {"cones", "primary"}),
        ("normal", {"cones", "primary", "normals"}),
        ("object_id", {"cones", "primary", "objects"}),
        ("material_id", {"cones", "primary", "objects"}),
        ("color", set(STAGES) - {"objects"}),
    ],
)
def test_what_is_not_asked_for_counts_nothing(planes: str, stages: set[str]):
    found = stats(FEW, planes)["stages"]
    for name, stage in found.items():
        if name in stages:
            assert stage["evaluations"] > 0, name
        else:
            del stage["occupancy"]
            assert not any(stage.values()), name
