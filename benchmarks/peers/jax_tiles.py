"""JAX on the CPU: one jitted function over tiles of rays, so that the arrays of a step stay in the cache.

A loop of a tile goes on until its last ray has ended; `lax.map` walks over the tiles.
"""

import os

os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false --xla_cpu_enable_fast_math=true"

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from numpy.typing import NDArray

from peers.fields import Words, field, with_ball
from peers.tasks import Task
from spheres import SMOOTH

WORDS = Words(jnp.sqrt, jnp.abs, jnp.minimum, jnp.maximum, jnp.floor)
TILE = 5120  # rays

Vectors = tuple[Any, Any, Any]  # of arrays, or of numbers that are the same for all rays


def along(p: Vectors, t: Any, direction: Vectors) -> Vectors:
    x, y, z = (a + t * b for a, b in zip(p, direction, strict=True))
    return x, y, z


def dot(a: Vectors, b: Vectors) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(a: Vectors) -> Vectors:
    return along((0.0, 0.0, 0.0), 1 / jnp.sqrt(dot(a, a)), a)


def field_of(task: Task) -> Callable[..., Any]:
    if task.scene != "C":
        found: Callable[..., Any] = field(WORDS, task.scene)
        return found
    balls, unite = jnp.asarray(task.balls()), with_ball(WORDS, SMOOTH)

    def united(x: Any, y: Any, z: Any) -> Any:
        def step(i: Any, d: Any) -> Any:
            cx, cy, cz, radius = balls[i]
            return unite(d, x - cx, y - cy, z - cz, radius)

        return lax.fori_loop(0, task.n, step, jnp.full_like(x, 1e9))

    return united


def march(task: Task, distance: Callable[..., Any], direction: Vectors) -> Any:
    def going(state: Any) -> Any:
        _, active, steps = state
        return active.any() & (steps < task.max_steps)

    def step(state: Any) -> Any:
        t, active, steps = state
        d = distance(*along(task.eye, t, direction))
        active &= d >= task.epsilon
        t = jnp.where(active, t + d, t)
        return t, active & (t <= task.max_distance), steps + 1

    t = jnp.zeros_like(direction[0])
    return lax.while_loop(going, step, (t, jnp.full_like(t, True, bool), 0))[0]


def soft_shadow(task: Task, distance: Callable[..., Any], p: Vectors, wanted: Any) -> Any:
    light = task.light

    def going(state: Any) -> Any:
        _, _, active, steps = state
        return active.any() & (steps < light.shadow_steps)

    def step(state: Any) -> Any:
        seen, t, active, steps = state
        d = distance(*along(p, t, light.direction))
        narrow = jnp.where(t > 0, light.shadow_k * d / t, 1.0)
        narrow = jnp.where(d < task.epsilon, 0.0, narrow)
        seen = jnp.where(active, jnp.minimum(seen, narrow), seen)
        active &= d >= task.epsilon
        t = jnp.where(active, t + d, t)
        return seen, t, active & (t <= task.max_distance), steps + 1

    return lax.while_loop(going, step, (jnp.ones_like(p[0]), jnp.zeros_like(p[0]), wanted, 0))[0]


def shade(task: Task, distance: Callable[..., Any], p: Vectors, direction: Vectors, hit: Any) -> Any:
    light, h = task.light, task.light.normal_step
    x, y, z = p
    gx = distance(x + h, y, z) - distance(x - h, y, z)
    gy = distance(x, y + h, z) - distance(x, y - h, z)
    gz = distance(x, y, z + h) - distance(x, y, z - h)
    n = unit((gx, gy, gz))
    p = along(p, light.offset, n)
    open_to_sky = 1.0
    for height, weight in light.occlusion:
        open_to_sky -= weight * jnp.clip(height - distance(*along(p, height, n)), 0, height)
    facing = dot(n, light.direction)
    mirrored = dot(light.direction, direction) - 2 * facing * dot(n, direction)
    highlight = light.specular * jnp.maximum(mirrored, 0) ** light.exponent
    front = hit & (facing > 0)
    lit = soft_shadow(task, distance, p, front) * (light.albedo * facing + highlight)
    return light.ambient * light.albedo * open_to_sky + jnp.where(front, lit, 0.0)


def prepare(task: Task) -> Callable[[], NDArray[np.float32]]:
    distance, (right, up, forward) = field_of(task), task.axes
    pixels = task.width * task.height
    tile = next(size for size in range(min(TILE, pixels), 0, -1) if pixels % size == 0)

    def paint(start: Any) -> Any:
        row, column = jnp.divmod(start + jnp.arange(tile), task.width)
        sx = ((column + 0.5) * (2 / task.width) - 1) * (task.width / task.height)
        sy = 1 - (row + 0.5) * (2 / task.height)
        direction = unit(along(along(forward, sx, right), sy, up))
        t = march(task, distance, direction)
        hit = t <= task.max_distance
        if task.mode == "depth":
            return jnp.where(hit, t, jnp.inf)
        return jnp.where(hit, shade(task, distance, along(task.eye, t, direction), direction, hit), task.light.sky)

    picture = jax.jit(lambda: lax.map(paint, jnp.arange(0, pixels, tile)))

    def render() -> NDArray[np.float32]:
        return np.array(picture()).reshape(task.height, task.width)

    return render
