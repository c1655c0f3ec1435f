"""Numba: the loop over the pixels as one writes it down, one ray at a time."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peers.numba_fields import compiled, field_of, maximum, minimum
from peers.tasks import Task

F = np.float32


@compiled
def unit(x: float, y: float, z: float) -> tuple[float, float, float]:
    scale = F(1) / math.sqrt(x * x + y * y + z * z)
    return x * scale, y * scale, z * scale


def ray_of(task: Task) -> Any:
    """Return the function from column and row of a pixel to the direction of its ray."""
    (rx, ry, rz), (ux, uy, uz), (fx, fy, fz) = (tuple(map(F, axis)) for axis in task.axes)
    pixel, left, top, half = F(2 / task.height), F(task.width / task.height), F(1), F(0.5)

    @compiled
    def ray(column: int, row: int) -> tuple[float, float, float]:
        sx = (F(column) + half) * pixel - left
        sy = top - (F(row) + half) * pixel
        return unit(fx + sx * rx + sy * ux, fy + sx * ry + sy * uy, fz + sx * rz + sy * uz)

    return ray


def march_of(task: Task, distance: Any) -> Any:
    epsilon, far, steps = F(task.epsilon), F(task.max_distance), task.max_steps

    @compiled
    def march(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float) -> float:
        t = F(0)
        for _ in range(steps):
            d = distance(ox + t * dx, oy + t * dy, oz + t * dz)
            if d < epsilon:
                return t
            t += d
            if t > far:
                break
        return t

    return march


def shade_of(task: Task, distance: Any) -> Any:
    """Return the function from a point of the surface and the ray's direction to the luminance."""
    light = task.light
    lx, ly, lz = (F(along) for along in light.direction)
    epsilon, far, steps, k = F(task.epsilon), F(task.max_distance), light.shadow_steps, F(light.shadow_k)
    h, offset, exponent = F(light.normal_step), F(light.offset), F(light.exponent)
    heights, weights = (np.array(values, F) for values in zip(*light.occlusion, strict=True))
    ambient, albedo, specular = F(light.ambient * light.albedo), F(light.albedo), F(light.specular)
    zero, one, two = F(0), F(1), F(2)

    @compiled
    def soft_shadow(px: float, py: float, pz: float) -> float:
        seen, t = one, zero
        for _ in range(steps):
            d = distance(px + t * lx, py + t * ly, pz + t * lz)
            if d < epsilon:
                return zero
            if t > zero:
                seen = minimum(seen, k * d / t)
            t += d
            if t > far:
                break
        return seen

    @compiled
    def shade(px: float, py: float, pz: float, dx: float, dy: float, dz: float) -> float:
        gx = distance(px + h, py, pz) - distance(px - h, py, pz)
        gy = distance(px, py + h, pz) - distance(px, py - h, pz)
        gz = distance(px, py, pz + h) - distance(px, py, pz - h)
        nx, ny, nz = unit(gx, gy, gz)
        px, py, pz = px + offset * nx, py + offset * ny, pz + offset * nz
        open_to_sky = one
        for i in range(heights.size):
            d = distance(px + heights[i] * nx, py + heights[i] * ny, pz + heights[i] * nz)
            open_to_sky -= weights[i] * minimum(maximum(heights[i] - d, zero), heights[i])
        luminance = ambient * open_to_sky
        facing = nx * lx + ny * ly + nz * lz
        if facing > zero:
            mirrored = lx * dx + ly * dy + lz * dz - two * facing * (nx * dx + ny * dy + nz * dz)
            highlight = specular * maximum(mirrored, zero) ** exponent
            luminance += soft_shadow(px, py, pz) * (albedo * facing + highlight)
        return luminance

    return shade


def prepare(task: Task) -> Callable[[], NDArray[np.float32]]:
    distance = field_of(task)
    ray, march, shade = ray_of(task), march_of(task, distance), shade_of(task, distance)
    ox, oy, oz = (F(value) for value in task.eye)
    far, sky = F(task.max_distance), F(task.light.sky)

    @compiled
    def depth(picture: NDArray[np.float32]) -> None:
        for row in range(picture.shape[0]):
            for column in range(picture.shape[1]):
                dx, dy, dz = ray(column, row)
                t = march(ox, oy, oz, dx, dy, dz)
                picture[row, column] = t if t <= far else np.inf

    @compiled
    def shaded(picture: NDArray[np.float32]) -> None:
        for row in range(picture.shape[0]):
            for column in range(picture.shape[1]):
                dx, dy, dz = ray(column, row)
                t = march(ox, oy, oz, dx, dy, dz)
                picture[row, column] = shade(ox + t * dx, oy + t * dy, oz + t * dz, dx, dy, dz) if t <= far else sky

    kernel = depth if task.mode == "depth" else shaded

    def render() -> NDArray[np.float32]:
        picture = np.empty((task.height, task.width), np.float32)
        kernel(picture)
        return picture

    return render
