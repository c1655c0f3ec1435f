"""Warp on the CPU: one kernel over the pixels, one ray at a time.

A variable that changes in a loop is made by float(…): a literal would be a constant to Warp.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from peers.fields import Words, field, with_ball
from peers.tasks import Task
from spheres import SMOOTH

wp.config.quiet = True
wp.config.enable_backward = False
wp.set_module_options({"fast_math": True, "enable_backward": False})
wp.init()

WORDS = Words(wp.sqrt, wp.abs, wp.min, wp.max, wp.floor, compiled=wp.func)


def field_of(task: Task) -> Any:
    """Return the distance at a point, given the balls of scene C; the other scenes have no use for them."""
    if task.scene != "C":
        distance = field(WORDS, task.scene)

        @wp.func
        def at(p: wp.vec3, balls: wp.array[wp.vec4]) -> float:
            return distance(p[0], p[1], p[2])

        return at
    unite = with_ball(WORDS, SMOOTH)

    @wp.func
    def united(p: wp.vec3, balls: wp.array[wp.vec4]) -> float:
        d = float(1e9)
        for i in range(balls.shape[0]):
            ball = balls[i]
            d = unite(d, p[0] - ball[0], p[1] - ball[1], p[2] - ball[2], ball[3])
        return d

    return united


def shade_of(task: Task, distance: Any) -> Any:
    """Return the function from a point of the surface and the ray's direction to the luminance."""
    light = task.light
    to_light = wp.constant(wp.vec3(*light.direction))
    x, y, z = (wp.constant(wp.vec3(*axis) * light.normal_step) for axis in np.eye(3).tolist())
    epsilon, far, steps, k = task.epsilon, task.max_distance, light.shadow_steps, light.shadow_k
    samples, offset, exponent = light.occlusion_samples, light.offset, light.exponent
    vector = wp.types.vector(samples, float)
    heights, weights = (wp.constant(vector(*values)) for values in zip(*light.occlusion, strict=True))
    ambient, albedo, specular = light.ambient * light.albedo, light.albedo, light.specular

    @wp.func
    def soft_shadow(p: wp.vec3, balls: wp.array[wp.vec4]) -> float:
        seen = float(1.0)
        t = float(0.0)
        for _ in range(steps):
            d = distance(p + t * to_light, balls)
            if d < epsilon:
                return 0.0
            if t > 0.0:
                seen = wp.min(seen, k * d / t)
            t += d
            if t > far:
                break
        return seen

    @wp.func
    def shade(surface: wp.vec3, direction: wp.vec3, balls: wp.array[wp.vec4]) -> float:
        gx = distance(surface + x, balls) - distance(surface - x, balls)
        gy = distance(surface + y, balls) - distance(surface - y, balls)
        gz = distance(surface + z, balls) - distance(surface - z, balls)
        n = wp.normalize(wp.vec3(gx, gy, gz))
        p = surface + offset * n
        open_to_sky = float(1.0)
        for i in range(samples):
            d = distance(p + heights[i] * n, balls)
            open_to_sky -= weights[i] * wp.clamp(heights[i] - d, 0.0, heights[i])
        luminance = ambient * open_to_sky
        facing = wp.dot(n, to_light)
        if facing > 0.0:
            mirrored = wp.dot(to_light, direction) - 2.0 * facing * wp.dot(n, direction)
            highlight = specular * wp.pow(wp.max(mirrored, 0.0), exponent)
            luminance += soft_shadow(p, balls) * (albedo * facing + highlight)
        return luminance

    return shade


def prepare(task: Task) -> Callable[[], NDArray[np.float32]]:
    distance = field_of(task)
    shade = shade_of(task, distance)
    right, up, forward = (wp.constant(wp.vec3(*axis)) for axis in task.axes)
    eye = wp.constant(wp.vec3(*task.eye))
    max_steps, epsilon, far, sky = task.max_steps, task.epsilon, task.max_distance, task.light.sky
    aspect, per_column, per_row = task.width / task.height, 2 / task.width, 2 / task.height

    @wp.func
    def direction_of(row: int, column: int) -> wp.vec3:
        sx = ((float(column) + 0.5) * per_column - 1.0) * aspect
        sy = 1.0 - (float(row) + 0.5) * per_row
        return wp.normalize(forward + sx * right + sy * up)

    @wp.func
    def march(direction: wp.vec3, balls: wp.array[wp.vec4]) -> float:
        t = float(0.0)
        for _ in range(max_steps):
            d = distance(eye + t * direction, balls)
            if d < epsilon:
                break
            t += d
            if t > far:
                break
        return t

    @wp.kernel(module="unique")
    def depth(balls: wp.array[wp.vec4], picture: wp.array2d[float]) -> None:
        row, column = wp.tid()
        t = march(direction_of(row, column), balls)
        if t > far:
            t = wp.inf
        picture[row, column] = t

    @wp.kernel(module="unique")
    def shaded(balls: wp.array[wp.vec4], picture: wp.array2d[float]) -> None:
        row, column = wp.tid()
        direction = direction_of(row, column)
        t = march(direction, balls)
        if t <= far:
            picture[row, column] = shade(eye + t * direction, direction, balls)
        else:
            picture[row, column] = sky

    kernel, size = depth if task.mode == "depth" else shaded, (task.height, task.width)
    balls = wp.array(task.balls() if task.scene == "C" else np.zeros((0, 4), np.float32), dtype=wp.vec4, device="cpu")

    def render() -> NDArray[np.float32]:
        picture = wp.empty(size, dtype=float, device="cpu")
        wp.launch(kernel, dim=size, inputs=[balls], outputs=[picture], device="cpu")
        result: NDArray[np.float32] = picture.numpy()
        return result

    return render
