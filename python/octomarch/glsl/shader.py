"""A scene as a fragment shader in the manner of ShaderToy. `Scene.glsl` and `Shape.glsl` call it.

It is put together from text: constants; functions of library.glsl; fields, materials and the sky as `writer` and
`expressions` write them; then the march and the light of light.glsl, which are what docs/semantics.md says of pictures.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from octomarch import _validate as check
from octomarch.camera import AnyCamera, Camera, OrthographicCamera, axes, or_framing
from octomarch.glsl.expressions import expressions
from octomarch.glsl.library import blocks, needed, number, vector
from octomarch.glsl.writer import LARGE, Writer
from octomarch.lights import DirectionalLight, Light, SpotLight
from octomarch.march import March
from octomarch.program import Program, compile
from octomarch.render import lit_by_default
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape

_ROUNDING = 16 * 2.0**-24  # of the hit epsilon, as in docs/semantics.md
_STATUSES = {"MISS": 0, "HIT": 1, "CANDIDATE": 2, "NOTHING": 3}
_EXACT = (
    0.05  # of the normal step: differences that stand in for exact normals should be near, but not drown in roundings
)
_NORMALS = {"exact": "slope_by_differences", "central": "slope_by_differences", "tetrahedron": "slope_by_tetrahedron"}


def shader(
    scene: Shape | Scene,
    camera: AnyCamera | None,
    size: tuple[int, int],
    march: March | None,
    shading: Shading | None,
) -> str:
    """Return the fragment shader of a scene; see `Scene.glsl`.

    Examples
    --------
    >>> import octomarch as om
    >>> "float sphere1 = sphere(p, 1.0);" in shader(om.sphere(1.0), None, (640, 480), None, None)
    True
    """
    whole = check.size(size)
    program = compile(scene)
    camera = or_framing(camera, program, whole)
    scene = lit_by_default(scene, camera) if isinstance(scene, Shape) else scene
    shading = _or_default(Shading, "shading", shading).resolve(program)
    march = _or_default(March, "march", march)
    if march.method == "certified":
        raise ValueError("march must have another method for a shader, which proves nothing: got 'certified'")
    march = march.resolve(program, camera._ray_origins(whole))
    writer = Writer(scene.shape._node)
    writer.field(program.anchor)
    writer.surface(program.anchor)
    sky = _sky(scene, writer)
    own = [*writer.images.sources, *writer.functions, sky]
    last = {name: blocks("light")[name] for name in ("normal_at", "radiance")}
    main = [
        _march(march),
        _slope(program, shading),
        last["normal_at"],
        _lights(scene, program),
        last["radiance"],
        _main(camera, program, march),
    ]
    library = [block for block in needed("light", main) if block not in last.values()]
    parts = [
        "// A scene as a fragment shader, written by octomarch. It runs where iResolution is given, as on ShaderToy.",
        "\n".join(_constants(scene, program, march, shading)),
        *needed("library", [*own, *writer.constants, *library, *main]),
        "\n".join(writer.constants),
        *own,
        *library,
        *main,
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def functions(shape: Shape) -> str:
    """Return ``float field(vec3 p)`` and ``Material surface(vec3 p, vec3 n)`` of a shape, and what they need.

    Examples
    --------
    >>> import octomarch as om
    >>> print(functions(om.box(2.0)).split("float field")[1].strip())
    (vec3 p) {
      float box1 = box(p, vec3(1.0));
      return box1;
    }
    <BLANKLINE>
    Material surface(vec3 p, vec3 n) {
      return within_ranges(Material(vec3(0.8), 0.5, 0.3, 0.0, 0.0));
    }
    """
    writer = Writer(shape._node)
    writer.field(compile(shape).anchor)
    writer.surface(compile(shape).anchor)
    own = [*writer.images.sources, *writer.functions]
    constants = "\n".join(writer.constants)
    return (
        "\n\n".join([*needed("library", [*own, constants, "Material"]), *([constants] if constants else []), *own])
        + "\n"
    )


def _or_default(kind: type[Any], name: str, value: object) -> Any:
    if value is None:
        return kind()
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be an om.{kind.__name__}, got {check.shown(value)}")
    return value


def _constants(scene: Scene, program: Program, march: March, shading: Shading) -> list[str]:
    """Return the settings as constants."""
    solid = program.is_solid
    is_fixed = march.method == "fixed"
    assert march.max_steps is not None
    assert march.epsilon is not None
    assert march.max_distance is not None
    assert shading.normal_step is not None
    assert shading.occlusion_distance is not None
    step = march.step if march.step is not None else 0.0
    accuracy = (step / 1024 if march.finish else step) if is_fixed else 0.0
    has_occlusion = not solid and any(scene.ambient)
    flags = {
        "FINISH": march.finish is not None,
        "LONG_STEPS": march.method in ("auto", "relaxed", "enhanced") and march.bias == 0,
        "RELAXED": march.method == "relaxed",
        "FIXED_STEPS": is_fixed,
        "SHADOWS": shading.shadows != "none",
        "SOFT_SHADOWS": shading.shadows == "soft" and not solid,
    }
    whole = {
        **_STATUSES,
        "MAX_STEPS": march.max_steps,
        "OCCLUSION_SAMPLES": shading.occlusion if has_occlusion else 0,
        "BOUNCES": shading.bounces,
    }
    floats = {
        "ROUNDING": _ROUNDING,
        "LIPSCHITZ": program.lipschitz or 1.0,
        "EPSILON": max(march.epsilon, accuracy),
        "T_MAX": march.max_distance,
        "BIAS": march.bias,
        "STEP": step,
        "NORMAL_STEP": shading.normal_step * (_EXACT if shading.normals == "exact" and not solid else 1.0),
        "SHADOW_K": shading.shadow_k,
        "OCCLUSION_DISTANCE": shading.occlusion_distance,
        "REFLECTION_CUTOFF": shading.reflection_cutoff,
        "REFLECTION_OFFSET": shading.reflection_offset,
    }
    return [
        *(f"const bool {name} = {str(value).lower()};" for name, value in flags.items()),
        *(f"const int {name} = {value};" for name, value in whole.items()),
        *(f"const float {name} = {number(min(value, LARGE))};" for name, value in floats.items()),
    ]


def _march(march: March) -> str:
    way = "steps" if march.method == "fixed" else "spheres"
    return (
        "Hit march(vec3 o, vec3 d, float t_min, vec2 tolerance) {\n"
        f"  return march_by_{way}(o, d, t_min, tolerance);\n"
        "}"
    )


def _slope(program: Program, shading: Shading) -> str:
    way = "away_from_neighbours" if program.is_solid else _NORMALS[shading.normals]
    return f"vec3 slope(vec3 p) {{\n  return {way}(p);\n}}"


def _lights(scene: Scene, program: Program) -> str:
    """Return the function that sums up what lights send to a point: o is a little above it."""
    lines = [f"  vec3 color = {vector(scene.ambient)} * ambient_visibility(o, n) * m.color;"]
    lines += [f"  color += {_light(light, program)};" for light in scene.lights]
    return "\n".join(["vec3 lit(vec3 o, vec3 n, vec3 d, Material m) {", *lines, "  return color;", "}"])


def _light(light: Light, program: Program) -> str:
    rest = "o, n, d, m)"
    if isinstance(light, DirectionalLight):
        toward = [-component for component in check.direction("direction", light.direction)]
        return f"directional_light({vector(toward)}, {vector(light.color)}, {rest}"
    position = vector(_from(program, light.position))
    if not isinstance(light, SpotLight):
        return f"point_light({position}, {vector(light.color)}, {light.decay}, {rest}"
    native = light._native()
    cone = f"{vector(native.direction)}, {number(native.outer_cosine)}, {number(native.inner_cosine)}"
    return f"spot_light({position}, {vector(light.color)}, {light.decay}, {cone}, {rest}"


def _from(program: Program, point: Sequence[float]) -> list[float]:
    """Return a point as the shader counts coordinates: from the program's anchor."""
    return [a - b for a, b in zip(point, program.anchor, strict=True)]


def _sky(scene: Scene, writer: Writer) -> str:
    roots = [component._node for component in scene.sky.texture().components]
    lines: list[str] = []
    colors = expressions(roots, "d", None, lines, writer.names, writer.images)
    body = [*lines, f"return vec3({', '.join(colors)});"]
    return "\n".join(["vec3 sky(vec3 d) {", *(f"  {line}" for line in body), "}"])


def _main(camera: AnyCamera, program: Program, march: March) -> str:
    """Return the function that each pixel calls: the camera's rays."""
    right, above, along = (vector(axis.tolist()) for axis in axes(camera))
    tolerance = number(march.pixel_tolerance)
    slope, least = "0.0", "EPSILON"
    origin = "eye"
    frame = ["vec2 q = (2.0 * pixel - iResolution.xy) / iResolution.y;"]
    if isinstance(camera, Camera):
        tangent = number(math.tan(math.radians(camera.fov) / 2))
        direction = f"normalize(along + {tangent} * (q.x * right + q.y * above))"
        slope = f"{tolerance} * {tangent} / iResolution.y"
    elif isinstance(camera, OrthographicCamera):
        half = number(camera.height / 2)
        origin = f"eye + {half} * (q.x * right + q.y * above)"
        direction = "along"
        least = f"max(EPSILON, {tolerance} * {half} / iResolution.y)"
    else:
        fov = [math.radians(angle) for angle in camera.fov]
        frame = [f"vec2 q = (pixel / iResolution.xy - 0.5) * {vector(fov)};"]
        direction = "cos(q.y) * (cos(q.x) * along + sin(q.x) * right) + sin(q.y) * above"
        slope = f"{tolerance} * {number(fov[1] / 2)} / iResolution.y"
    lines = [
        f"vec3 eye = {vector(_from(program, camera.eye))};",
        f"vec3 right = {right};",
        f"vec3 above = {above};",
        f"vec3 along = {along};",
        *frame,
        f"vec3 o = {origin};",
        f"vec3 d = {direction};",
        f"vec2 tolerance = tolerance_from(o, {least}, {slope});",
        f"color = vec4(srgb(radiance(o, d, {number(march.min_distance)}, tolerance)), 1.0);",
    ]
    return "\n".join(["void mainImage(out vec4 color, in vec2 pixel) {", *(f"  {line}" for line in lines), "}"])
