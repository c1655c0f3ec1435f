"""Only what a scene requires: work is counted, and what a picture does not need costs exactly none."""

import pytest

import octomarch as om
from octomarch.planes import PLANES

RED, BLUE = om.Material((0.8, 0.1, 0.1)), om.Material((0.1, 0.1, 0.8))
CHECKER = om.Material(om.checker(0.1, 0.9))
MIRROR = om.Material(0.5, reflectivity=0.5)
BALL = om.sphere(1.0)
FLOOR = om.plane(point=(0, -1, 0))
PLAIN, PAINTED = BALL | FLOOR, BALL.paint(RED) | FLOOR.paint(BLUE)
CAMERA = om.Camera((0, 1, 5), (0, 0, 0))
SUN = om.DirectionalLight((-1, -2, -1))
SIZE = (50, 38)
GREY = om.ConstantSky(0.5)
FAR = om.March(max_steps=1000, max_distance=100)  # lest rays end without a surface at the horizon

EXTRA = ("normals", "objects", "materials", "occlusion", "shadow", "reflection", "sky")


def costs(
    shape: om.Shape,
    isa: str,
    planes: str | tuple[str, ...] = "color",
    lights=(),
    ambient=0.0,
    sky=GREY,
    **shading,
) -> dict[str, float]:
    """Return the evaluations beyond the march that are not zero, and shadow rays, in units of surface points."""
    scene = om.Scene(shape, lights=lights, ambient=ambient, sky=sky)
    image = om.render(scene, CAMERA, SIZE, planes=planes, march=FAR, shading=om.Shading(**shading), isa=isa)
    status = om.render(scene, CAMERA, SIZE, planes="status", march=FAR, isa=isa).status
    surfaces = int((status == om.Status.HIT).sum())
    assert surfaces > 100
    assert not (status == om.Status.STEP_LIMIT).any()
    stages = image.stats["stages"]
    counts = {name: stages[name]["evaluations"] for name in EXTRA} | {"shadow_rays": stages["shadow"]["count"]}
    return {name: count / surfaces for name, count in counts.items() if count}


# Planes --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", ["depth", "steps", "status", "position"])
def test_planes_of_the_march_cost_nothing_more(plane: str, isa: str):
    shape = BALL.paint(CHECKER) | FLOOR.paint(MIRROR)
    assert costs(shape, isa, plane, lights=[SUN], ambient=0.5, sky=om.Sky(), bounces=2) == {}


def test_normals_cost_gradients_and_nothing_else(isa: str):
    shape = BALL.paint(CHECKER) | FLOOR.paint(MIRROR)
    for normals, evaluations in (("exact", 1), ("tetrahedron", 4), ("central", 6)):
        found = costs(shape, isa, "normal", lights=[SUN], ambient=0.5, sky=om.Sky(), bounces=2, normals=normals)
        assert found == {"normals": evaluations}


@pytest.mark.parametrize("planes", ["object_id", "material_id", ("object_id", "material_id")], ids=str)
def test_ids_cost_attributes_and_nothing_else(planes, isa: str):
    shape = BALL.paint(CHECKER) | FLOOR.paint(MIRROR)
    assert costs(shape, isa, planes, lights=[SUN], ambient=0.5) == {"objects": 1}


def test_what_planes_share_is_computed_once(isa: str):
    found = costs(PAINTED, isa, tuple(PLANES), lights=[SUN], shadows="none")
    assert found == {"normals": 1, "materials": 1, "objects": 1}


# Materials -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "shape", [PLAIN, PLAIN.paint(RED), BALL.paint(RED) | FLOOR.paint(RED)], ids=["unpainted", "one paint", "equal"]
)
def test_one_material_costs_no_evaluation(shape: om.Shape, isa: str):
    assert costs(shape, isa) == {}


def test_materials_that_differ_cost_one_evaluation_of_each_point(isa: str):
    assert costs(PAINTED, isa) == {"materials": 1}
    assert costs(PLAIN.paint(CHECKER), isa) == {"materials": 1}


def test_materials_that_look_at_normals_cost_them(isa: str):
    snow = om.Material(om.where(om.normals()[1] > 0.7, 1.0, 0.2))
    assert costs(PLAIN.paint(snow), isa) == {"materials": 1, "normals": 1}


def test_ids_are_found_only_for_planes_of_ids(isa: str):
    lit = costs(PAINTED, isa, lights=[SUN], ambient=0.1)
    assert "objects" not in lit


# Light ---------------------------------------------------------------------------------------------------------------


def test_ambient_light_alone_costs_nothing(isa: str):
    assert costs(PLAIN, isa, ambient=0.1, occlusion=0) == {}


def test_occlusion_costs_its_samples_where_there_is_ambient_light(isa: str):
    assert costs(PLAIN, isa, ambient=0.0, occlusion=4) == {}
    occluded = costs(PLAIN, isa, ambient=0.1, occlusion=4)
    assert occluded == {"normals": 1, "occlusion": 4}


def test_lights_cost_normals_and_shadows_rays(isa: str):
    assert costs(PLAIN, isa, lights=[SUN], shadows="none") == {"normals": 1}
    lit = costs(FLOOR, isa, lights=[SUN, SUN], shadows="hard")
    assert lit == {"normals": 1, "shadow_rays": 2}  # which meet no more than the floor
    assert costs(PLAIN, isa, lights=[SUN, SUN], shadows="hard")["shadow"] > 0


@pytest.mark.parametrize(
    "light",
    [
        om.DirectionalLight((0, 1, 0)),
        om.PointLight((0, -3, 0)),
        om.SpotLight((0, 3, 0), direction=(0, 1, 0), angle=170),
        om.SpotLight((0, 3, 0), target=(90, -1, 0), angle=5),
    ],
    ids=["below", "point below", "turned away", "aside"],
)
def test_lights_that_do_not_reach_a_surface_cost_no_shadow_ray(light, isa: str):
    assert costs(FLOOR, isa, lights=[light], shadows="soft") == {"normals": 1}


def test_spots_cast_shadow_rays_within_their_cone_only(isa: str):
    wide = costs(FLOOR, isa, lights=[om.SpotLight((0, 3, 0), direction=(0, -1, 0), angle=120)])
    narrow = costs(FLOOR, isa, lights=[om.SpotLight((0, 3, 0), direction=(0, -1, 0), angle=30)])
    assert 0 < narrow["shadow_rays"] < wide["shadow_rays"] / 2 < 0.5


# Sky -----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "sky",
    [
        GREY,
        om.Sky(toward=0, away=0, base=0.3),
        om.GradientSky([(0, 0.5)]),
        om.CustomSky(0.2),
        om.GradientSky([(-9, 0.1), (9, 0.1)]),
    ],
    ids=["constant", "base only", "one stop", "custom", "equal stops"],
)
def test_skies_of_one_colour_cost_no_evaluation(sky, isa: str):
    image = om.render(om.Scene(BALL, sky=sky), CAMERA, SIZE, isa=isa)
    assert image.stats["stages"]["sky"]["evaluations"] == 0
    assert image.color[0, 0].min() > 0


def test_other_skies_cost_one_evaluation_of_each_ray_that_sees_them(isa: str):
    planes = ("color", "status")
    image = om.render(om.Scene(BALL, sky=om.Sky()), CAMERA, SIZE, planes=planes, isa=isa)
    assert image.stats["stages"]["sky"]["evaluations"] == (image.status == om.Status.MISS).sum() > 0


def test_the_sky_is_made_for_colours_only(isa: str, monkeypatch: pytest.MonkeyPatch):
    made = []
    texture = om.Sky.texture
    monkeypatch.setattr(om.Sky, "texture", lambda sky: made.append(sky) or texture(sky))
    scene = om.Scene(PLAIN, lights=[SUN])
    for planes in ([name for name in PLANES if name != "color"], "depth"):
        om.render(scene, CAMERA, SIZE, planes=planes, isa=isa)
    assert made == []
    om.render(scene, CAMERA, SIZE, planes=("depth", "color"), isa=isa)
    assert made == [scene.sky]


# Reflections ---------------------------------------------------------------------------------------------------------


def test_reflections_cost_nothing_without_mirrors_or_without_bounces(isa: str):
    without = costs(PLAIN, isa, lights=[SUN], bounces=0)
    assert costs(PLAIN, isa, lights=[SUN], bounces=3) == without
    assert costs(PLAIN.paint(MIRROR), isa, lights=[SUN], bounces=0) == without


def test_reflections_cost_rays_where_the_mirror_is(isa: str):
    scene = om.Scene(BALL.paint(MIRROR) | FLOOR)
    planes = ("color", "object_id")
    image = om.render(scene, CAMERA, SIZE, planes=planes, shading=om.Shading(bounces=1), isa=isa)
    assert image.stats["stages"]["reflection"]["count"] == (image.object_id == 0).sum() > 0
    assert image.stats["stages"]["reflection"]["evaluations"] >= image.stats["stages"]["reflection"]["count"]


# Instructions --------------------------------------------------------------------------------------------------------


def test_paint_is_not_in_the_distance_program():
    assert om.compile(PAINTED).instructions == om.compile(PLAIN).instructions
    assert om.compile(PLAIN.paint(CHECKER)).instructions == om.compile(PLAIN).instructions


def test_unused_shapes_leave_no_instruction():
    assert om.compile(BALL | BALL).instructions == om.compile(BALL).instructions == 1
    assert om.compile(BALL.paint(CHECKER).paint(RED)).instructions == 1


# Everything together -------------------------------------------------------------------------------------------------


def test_supersampling_multiplies_every_cost(isa: str):
    scene = om.Scene(PAINTED, lights=[SUN], ambient=0.1)
    one = om.render(scene, CAMERA, SIZE, isa=isa).stats
    four = om.render(scene, CAMERA, SIZE, samples=4, isa=isa).stats
    assert four["rays"] == 4 * one["rays"]
    for name in ("normals", "occlusion", "materials", "sky"):
        once, often = (stats["stages"][name]["evaluations"] for stats in (one, four))
        assert often == pytest.approx(4 * once, rel=0.1), name
