"""The ways to march a scene that are timed against each other: the hand-written ones, and the engine.

scenes.py comes before it, timing.py after it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import octomarch as om
from scenes import EPSILON, MAX_DISTANCE, MAX_STEPS, SIZE, Scene

# What the hand-written marches are called in tables; the order is that of the rows.
HAND_WRITTEN = {
    "scalar": "scalar by hand",
    "packet": "packet by hand",
    "block": "block by hand",
    "skip": "scalar, skipping operands",
}


@dataclass(frozen=True)
class Outcome:
    """Depth per pixel, +inf on a miss, and evaluations of the field per ray with those of idle lanes."""

    depth: NDArray[np.float32]
    computed: float


@dataclass(frozen=True)
class Contender:
    """One way to march a scene. `key` is unique within the scene."""

    key: str
    label: str
    isa: str
    run: Callable[[], Outcome]


def by_hand(module: Any, scene: Scene, isa: str, name: str) -> Contender:
    width, height = SIZE

    def run() -> Outcome:
        depth, evaluations = module.march(
            isa,
            name,
            scene.name,
            eye=scene.eye,
            target=(0.0, 0.0, 0.0),
            fov=scene.fov,
            width=width,
            height=height,
            max_steps=MAX_STEPS,
            epsilon=EPSILON,
            max_distance=MAX_DISTANCE,
        )
        return Outcome(depth, evaluations / (width * height))

    label = "scalar, -march=native, contracted" if isa == "native" else HAND_WRITTEN[name]
    return Contender(f"{isa}/{name}", label, isa, run)


def engine(scene: Scene, isa: str, threads: int, finish: Literal["secant"] | None = None) -> Contender:
    """Return `om.render` as a user calls it: compilation of the shape and the new arrays are part of what is timed."""
    march = om.March("plain", MAX_STEPS, EPSILON, pixel_tolerance=0.0, max_distance=MAX_DISTANCE, finish=finish)
    camera = scene.camera

    def run() -> Outcome:
        image = om.render(
            scene.shape, camera, SIZE, march=march, planes=("depth",), precision="float32", threads=threads, isa=isa
        )
        stats, primary = image.stats, image.stats["stages"]["primary"]
        return Outcome(image.depth, primary["evaluations"] / primary["occupancy"] / stats["rays"])

    suffix = {1: "", 2: ", two threads"}[threads] + (f", {finish} finish" if finish else "")
    key = f"{isa}/engine{threads}" + (f"-{finish}" if finish else "")
    return Contender(key, "engine" + suffix, isa, run)


def contenders(module: Any, scene: Scene, isas: list[str]) -> list[Contender]:
    """Return everything that marches `scene`, instruction set by instruction set."""
    available = module.variants()
    chosen: list[Contender] = []
    for isa in isas:
        chosen += [by_hand(module, scene, isa, name) for name in HAND_WRITTEN if (isa, name) in available]
        chosen += [engine(scene, isa, 1), engine(scene, isa, 2), engine(scene, isa, 1, "secant")]
    chosen.append(by_hand(module, scene, "native", "scalar"))
    return chosen
