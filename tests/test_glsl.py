"""Scenes as shaders: their pictures in a browser's WebGL against those of `render`, and what is refused.

A shader finds hits within the same tolerance, but from other samples, and its normals are differences. So pixels differ
where a ray passes an edge, of a shape, a shadow or a texture, within that; everywhere else by roundings only.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import octomarch as om
from gallery_scenes import SCRIPTS, rendered
from octomarch.empty import expected
from webgl import WebGl

SIZE = (64, 48)
LEVELS = 4
"""Of the 255 of a picture, by which pixels may differ that see no edge."""
EDGES = 0.03
"""Share of pixels that may see one."""


REFUSED = {"81_sampled_field": "a shape of the kind 'grid' cannot be part of a shader"}
"""Scripts of the gallery that no shader can show, and why."""


def check(webgl: WebGl, scene: om.Scene | om.Shape, camera: Any = None, edges: float = EDGES, **options: Any) -> None:
    picture = webgl.picture(scene.glsl(camera, size=SIZE, **options), SIZE)
    with expected():
        image = om.render(scene, camera, SIZE, **options)
    difference = np.abs(picture.astype(int) - image.to_srgb()).max(axis=2)
    assert (difference > LEVELS).mean() <= edges


def stage(*lights: Any, **options: Any) -> om.Scene:
    """Return a ball and a box on a floor."""
    ball = om.sphere(0.7).translate(-0.8, 0, 0).paint(om.Material((0.8, 0.3, 0.2), roughness=0.3))
    cube = om.box(1.0).rotate(30).translate(0.8, -0.2, 0).paint(om.Material((0.2, 0.4, 0.8), metallic=0.5))
    floor = om.plane(point=(0, -0.7, 0)).paint(om.Material(0.7, reflectivity=0.3))
    return om.Scene(ball | cube | floor, lights=lights, **{"ambient": (0.1, 0.15, 0.2), **options})


EYE = om.Camera((1.5, 1.6, 4), (0, -0.2, 0), fov=45)
SUN = om.DirectionalLight((-1, -2, -1.5), (0.9, 0.8, 0.7))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_gallery_in_a_browser(webgl: WebGl, script: Path):
    scene, camera, options = rendered(script)
    if script.stem in REFUSED:
        with pytest.raises(om.SceneError, match=REFUSED[script.stem]):
            scene.glsl(camera, size=SIZE)
        return
    check(webgl, scene, camera, **{name: options[name] for name in ("march", "shading") if name in options})


@pytest.mark.parametrize(
    "light",
    [
        SUN,
        om.PointLight((2, 3, 2), 12),
        om.PointLight((2, 3, 2), 4, decay=1),
        om.PointLight((2, 3, 2), 1, decay=0),
        om.SpotLight((0, 3, 1), direction=(0.1, -1, -0.2), color=15, angle=50, softness=0.4),
        om.SpotLight((0, 3, 1), target=(0, 0, 0), color=15, angle=40, softness=0),
    ],
    ids=lambda light: type(light).__name__,
)
def test_lights(webgl: WebGl, light: Any):
    check(webgl, stage(light), EYE)


@pytest.mark.parametrize(
    "camera",
    [
        om.OrthographicCamera((2, 2, 4), (0, -0.2, 0), height=3),
        om.PanoramicCamera((0, 0.4, 1.6), (0, 0, 0), fov=(200, 120)),
        om.Camera((-3, 0.5, 1), (0, 0, 0), up=(0.2, 1, 0), fov=60),
        None,
    ],
    ids=lambda camera: type(camera).__name__,
)
def test_cameras(webgl: WebGl, camera: Any):
    check(webgl, stage(SUN), camera)


@pytest.mark.parametrize(
    "march",
    [
        om.March("plain"),
        om.March("plain", min_distance=0.5, max_distance=6),
        om.March("plain", bias=1e-3),
        om.March("relaxed"),
        om.March("enhanced", finish=None, epsilon=1e-4),
        om.March("fixed", step=0.02),
        om.March(max_steps=12),
        om.March(max_distance=1e300),
    ],
    ids=repr,
)
def test_marches(webgl: WebGl, march: om.March):
    check(webgl, stage(SUN), EYE, march=march, edges=0.06 if march.max_steps == 12 else EDGES)


@pytest.mark.parametrize(
    "shading",
    [
        om.Shading(shadows="none", occlusion=0),
        om.Shading(shadows="hard", normals="central"),
        om.Shading(shadow_k=4, normals="tetrahedron", occlusion=12, occlusion_distance=0.6),
        om.Shading(bounces=3, reflection_offset=1e-2, normal_step=1e-3),
        om.Shading(bounces=3, reflection_cutoff=0.2),
    ],
    ids=repr,
)
def test_shadings(webgl: WebGl, shading: om.Shading):
    check(webgl, stage(SUN), EYE, shading=shading)


@pytest.mark.parametrize(
    "sky",
    [
        om.ConstantSky((0.2, 0.3, 0.4)),
        om.Sky(axis=(1, 2, 0), clamped=False),
        om.GradientSky([(-10, 0.1), (5, (0.9, 0.5, 0.2)), (90, (0.1, 0.2, 0.6))]),
        om.EnvironmentMap(np.random.default_rng(3).random((8, 16, 3)), rotation=40, intensity=0.8),
        om.CustomSky(om.noise_texture((0.1, 0.2, 0.5), 0.9, size=0.4)),
    ],
    ids=lambda sky: type(sky).__name__,
)
def test_skies(webgl: WebGl, sky: Any):
    check(webgl, stage(SUN, sky=sky), EYE, shading=om.Shading(bounces=1))


def test_textures_in_all_mappings(webgl: WebGl):
    picture = np.random.default_rng(1).random((6, 6, 3))
    spots = om.sphere(0.6).paint(om.Material(om.image_texture(picture, "spherical")))
    sides = om.box(1.0).paint(om.Material(om.image_texture(picture, "triplanar", size=0.7))).rotate(25, axis=(1, 1, 0))
    slides = om.box((5, 3, 0.1)).translate(0, 0, -1).paint(om.Material(om.image_texture(picture, size=2, wrap="clamp")))
    shape = spots.translate(-0.8, 0, 0) | sides.translate(0.8, 0, 0) | slides
    check(webgl, om.Scene(shape, lights=[SUN]), om.Camera((0.5, 1, 4), (0, 0, 0)))


def test_a_solid_predicate_with_lights(webgl: WebGl):
    x, y, z = om.coordinates()
    scene = om.Scene(om.solid(x * x + y * y + abs(z) <= 1), lights=[SUN])
    march = om.March("fixed", step=0.02, max_distance=8)
    check(webgl, scene, om.Camera((1, 2, 3), (0, 0, 0)), march=march, shading=om.Shading(normal_step=0.02))


def test_far_from_the_origin_it_is_the_same_picture(webgl: WebGl):
    def moved(by: tuple[float, float, float]) -> str:
        part = om.sphere(1.0) - om.box(1.3)
        eye = tuple(a + b for a, b in zip((2, 2, 4), by, strict=True))
        scene = om.Scene(part.translate(*by), lights=[SUN])
        return scene.glsl(om.Camera(eye, by), size=SIZE)

    near, far = (webgl.picture(moved(by), SIZE).astype(int) for by in ((0, 0, 0), (2.0**20, 0, -(2.0**21))))
    assert (np.abs(near - far).max(axis=2) > LEVELS).mean() <= EDGES


def test_a_picture_of_another_size_takes_the_resolution_it_is_given(webgl: WebGl):
    shader = stage(SUN).glsl(EYE)
    picture, image = webgl.picture(shader, (96, 40)), om.render(stage(SUN), EYE, (96, 40)).to_srgb()
    assert (np.abs(picture.astype(int) - image).max(axis=2) > LEVELS).mean() <= EDGES


def test_settings_are_constants_with_names():
    shader = stage(SUN).glsl(EYE, march=om.March(max_steps=77), shading=om.Shading(shadow_k=5))
    assert "const int MAX_STEPS = 77;\n" in shader
    assert "const float SHADOW_K = 5.0;\n" in shader
    assert "void mainImage(out vec4 color, in vec2 pixel) {\n" in shader


@pytest.mark.parametrize(
    ("error", "arguments", "message"),
    [
        (ValueError, {"march": om.March("certified")}, "march must have another method for a shader.*got 'certified'"),
        (TypeError, {"march": "plain"}, "march must be an om.March, got 'plain'"),
        (TypeError, {"shading": 3}, "shading must be an om.Shading, got 3"),
        (TypeError, {"camera": (1, 2, 3)}, r"camera must be an om.Camera.*got \(1, 2, 3\)"),
        (ValueError, {"size": (0, 4)}, r"size\[0\] must lie in \[1, .*got 0"),
    ],
)
def test_bad_arguments_are_named(error: type[Exception], arguments: dict[str, Any], message: str):
    for scene in (om.sphere(1.0), om.Scene(om.sphere(1.0))):
        with pytest.raises(error, match=message):
            scene.glsl(**arguments)


def test_a_sky_too_large_for_a_shader_is_told():
    scene = om.Scene(om.sphere(1.0), sky=om.EnvironmentMap(np.zeros((256, 512, 3))))
    with pytest.raises(om.SceneError, match="an image of 512 × 256 texels cannot be part of a shader"):
        scene.glsl()
