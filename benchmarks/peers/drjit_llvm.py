"""Dr.Jit: the picture as one wavefront, its LLVM backend, loops traced by `dr.syntax`.

`dr.freeze` keeps the traced program, so that a steady call costs the kernel alone. Dr.Jit 1.5 works with LLVM 19 and
ends the process with others, which it may find first: where there is Debian's libllvm19 it is told so.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

for library in Path("/usr/lib").glob("*/libLLVM-19.so"):
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(library))

import drjit as dr  # noqa: E402  (it looks for LLVM when it is imported)
from drjit.llvm import Array3f, Array4f, Bool, Float, UInt32  # noqa: E402

from peers.fields import Words, field, with_ball  # noqa: E402
from peers.tasks import Task  # noqa: E402
from spheres import SMOOTH  # noqa: E402

VERSIONS = {"LLVM": ".".join(map(str, dr.detail.llvm_version()))}  # of what is no package
WORDS = Words(dr.sqrt, dr.abs, dr.minimum, dr.maximum, dr.floor)
UNROLLED = 1000  # balls at the most whose numbers are written into the program; more are read in a loop

dr.set_thread_count(1)


def field_of(task: Task, numbers: Any) -> Callable[[Any], Any]:
    """Return the distance at a point. `numbers` has the balls of scene C in a row, where they are read in a loop."""
    if task.scene != "C":
        distance = field(WORDS, task.scene)
        return lambda p: distance(p.x, p.y, p.z)
    balls, unite = task.balls(), with_ball(WORDS, SMOOTH)
    if task.n > UNROLLED:
        return lambda p: united(p, numbers, task.n, unite)

    def unrolled(p: Any) -> Any:
        d = Float(1e9)
        for x, y, z, radius in balls.tolist():
            d = unite(d, p.x - x, p.y - y, p.z - z, radius)
        return d

    return unrolled


@dr.syntax
def united(p: Any, numbers: Any, count: int, unite: Any) -> Any:
    d, i = Float(1e9), UInt32(0)
    while i < count:
        x, y, z, radius = dr.gather(Array4f, numbers, i)
        d = unite(d, p.x - x, p.y - y, p.z - z, radius)
        i += 1
    return d


@dr.syntax
def march(distance: Any, eye: Any, direction: Any, max_steps: int, epsilon: float, far: float) -> Any:
    t, steps, active = Float(0), UInt32(0), Bool(True)
    while active & (steps < max_steps):
        d = distance(dr.fma(direction, t, eye))
        active &= d >= epsilon
        t = dr.select(active, t + d, t)
        active &= t <= far
        steps += 1
    return t


@dr.syntax
def soft_shadow(
    distance: Any, p: Any, to_light: Any, active: Any, max_steps: int, k: float, epsilon: float, far: float
) -> Any:
    seen, t, steps = Float(1), Float(0), UInt32(0)
    while active & (steps < max_steps):
        d = distance(dr.fma(to_light, t, p))
        seen = dr.select(t > 0, dr.minimum(seen, k * d / t), seen)
        seen = dr.select(d < epsilon, 0, seen)
        t += d
        active &= (d >= epsilon) & (t <= far)
        steps += 1
    return seen


def prepare(task: Task) -> Callable[[], NDArray[np.float32]]:
    light = task.light
    right, up, forward = (Array3f(*axis) for axis in task.axes)
    eye, to_light = Array3f(*task.eye), Array3f(*light.direction)

    def rays(pixel: Any) -> Any:
        row, column = pixel // task.width, pixel % task.width
        sx = ((Float(column) + 0.5) * (2 / task.width) - 1) * (task.width / task.height)
        sy = 1 - (Float(row) + 0.5) * (2 / task.height)
        return dr.normalize(forward + sx * right + sy * up)

    def shade(distance: Any, p: Any, direction: Any, hit: Any) -> Any:
        x, y, z = (light.normal_step * Array3f(*axis) for axis in np.eye(3).tolist())
        n = dr.normalize(Array3f(*(distance(p + h) - distance(p - h) for h in (x, y, z))))
        p = p + light.offset * n
        open_to_sky = Float(1)
        for height, weight in light.occlusion:
            open_to_sky -= weight * dr.clip(height - distance(p + height * n), 0, height)
        facing = dr.dot(n, to_light)
        mirrored = dr.dot(to_light, direction) - 2 * facing * dr.dot(n, direction)
        highlight = light.specular * dr.power(dr.maximum(mirrored, 0), light.exponent)
        seen = soft_shadow(
            distance,
            p,
            to_light,
            hit & (facing > 0),
            light.shadow_steps,
            light.shadow_k,
            task.epsilon,
            task.max_distance,
        )
        lit = seen * (light.albedo * facing + highlight)
        return light.ambient * light.albedo * open_to_sky + dr.select(facing > 0, lit, 0)

    @dr.freeze
    def picture(pixel: Any, numbers: Any) -> Any:
        distance = field_of(task, numbers)
        direction = rays(pixel)
        t = march(distance, eye, direction, task.max_steps, task.epsilon, task.max_distance)
        hit = t <= task.max_distance
        if task.mode == "depth":
            return dr.select(hit, t, dr.inf)
        return dr.select(hit, shade(distance, dr.fma(direction, t, eye), direction, hit), light.sky)

    numbers = Float(task.balls().ravel()) if task.n > UNROLLED else Float(0)

    def render() -> NDArray[np.float32]:
        return picture(dr.arange(UInt32, task.width * task.height), numbers).numpy().reshape(task.height, task.width)

    return render
