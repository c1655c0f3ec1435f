"""Numba: packets of rays whose loops over lanes LLVM turns into SIMD code.

A packet lives in a few short arrays. Loops over lanes have a fixed length and no branches, and a lane that has ended
waits for the others. Fields are those of numba_fields.py, inlined into the loops.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peers.fields import with_ball
from peers.numba_fields import WORDS, compiled, field_of, maximum, minimum
from peers.tasks import Task
from spheres import SMOOTH

F = np.float32
LANES = 32
WIDE = 8  # lanes of a packet in a row of pixels
TALL = LANES // WIDE


def distances_of(task: Task) -> Any:
    """Return the function that fills d with the distances at the points of a packet."""
    if task.scene != "C":
        distance = field_of(task)

        @compiled
        def fill(d: Any, x: Any, y: Any, z: Any) -> None:
            for i in range(LANES):
                d[i] = distance(x[i], y[i], z[i])

        return fill
    balls, unite, far = task.balls(), with_ball(WORDS, SMOOTH), F(1e9)

    @compiled
    def fill_united(d: Any, x: Any, y: Any, z: Any) -> None:
        for i in range(LANES):
            d[i] = far
        for ball in range(balls.shape[0]):
            cx, cy, cz, radius = balls[ball]
            for i in range(LANES):
                d[i] = unite(d[i], x[i] - cx, y[i] - cy, z[i] - cz, radius)

    return fill_united


def rays_of(task: Task) -> Any:
    """Return the function that fills the directions of the packet whose upper left pixel is (column, row)."""
    (rx, ry, rz), (ux, uy, uz), (fx, fy, fz) = (tuple(map(F, axis)) for axis in task.axes)
    pixel, left, top, half, one = F(2 / task.height), F(task.width / task.height), F(1), F(0.5), F(1)

    @compiled
    def fill(column: int, row: int, dx: Any, dy: Any, dz: Any) -> None:
        for i in range(LANES):
            sx = (F(column + i % WIDE) + half) * pixel - left
            sy = top - (F(row + i // WIDE) + half) * pixel
            x, y, z = fx + sx * rx + sy * ux, fy + sx * ry + sy * uy, fz + sx * rz + sy * uz
            scale = one / math.sqrt(x * x + y * y + z * z)
            dx[i], dy[i], dz[i] = x * scale, y * scale, z * scale

    return fill


def march_of(task: Task, distances: Any) -> Any:
    epsilon, far, steps, zero = F(task.epsilon), F(task.max_distance), task.max_steps, F(0)
    eye = np.array(task.eye, F)

    @compiled
    def march(t: Any, dx: Any, dy: Any, dz: Any, x: Any, y: Any, z: Any, d: Any) -> None:
        ox, oy, oz = eye
        for i in range(LANES):
            t[i] = zero
        for _ in range(steps):
            for i in range(LANES):
                x[i], y[i], z[i] = ox + t[i] * dx[i], oy + t[i] * dy[i], oz + t[i] * dz[i]
            distances(d, x, y, z)
            moving = zero
            for i in range(LANES):
                step = d[i] if (d[i] >= epsilon) & (t[i] <= far) else zero
                t[i] += step
                moving += step
            if moving == zero:
                break

    return march


def shade_of(task: Task, distances: Any) -> Any:
    """Return the function that fills the luminance at the points p of a packet; it moves p."""
    light = task.light
    lx, ly, lz = (F(along) for along in light.direction)
    epsilon, far, steps, k = F(task.epsilon), F(task.max_distance), light.shadow_steps, F(light.shadow_k)
    h, offset, exponent = F(light.normal_step), F(light.offset), F(light.exponent)
    heights, weights = (np.array(values, F) for values in zip(*light.occlusion, strict=True))
    ambient, albedo, specular = F(light.ambient * light.albedo), F(light.albedo), F(light.specular)
    zero, one, two = F(0), F(1), F(2)

    @compiled
    def along(t: float, p: Any, n: Any, q: Any) -> None:
        for axis in range(3):
            for i in range(LANES):
                q[axis, i] = p[axis, i] + t * n[axis, i]

    @compiled
    def normals(p: Any, n: Any, d: Any) -> None:
        for axis in range(3):
            for i in range(LANES):
                p[axis, i] += h
            distances(n[axis], p[0], p[1], p[2])
            for i in range(LANES):
                p[axis, i] -= two * h
            distances(d, p[0], p[1], p[2])
            for i in range(LANES):
                p[axis, i] += h
                n[axis, i] -= d[i]
        for i in range(LANES):
            scale = one / math.sqrt(n[0, i] * n[0, i] + n[1, i] * n[1, i] + n[2, i] * n[2, i])
            for axis in range(3):
                n[axis, i] *= scale

    @compiled
    def soft_shadow(p: Any, t: Any, seen: Any, q: Any, d: Any) -> None:
        """Lanes whose `seen` is 0 to begin with ask for nothing."""
        for i in range(LANES):
            t[i] = zero
        for _ in range(steps):
            for i in range(LANES):
                q[0, i], q[1, i], q[2, i] = p[0, i] + t[i] * lx, p[1, i] + t[i] * ly, p[2, i] + t[i] * lz
            distances(d, q[0], q[1], q[2])
            moving = zero
            for i in range(LANES):
                going = (seen[i] > zero) & (t[i] <= far)
                narrow = k * d[i] / t[i] if t[i] > zero else one
                narrow = narrow if d[i] >= epsilon else zero
                seen[i] = minimum(seen[i], narrow) if going else seen[i]
                step = d[i] if going & (d[i] >= epsilon) else zero
                t[i] += step
                moving += step
            if moving == zero:
                break

    @compiled
    def shade(p: Any, dx: Any, dy: Any, dz: Any, hit: Any, n: Any, q: Any, t: Any, d: Any, seen: Any, out: Any) -> None:
        normals(p, n, d)
        along(offset, p, n, p)
        for i in range(LANES):
            out[i] = one
        for sample in range(heights.size):
            height, weight = heights[sample], weights[sample]
            along(height, p, n, q)
            distances(d, q[0], q[1], q[2])
            for i in range(LANES):
                out[i] -= weight * minimum(maximum(height - d[i], zero), height)
        lit = zero
        for i in range(LANES):
            facing = n[0, i] * lx + n[1, i] * ly + n[2, i] * lz
            seen[i] = one if (facing > zero) & (hit[i] > zero) else zero
            lit += seen[i]
        if lit > zero:
            soft_shadow(p, t, seen, q, d)
        for i in range(LANES):
            facing = n[0, i] * lx + n[1, i] * ly + n[2, i] * lz
            towards = n[0, i] * dx[i] + n[1, i] * dy[i] + n[2, i] * dz[i]
            mirrored = lx * dx[i] + ly * dy[i] + lz * dz[i] - two * facing * towards
            highlight = specular * maximum(mirrored, zero) ** exponent
            out[i] = ambient * out[i] + seen[i] * (albedo * facing + highlight)

    return shade


def prepare(task: Task) -> Callable[[], NDArray[np.float32]]:
    """Return the function that renders. The picture's size must be a multiple of the packet's."""
    distances = distances_of(task)
    rays, march, shade = rays_of(task), march_of(task, distances), shade_of(task, distances)
    eye, far, sky = np.array(task.eye, F), F(task.max_distance), F(task.light.sky)
    zero, one, shaded = F(0), F(1), task.mode == "shaded"

    @compiled
    def kernel(picture: NDArray[np.float32]) -> None:
        lanes = np.empty((16, LANES), F)
        t, d, hit, seen, out, shadow_t = lanes[0], lanes[1], lanes[2], lanes[3], lanes[4], lanes[5]
        direction, p, n = lanes[6:9], lanes[9:12], lanes[12:15]
        dx, dy, dz = direction[0], direction[1], direction[2]
        q = np.empty((3, LANES), F)
        for row in range(0, picture.shape[0], TALL):
            for column in range(0, picture.shape[1], WIDE):
                rays(column, row, dx, dy, dz)
                march(t, dx, dy, dz, p[0], p[1], p[2], d)
                if shaded:
                    hits = zero
                    for i in range(LANES):
                        hit[i] = one if t[i] <= far else zero
                        hits += hit[i]
                        for axis in range(3):
                            p[axis, i] = eye[axis] + t[i] * direction[axis, i]
                    if hits > zero:
                        shade(p, dx, dy, dz, hit, n, q, shadow_t, d, seen, out)
                    for i in range(LANES):
                        t[i] = out[i] if hit[i] > zero else sky
                for i in range(LANES):
                    picture[row + i // WIDE, column + i % WIDE] = t[i]

    def render() -> NDArray[np.float32]:
        picture = np.empty((task.height, task.width), F)
        kernel(picture)
        if not shaded:
            picture[picture > far] = np.inf
        return picture

    return render
