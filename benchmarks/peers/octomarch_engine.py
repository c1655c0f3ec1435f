"""octomarch: `om.render` as its users call it, with the settings that the others have, and as it comes."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import octomarch as om
from peers.tasks import Light, Task
from scenes import SCENES, spheres


def shape_of(task: Task) -> om.Shape:
    return spheres(task.n).shape if task.scene == "C" else SCENES[task.scene]().shape


def scene_of(shape: om.Shape, light: Light) -> om.Scene:
    """Return a scene in which a pixel has the luminance that the other libraries compute."""
    roughness = (2 / (light.exponent + 2)) ** 0.25  # which makes the exponent of the highlight that of the task
    grey = om.Material(color=light.albedo, roughness=roughness, specular=light.specular)
    x, y, z = (-along for along in light.direction)
    lamp = om.DirectionalLight(direction=(x, y, z))
    return om.Scene(shape.paint(grey), om.ConstantSky(light.sky), light.ambient, [lamp])


def same_march(task: Task) -> om.March:
    return om.March(
        "plain", task.max_steps, task.epsilon, pixel_tolerance=0.0, max_distance=task.max_distance, finish=None
    )


def same_shading(light: Light, normals: str = "central") -> om.Shading:
    """Return the same shading; shadow rays have as many steps as others here, which is more than the task asks for."""
    return om.Shading(
        normals=normals,  # type: ignore[arg-type]
        normal_step=light.normal_step,
        shadow_k=light.shadow_k,
        occlusion=light.occlusion_samples,
        occlusion_distance=light.occlusion_distance,
    )


def prepare(task: Task, isa: str = "", defaults: bool = False) -> Callable[[], NDArray[np.float32]]:
    """Time what a user pays for each picture, the shape's compilation included.

    With `defaults` everything but the far limit is as it comes, without a thought: normals are exact, hits finished and
    the hit epsilon is that of the picture. Occlusion reaches as far as with the others: pictures are to be compared.
    """
    shape = shape_of(task)
    camera = om.Camera(eye=task.eye, target=(0, 0, 0), fov=task.fov)
    scene = scene_of(shape, task.light)
    march = om.March(max_distance=task.max_distance) if defaults else same_march(task)
    shading = same_shading(task.light, "exact" if defaults else "central")
    size = task.width, task.height

    def render() -> NDArray[np.float32]:
        if task.mode == "depth":
            image = om.render(shape, camera, size, march=march, planes=("depth",), threads=1, isa=isa or None)
            depth: NDArray[np.float32] = image.depth
            return depth
        image = om.render(scene, camera, size, march=march, shading=shading, threads=1, isa=isa or None)
        color: NDArray[np.float32] = image.color[..., 0]
        return color

    return render


def truth(task: Task) -> NDArray[np.float64]:
    """Return the picture in float64, with a hit epsilon and steps that leave no error to speak of."""
    shape = shape_of(task)
    camera = om.Camera(eye=task.eye, target=(0, 0, 0), fov=task.fov)
    march = om.March(max_steps=100_000, epsilon=1e-9, pixel_tolerance=0.0, max_distance=task.max_distance)
    plane = "depth" if task.mode == "depth" else "color"
    image = om.render(
        scene_of(shape, task.light),
        camera,
        (task.width, task.height),
        march=march,
        shading=same_shading(task.light, "exact"),
        planes=(plane,),
        precision="float64",
    )
    return np.asarray(image.depth if plane == "depth" else image.color[..., 0], np.float64)
