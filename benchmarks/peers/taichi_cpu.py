"""Taichi on the CPU: one kernel over the pixels of a field, one ray at a time.

Taichi reads annotations, so its functions have none but those that it wants.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import taichi as ti
from numpy.typing import NDArray

from peers.fields import Words, field, with_ball
from peers.tasks import Task
from spheres import SMOOTH

ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f32, fast_math=True, offline_cache=False, log_level=ti.WARN)

WORDS = Words(ti.sqrt, abs, ti.min, ti.max, ti.floor, compiled=ti.func)
vec3 = ti.math.vec3


def field_of(task: Task) -> Any:
    if task.scene != "C":
        distance = field(WORDS, task.scene)

        @ti.func
        def at(p):
            return distance(p.x, p.y, p.z)

        return at
    balls = ti.Vector.field(4, ti.f32, task.n)
    balls.from_numpy(task.balls())
    unite, count = with_ball(WORDS, SMOOTH), task.n

    @ti.func
    def united(p):
        d = 1e9
        for i in range(count):
            ball = balls[i]
            d = unite(d, p.x - ball.x, p.y - ball.y, p.z - ball.z, ball.w)
        return d

    return united


def shade_of(task: Task, distance: Any) -> Any:
    """Return the function from a point of the surface and the ray's direction to the luminance."""
    light, occlusion = task.light, task.light.occlusion
    to_light = vec3(light.direction)
    epsilon, far, steps = task.epsilon, task.max_distance, light.shadow_steps
    x, y, z = (vec3(axis) * light.normal_step for axis in np.eye(3).tolist())

    @ti.func
    def soft_shadow(p):
        seen, t = 1.0, 0.0
        for _ in range(steps):
            d = distance(p + t * to_light)
            if d < epsilon:
                seen = 0.0
                break
            if t > 0.0:
                seen = min(seen, light.shadow_k * d / t)
            t += d
            if t > far:
                break
        return seen

    @ti.func
    def shade(surface, direction):
        gx = distance(surface + x) - distance(surface - x)
        gy = distance(surface + y) - distance(surface - y)
        gz = distance(surface + z) - distance(surface - z)
        n = ti.math.normalize(vec3(gx, gy, gz))
        p = surface + light.offset * n
        open_to_sky = 1.0
        for height, weight in ti.static(occlusion):
            open_to_sky -= weight * ti.math.clamp(height - distance(p + height * n), 0.0, height)
        luminance = light.ambient * light.albedo * open_to_sky
        facing = n.dot(to_light)
        if facing > 0.0:
            mirrored = to_light.dot(direction) - 2.0 * facing * n.dot(direction)
            highlight = light.specular * max(mirrored, 0.0) ** light.exponent
            luminance += soft_shadow(p) * (light.albedo * facing + highlight)
        return luminance

    return shade


def prepare(task: Task) -> Callable[[], NDArray[np.float32]]:
    distance = field_of(task)
    shade = shade_of(task, distance)
    right, up, forward = (vec3(axis) for axis in task.axes)
    eye = vec3(task.eye)
    max_steps, epsilon, far, sky = task.max_steps, task.epsilon, task.max_distance, task.light.sky
    width, height, shaded = task.width, task.height, task.mode == "shaded"
    picture = ti.field(ti.f32, (height, width))

    @ti.func
    def march(direction):
        t = 0.0
        for _ in range(max_steps):
            d = distance(eye + t * direction)
            if d < epsilon:
                break
            t += d
            if t > far:
                break
        return t

    @ti.kernel
    def paint():
        for row, column in picture:
            sx = ((column + 0.5) * (2 / width) - 1) * (width / height)
            sy = 1 - (row + 0.5) * (2 / height)
            direction = ti.math.normalize(forward + sx * right + sy * up)
            t = march(direction)
            if ti.static(shaded):
                picture[row, column] = sky
                if t <= far:
                    picture[row, column] = shade(eye + t * direction, direction)
            else:
                picture[row, column] = t if t <= far else ti.math.inf

    def render() -> NDArray[np.float32]:
        paint()
        result: NDArray[np.float32] = picture.to_numpy()
        return result

    return render
