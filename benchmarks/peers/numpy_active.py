"""numpy: arrays of the rays that are still under way, tile by tile so that they stay in the cache."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peers.fields import Words, field, with_ball
from peers.tasks import Task
from spheres import SMOOTH

WORDS = Words(np.sqrt, np.abs, np.minimum, np.maximum, np.floor)
TILE = 8192  # rays: their dozen arrays fill less than a megabyte

Floats = NDArray[np.float32]
Field = Callable[[Any, Any, Any], Any]


def field_of(task: Task) -> Field:
    if task.scene != "C":
        found: Field = field(WORDS, task.scene)
        return found
    balls = task.balls()  # rows of float32 numbers, so that nothing turns into double
    unite = with_ball(WORDS, SMOOTH)

    def united(x: Floats, y: Floats, z: Floats) -> Any:
        d = np.full_like(x, 1e9)
        for cx, cy, cz, radius in balls:
            d = unite(d, x - cx, y - cy, z - cz, radius)
        return d

    return united


def march(task: Task, distance: Field, px: Floats, py: Floats, pz: Floats, direction: Any) -> Floats:
    """Follow rays that may start anywhere, and return t, +inf on a miss. Those that have ended leave the arrays."""
    dx, dy, dz = direction
    result = np.empty_like(px)
    place, t = np.arange(px.size), np.zeros_like(px)
    for _ in range(task.max_steps):
        d = distance(px + t * dx, py + t * dy, pz + t * dz)
        arrived = d < task.epsilon
        t += np.where(arrived, np.float32(0), d)
        going = ~arrived & (t <= task.max_distance)
        if not going.all():
            ended = ~going
            result[place[ended]] = np.where(arrived[ended], t[ended], np.float32(np.inf))
            place, t, px, py, pz = place[going], t[going], px[going], py[going], pz[going]
            dx, dy, dz = dx[going], dy[going], dz[going]
            if not place.size:
                return result
    result[place] = t
    return result


def soft_shadow(task: Task, distance: Field, px: Floats, py: Floats, pz: Floats) -> Floats:
    """Follow rays to the light and return how much of it they see."""
    lx, ly, lz = task.light.direction
    seen, place, t = np.ones_like(px), np.arange(px.size), np.zeros_like(px)
    for _ in range(task.light.shadow_steps):
        d = distance(px + t * lx, py + t * ly, pz + t * lz)
        with np.errstate(divide="ignore", invalid="ignore"):  # at t = 0 nothing is narrowed
            nearest = np.where(t > 0, task.light.shadow_k * d / t, np.float32(1))
        nearest[d < task.epsilon] = 0
        seen[place] = np.minimum(seen[place], nearest)
        t += d
        going = (d >= task.epsilon) & (t <= task.max_distance)
        place, t, px, py, pz = place[going], t[going], px[going], py[going], pz[going]
        if not place.size:
            break
    return seen


def normals(distance: Field, px: Floats, py: Floats, pz: Floats, h: float) -> tuple[Floats, Floats, Floats]:
    gx = distance(px + h, py, pz) - distance(px - h, py, pz)
    gy = distance(px, py + h, pz) - distance(px, py - h, pz)
    gz = distance(px, py, pz + h) - distance(px, py, pz - h)
    length = np.sqrt(gx * gx + gy * gy + gz * gz)
    return gx / length, gy / length, gz / length


def shade(task: Task, distance: Field, t: Floats, direction: Any) -> Floats:
    """Return the luminance of pixels: those that have hit something are gathered, lit and put back."""
    light, (lx, ly, lz) = task.light, task.light.direction
    result = np.full_like(t, light.sky)
    hit = np.flatnonzero(np.isfinite(t))
    dx, dy, dz = (axis[hit] for axis in direction)
    px, py, pz = (np.float32(o) + t[hit] * d for o, d in zip(task.eye, (dx, dy, dz), strict=True))
    nx, ny, nz = normals(distance, px, py, pz, light.normal_step)
    px, py, pz = px + light.offset * nx, py + light.offset * ny, pz + light.offset * nz
    open_to_sky = np.ones_like(px)
    for height, weight in light.occlusion:
        d = distance(px + height * nx, py + height * ny, pz + height * nz)
        open_to_sky -= np.float32(weight) * np.clip(height - d, 0, height)
    facing = nx * lx + ny * ly + nz * lz
    lit = np.zeros_like(px)
    front = np.flatnonzero(facing > 0)
    lit[front] = soft_shadow(task, distance, px[front], py[front], pz[front])
    mirrored = 2 * facing * -(nx * dx + ny * dy + nz * dz) + (lx * dx + ly * dy + lz * dz)
    highlight = light.specular * np.maximum(mirrored, 0) ** light.exponent
    result[hit] = light.ambient * light.albedo * open_to_sky + lit * (light.albedo * facing + highlight)
    return result


def prepare(task: Task) -> Callable[[], Floats]:
    distance = field_of(task)
    right, up, forward = task.axes
    ex, ey, ez = (np.float32(value) for value in task.eye)
    aspect, pixels = task.width / task.height, task.width * task.height

    def tile(start: int) -> Floats:
        row, column = np.divmod(np.arange(start, min(start + TILE, pixels)), task.width)
        sx = ((2 * column + 1) / task.width - 1).astype(np.float32) * np.float32(aspect)
        sy = (1 - (2 * row + 1) / task.height).astype(np.float32)
        dx, dy, dz = (f + sx * r + sy * u for r, u, f in zip(right, up, forward, strict=True))
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        direction = dx / length, dy / length, dz / length
        t = march(task, distance, np.full_like(sx, ex), np.full_like(sx, ey), np.full_like(sx, ez), direction)
        return t if task.mode == "depth" else shade(task, distance, t, direction)

    def render() -> Floats:
        return np.concatenate([tile(start) for start in range(0, pixels, TILE)]).reshape(task.height, task.width)

    return render
