"""`render`: from a shape or a scene to an `image.Image`.

Everything a picture needs is resolved here (program, camera, march, shading) and handed to the native renderer, which
marches and shades packets of rays, tile by tile, over all cores.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from octomarch import _core
from octomarch import _validate as check
from octomarch._validate import Precision
from octomarch.camera import AnyCamera, axes, or_framing
from octomarch.empty import View, warn_if_empty
from octomarch.expressions import Expression
from octomarch.image import Image
from octomarch.lights import DirectionalLight
from octomarch.march import March
from octomarch.planes import PLANES, PlaneName
from octomarch.program import Program, compile
from octomarch.progress import Callback, reporting
from octomarch.scene import Scene, unlit
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.textures import Texture

_LISTED_AT_MOST = 400  # instructions: beyond that a listing would outweigh the picture it is saved with


def render(
    scene: Shape | Scene,
    camera: AnyCamera | None = None,
    size: tuple[int, int] = (640, 480),
    *,
    march: March | None = None,
    shading: Shading | None = None,
    planes: PlaneName | Sequence[PlaneName] | Sequence[str] = ("color",),
    precision: Precision = "float32",
    samples: int = 1,
    crop: Sequence[int] | None = None,
    threads: int | None = None,
    isa: str | None = None,
    progress: bool | Callback | None = None,
) -> Image:
    """Render a picture.

    Parameters
    ----------
    scene : Shape or Scene
        A shape alone is lit by one light over the camera's left shoulder, some ambient light, and the default sky.
    camera : Camera, OrthographicCamera or PanoramicCamera, optional
        None: one that frames the bounded parts of the shape, from the front right and above.
    size : (int, int)
        Width and height of the whole picture in pixels, 2²⁸ of them at the most.
    march : March, optional
        How rays find the surface; None for the defaults.
    shading : Shading, optional
        How surfaces are lit; None for the defaults.
    planes : sequence of str
        What to compute, of ``color depth position normal object_id material_id steps status``. Each costs only when
        it is asked for.
    precision : {"float32", "float64"}
        Arithmetic, and type of the planes of floats.
    samples : int
        Rays per pixel whose colours are averaged, 1 to 64, at fixed places that are well spread; 1 is the centre. The
        other planes are those of the centre, at the cost of one more ray where there are several samples.
    crop : (int, int, int, int), optional
        x, y, width and height of what is rendered, in pixels from the upper left corner of the whole picture. The
        planes are as large as the crop, and hold the same bits as there. None: all of it.
    threads : int, optional
        Threads at the most; None for all cores. The picture does not depend on it.
    isa : str, optional
        One of `octomarch.isas`; None for the best, or what the environment's OCTOMARCH_ISA says.
    progress : bool, callable or Progress, optional
        True shows a bar, in terminals and notebooks, with rays a second and the time left. A callable gets (tiles done,
        tiles in all) from time to time, and what it raises ends the render. A `Progress` can be cancelled.

    Returns
    -------
    Image
        With the planes asked for as attributes.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range; an unknown name is answered with those there are.
    SceneError
        If the shape cannot be compiled.
    MemoryError
        If there is none for the planes; `octomarch.render_file` needs little.
    KeyboardInterrupt, CancelledError
        Ctrl-C and `Progress.cancel` stop a render at once.

    Warns
    -----
    RenderWarning
        If nothing is to be seen in a whole picture: why, and what would help.

    Examples
    --------
    >>> import octomarch as om
    >>> image = om.render(om.sphere(1.0) - om.box(1.2), size=(64, 48), planes=("color", "depth"))
    >>> image.color.shape, image.depth.dtype
    ((48, 64, 3), dtype('float32'))
    """
    width, height = check.size(size)
    window = check.crop(crop, (width, height))
    rays = check.integer("samples", samples, 1, 64)
    names = check.planes(planes, tuple(PLANES))
    options = check.precision(precision), check.threads(threads), check.isa(isa)
    march, shading = _or_default(March, "march", march), _or_default(Shading, "shading", shading)
    if not isinstance(scene, (Shape, Scene)):
        raise TypeError(f"scene must be an om.Shape or om.Scene, got {check.shown(scene)}")
    program = compile(scene)
    camera = or_framing(camera, program, (width, height))
    if isinstance(scene, Shape):
        scene = lit_by_default(scene, camera) if "color" in names else Scene(scene)
    march = march.resolve(program, camera._ray_origins((width, height)))
    shading = shading.resolve(program)

    def take(view: View, window: Sequence[int], samples: int, planes: list[Any], report: Callback | None = None) -> Any:
        light = scene._native() if "color" in planes else unlit()
        of = view.program._native, light, view.camera._native(), view.march._native(), shading._native()
        width, height = view.size
        return _core.render(*of, width, height, window, samples, planes, *options, report)

    view = View(program, camera, (width, height), march)
    with reporting(progress, "render", " rays", window[2] * window[3] * rays) as report:
        try:
            arrays, stats = take(view, window, rays, names, report)
        except MemoryError as error:
            pixels = f"{window[2]}×{window[3]} pixels with the planes {', '.join(names)}"
            raise MemoryError(f"no memory for {pixels}: octomarch.render_file needs little ({error})") from error
    if crop is None:
        warn_if_empty(view, arrays, stats, lambda less: take(less, (0, 0, *less.size), 1, ["status"])[0]["status"])
    settings = {
        "size": (width, height),
        "crop": None if crop is None else window,
        "samples": rays,
        "planes": names,
        "precision": options[0],
    }
    planes_in_order = {name: arrays[name] for name in PLANES if name in names}
    return Image(
        planes_in_order,
        stats=stats,
        metadata=lambda: {
            "scene": _description(scene, program),
            "camera": _fields(camera),
            "march": _fields(march),
            "shading": _fields(shading),
            "render": settings,
            "document": _document(scene, camera, march=march, shading=shading, **settings),
        },
    )


def lit_by_default(shape: Shape, camera: AnyCamera) -> Scene:
    """Return a scene of `shape` under one light that comes over the left shoulder of whoever looks.

    Examples
    --------
    >>> import octomarch as om
    >>> len(lit_by_default(om.sphere(1.0), om.Camera((0, 0, 4), (0, 0, 0))).lights)
    1
    """
    right, above, along = axes(camera)
    return Scene(shape, ambient=0.25, lights=[DirectionalLight(along + 0.7 * right - 1.0 * above, 0.85)])


def _or_default(kind: type[Any], name: str, value: object) -> Any:
    if value is None:
        return kind()
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be an om.{kind.__name__}, got {check.shown(value)}")
    return value


def _document(*arguments: Any, **settings: Any) -> str | None:
    """Return how to make the picture again as a scene file's text, where that is not too long."""
    from octomarch.scenefile import text_for_picture  # here, since both build on this module
    from octomarch.shot import Shot

    return text_for_picture(Shot(*arguments, **settings))


def _description(scene: Scene, program: Program) -> dict[str, Any]:
    """Return what a scene is, as plain data and not too long."""
    small = program.instructions <= _LISTED_AT_MOST  # asked first: the second program is compiled when it is looked at
    small = small and program.instructions + program.attribute_instructions <= _LISTED_AT_MOST
    return {
        "listing": str(program) if small else f"{program.instructions} instructions, not listed",
        "materials": [_fields(material) for material in program.materials] if small else [],
        "lights": [_fields(light) for light in scene.lights],
        "sky": _fields(scene.sky),
        "ambient": scene.ambient,
    }


def _fields(instance: Any) -> dict[str, Any]:
    """Return a dataclass as plain data: expressions and textures as short text, pictures as their size."""
    values = {f.name: getattr(instance, f.name) for f in dataclasses.fields(instance) if not f.name.startswith("_")}
    return {"type": type(instance).__name__, **{name: _plain(value) for name, value in values.items()}}


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return f"{value.shape[1]} x {value.shape[0]} pixels"
    return repr(value) if isinstance(value, (Expression, Texture)) else value
