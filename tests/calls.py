"""A sound call of everything public, for tests that make one argument of it wrong."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import octomarch as om

X, Y, Z = om.coordinates()
BALL, FLAT = om.sphere(1.0), om.circle(1.0)
SCENE = om.Scene(BALL, lights=[om.DirectionalLight((-1, -2, -1))])
CAMERA = om.Camera((0, 0, 4), (0, 0, 0))
PROGRAM = om.compile(BALL)
MARCH = om.March("certified").resolve(PROGRAM, (0, 0, 4))
POINTS = np.zeros((4, 3)) + 2.0
PICTURE = np.full((4, 6, 3), 0.5, np.float32)
RENDERED: dict[str, Any] = {
    "scene": SCENE,
    "camera": CAMERA,
    "size": (8, 6),
    "march": om.March(),
    "shading": om.Shading(),
    "planes": ("color", "depth"),
    "precision": "float32",
    "samples": 1,
    "crop": (0, 0, 4, 4),
}
VIEWED: dict[str, Any] = {key: RENDERED[key] for key in ("scene", "camera", "size", "march", "shading", "samples")}
VIEWED["plane"] = "color"
EXECUTED: dict[str, Any] = {"threads": 1, "isa": "scalar"}
FRAMES: dict[str, Any] = {"retries": 0, "executor": None, **EXECUTED}
AXIS: dict[str, Any] = {"axis": "y", "center": (0, 0, 0)}
IMAGE = om.Image({"color": PICTURE, "steps": np.ones((4, 6), np.int32)})
QUERY: dict[str, Any] = {"points": POINTS, "precision": "float64", **EXECUTED}


def study() -> om.Study:
    return om.study(BALL, CAMERA, (16, 12), groups=("finish",), rounds=0)


def calls(folder: Path) -> dict[str, tuple[Callable[..., Any], dict[str, Any]]]:
    """Return functions, constructors and methods with arguments that they take; files are in a folder."""
    SCENE.save(folder / "scene.json")
    IMAGE.save(folder / "picture.exr")
    of_a_number = (om.absolute, om.acos, om.asin, om.atan, om.ceil, om.cos, om.exp, om.floor, om.fract, om.log, om.sign)
    numbers = {function.__name__: {"x": X} for function in (*of_a_number, om.sin, om.sqrt, om.tan)}
    functions: dict[str, dict[str, Any]] = {
        **numbers,
        "atan2": {"y": Y, "x": X},
        "clamp": {"x": X, "lo": 0, "hi": 1},
        "dot": {"a": (X, Y, Z), "b": (1, 2, 3)},
        "equal": {"a": X, "b": 1},
        "fractal_noise": {"x": X, "y": Y, "z": Z, "octaves": 2, "seed": 1},
        "mix": {"a": X, "b": Y, "t": Z},
        "mod": {"x": X, "y": 2},
        "noise": {"x": X, "y": Y, "z": Z, "seed": 1},
        "power": {"base": X, "exponent": 2},
        "smoothstep": {"lo": 0, "hi": 1, "x": X},
        "where": {"condition": X > 0, "a": X, "b": Y},
        "sphere": {"radius": 1.0, "center": (0, 0, 0)},
        "box": {"size": (1, 2, 3), "center": (0, 0, 0), "form": "exact"},
        "boxes": {"centers": POINTS, "sizes": POINTS, "smooth": 0.0},
        "capped_cone": {"radius_bottom": 1, "radius_top": 0.5, "height": 1, **AXIS},
        "capsule": {"a": (0, 0, 0), "b": (1, 0, 0), "radius": 0.5},
        "capsules": {"a": POINTS, "b": POINTS + 1, "radii": 0.5, "smooth": 0.0},
        "cone": {"radius": 1, "height": 1, **AXIS},
        "cylinder": {"radius": 1, "height": 1, **AXIS},
        "diamond": {"period": 1, "thickness": 0.1},
        "ellipsoid": {"radii": (1, 2, 3), "center": (0, 0, 0)},
        "gyroid": {"period": 1, "thickness": 0.1},
        "hexagonal_prism": {"radius": 1, "height": 1, **AXIS},
        "link": {"length": 1, "radius": 1, "tube_radius": 0.2, "center": (0, 0, 0)},
        "octahedron": {"radius": 1, "center": (0, 0, 0)},
        "plane": {"normal": (0, 1, 0), "point": (0, 0, 0)},
        "pyramid": {"edge": 1, "height": 1, "center": (0, 0, 0)},
        "rounded_box": {"size": 1, "radius": 0.1, "center": (0, 0, 0)},
        "schwarz_p": {"period": 1, "thickness": 0.1},
        "spheres": {"centers": POINTS, "radii": 0.5, "smooth": 0.0},
        "torus": {"radius": 1, "tube_radius": 0.2, **AXIS},
        "triangular_prism": {"radius": 1, "height": 1, **AXIS},
        "circle": {"radius": 1, "center": (0, 0)},
        "ellipse": {"radii": (1, 2), "center": (0, 0)},
        "polygon": {"corners": [(0, 0), (4, 0), (0, 4)], "holes": [[(1, 1), (2, 1), (1, 2)]]},
        "grid": {"values": np.ones((2, 3, 4)), "bounds": ((0, 0, 0), (1, 1, 1)), "interpolation": "linear"},
        "rectangle": {"size": (1, 2), "center": (0, 0)},
        "regular_polygon": {"sides": 5, "radius": 1, "center": (0, 0)},
        "segment": {"a": (0, 0), "b": (1, 0), "radius": 0.5},
        "star": {"points": 5, "outer": 1, "inner": 0.5, "center": (0, 0)},
        "field": {"expression": X - 1, "lipschitz": 1, "bounds": ((-1, -1, -1), (1, 1, 1))},
        "solid": {"condition": X < 0},
        "checker": {"a": 0.1, "b": 0.9, "size": 1.0},
        "stripes": {"a": 0.1, "b": 0.9, "width": 1.0, "axis": "x", "soft": 0.0},
        "noise_texture": {"a": 0.1, "b": 0.9, "size": 1.0, "octaves": 4, "seed": 0},
        "image_texture": {"source": PICTURE, "mapping": "planar", "size": 1.0, "axis": "y", "wrap": "repeat"},
        "Texture": {"red": X, "green": 0.5, "blue": Y},
        "Material": {"color": 0.5, "roughness": 0.5, "specular": 0.5, "metallic": 0.5, "reflectivity": 0.5},
        "Camera": {"eye": (0, 0, 4), "target": (0, 0, 0), "up": (0, 1, 0), "fov": 45},
        "OrthographicCamera": {"eye": (0, 0, 4), "target": (0, 0, 0), "up": (0, 1, 0), "height": 2},
        "PanoramicCamera": {"eye": (0, 0, 4), "target": (0, 0, 0), "up": (0, 1, 0), "fov": (360, 180)},
        "DirectionalLight": {"direction": (0, -1, 0), "color": 1},
        "PointLight": {"position": (0, 3, 0), "color": 1, "decay": 2},
        "SpotLight": {"position": (0, 3, 0), "target": (0, 0, 0), "color": 1, "angle": 40, "softness": 0.2, "decay": 2},
        "Sky": {"axis": (0, 1, 0), "toward": 0.1, "away": 0.1, "base": 0.1, "clamped": True},
        "ConstantSky": {"color": 0.5},
        "GradientSky": {"stops": [(-90, 0.1), (90, 0.9)], "axis": (0, 1, 0)},
        "EnvironmentMap": {"image": PICTURE, "rotation": 0, "intensity": 1},
        "CustomSky": {"color": 0.5},
        "Scene": {"shape": BALL, "sky": om.Sky(), "ambient": 0.1, "lights": ()},
        "March": {
            "method": "fixed",
            "max_steps": 64,
            "epsilon": 1e-3,
            "pixel_tolerance": 0.1,
            "max_distance": 10,
            "min_distance": 0,
            "finish": "secant",
            "bias": 0,
            "step": 0.1,
            "prune": True,
        },
        "Shading": {
            "normals": "exact",
            "normal_step": 0.1,
            "shadows": "soft",
            "shadow_k": 32,
            "occlusion": 5,
            "occlusion_distance": 0.1,
            "bounces": 0,
            "reflection_cutoff": 0.1,
            "reflection_offset": 0.1,
        },
        "Shot": RENDERED,
        "Image": {"planes": {"color": PICTURE}},
        "Progress": {"callback": print},
        "colormap": {"values": [1.0, 2.0], "vmin": 0, "vmax": 3},
        "iteration_colors": {"steps": [1, 2]},
        "compile": {"shape": BALL},
        "render": {**RENDERED, **EXECUTED, "progress": None},
        "render_file": {**RENDERED, **FRAMES, "out": folder / "a.exr", "progress": None},
        "render_frames": {
            **{name: value for name, value in RENDERED.items() if name not in ("scene", "camera")},
            **FRAMES,
            "scenes": SCENE,
            "cameras": [CAMERA, CAMERA],
            "out": folder / "f_{}.exr",
            "progress": None,
        },
        "turntable": {"scene": SCENE, "frames": 3, "camera": CAMERA, "degrees": 90},
        "study": {
            "scene": SCENE,
            "camera": CAMERA,
            "size": (16, 12),
            "march": om.March(),
            "shading": om.Shading(),
            "precision": "float32",
            "far": 9.0,
            "groups": ("base",),
            "truth": "float64",
            "rounds": 0,
            "resume": None,
            "progress": None,
            **FRAMES,
        },
        "load": {"path": folder / "scene.json"},
        "read_exr": {"path": folder / "picture.exr", "verify": True},
        "write_exr": {"path": folder / "b.exr", "image": IMAGE},
        "write_png": {"path": folder / "b.png", "colors": PICTURE},
    }
    found = {name: (getattr(om, name), arguments) for name, arguments in functions.items()}
    some = study()
    methods: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
        "Shape.bend": (BALL.bend, {"degrees": 9}),
        "Shape.color": (BALL.color, QUERY),
        "Shape.displace": (BALL.displace, {"expression": 0.1 * X, "lipschitz": 1}),
        "Shape.distance": (BALL.distance, QUERY),
        "Shape.elongate": (BALL.elongate, {"lengths": (1, 0, 0)}),
        "Shape.extrude": (FLAT.extrude, {"height": 1}),
        "Shape.gradient": (BALL.gradient, QUERY),
        "Shape.instances": (BALL.instances, {"matrices": np.eye(4)[None], "smooth": 0.0}),
        "Shape.mirror": (BALL.mirror, {"axes": "x"}),
        "Shape.paint": (BALL.paint, {"material": om.Material()}),
        "Shape.raycast": (
            BALL.raycast,
            {
                "origins": POINTS,
                "directions": POINTS,
                "march": om.March(),
                "t_max": 9,
                "planes": "t",
                "precision": "float64",
                **EXECUTED,
            },
        ),
        "Shape.repeat": (BALL.repeat, {"period": (3, 3, 3), "counts": 2}),
        "Shape.revolve": (FLAT.revolve, {"offset": 1}),
        "Shape.rotate": (BALL.rotate, {"degrees": 9, "axis": "y"}),
        "Shape.round": (BALL.round, {"radius": 0.1}),
        "Shape.scale": (BALL.scale, {"factor": 2}),
        "Shape.shell": (BALL.shell, {"thickness": 0.1}),
        "Shape.stretch": (BALL.stretch, {"factors": (1, 2, 3)}),
        "Shape.tile": (BALL.tile, {"period": (3, 3, 3), "scale": 1, "offset": 0}),
        "Shape.translate": (BALL.translate, {"x": 1, "y": 2, "z": 3}),
        "Shape.twist": (BALL.twist, {"degrees": 9, "axis": "y"}),
        "Image.false_color": (IMAGE.false_color, {"plane": "steps", "map": "perceptual", "vmin": 0, "vmax": 9}),
        "Image.save": (IMAGE.save, {"path": folder / "c.png"}),
        "March.bracket": (MARCH.bracket, {"program": PROGRAM, "origins": (0, 0, 4), "t": 3.0, "precision": "float32"}),
        "March.resolve": (om.March().resolve, {"program": PROGRAM, "origins": (0, 0, 4), "pixels": True}),
        "March.for_error": (
            om.March.for_error,
            {
                "scene": SCENE,
                "camera": CAMERA,
                "p95": 1e-1,
                "misses": 1.0,
                "false_hits": 1.0,
                "size": (8, 6),
                "precision": "float32",
                "max_distance": 9.0,
                "threads": 1,
                "progress": None,
            },
        ),
        "Shading.resolve": (om.Shading().resolve, {"program": PROGRAM}),
        "Expression.evaluate": (X.evaluate, QUERY),
        "Texture.evaluate": (om.checker(0.1, 0.9).evaluate, QUERY),
        "Study.save": (some.save, {"path": folder / "study.html"}),
        "StudyTable.column": (some.table.column, {"name": "p95"}),
        "Shot.load": (om.Shot.load, {"path": folder / "scene.json"}),
        "Shot.save": (om.Shot(SCENE).save, {"path": folder / "d.json"}),
        "Scene.save": (SCENE.save, {"path": folder / "e.json"}),
        "Shot.render": (om.Shot(SCENE, CAMERA, (8, 6)).render, {"samples": 2, "size": (8, 6), **EXECUTED}),
        "reference.distance": (om.reference.distance, {"shape": BALL, "points": POINTS, "dtype": "float64"}),
        "reference.gradient": (om.reference.gradient, {"shape": BALL, "points": POINTS, "dtype": "float64"}),
        "reference.raycast": (
            om.reference.raycast,
            {
                "shape": BALL,
                "origins": POINTS,
                "directions": POINTS,
                "march": om.March(),
                "t_max": 9,
                "dtype": "float64",
            },
        ),
        "reference.certified": (
            om.reference.certified,
            {
                "scene": BALL,
                "origins": POINTS,
                "directions": POINTS,
                "t_min": 0,
                "max_distance": 9.0,
                "tolerance": 1e-6,
                "max_evaluations": 99,
                "threads": 1,
            },
        ),
        "reference.certified_picture": (
            om.reference.certified_picture,
            {
                "scene": BALL,
                "camera": CAMERA,
                "size": (8, 6),
                "max_distance": 9.0,
                "tolerance": 1e-6,
                "max_evaluations": 99,
                "crop": (0, 0, 4, 4),
                "threads": 1,
            },
        ),
        "reference.render": (
            om.reference.render,
            {**{key: value for key, value in RENDERED.items() if key != "precision"}, "dtype": "float64"},
        ),
    }
    viewer = dict.fromkeys(("view", "Viewer") if importlib.util.find_spec("anywidget") else (), VIEWED)
    return found | methods | {name: (getattr(om, name), arguments) for name, arguments in viewer.items()}
