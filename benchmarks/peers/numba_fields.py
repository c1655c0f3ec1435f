"""The fields for Numba, compiled with fast-math, which all that calls them is too. numba_rays.py comes after it."""

import math
from typing import Any

import numpy as np
from numba import njit

from peers.fields import Words, field, with_ball
from peers.tasks import Task
from spheres import SMOOTH

compiled = njit(fastmath=True, error_model="numpy")


@compiled
def minimum(a: float, b: float) -> float:
    return a if a < b else b


@compiled
def maximum(a: float, b: float) -> float:
    return a if a > b else b


WORDS = Words(math.sqrt, abs, minimum, maximum, np.floor, np.float32, compiled)


def field_of(task: Task) -> Any:
    if task.scene != "C":
        return field(WORDS, task.scene)
    balls = task.balls()
    far, unite = np.float32(1e9), with_ball(WORDS, SMOOTH)

    @compiled
    def united(x: float, y: float, z: float) -> float:
        d = far
        for i in range(balls.shape[0]):
            d = unite(d, x - balls[i, 0], y - balls[i, 1], z - balls[i, 2], balls[i, 3])
        return d

    return united
