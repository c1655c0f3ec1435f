"""The scenes of the benchmarks as the sweeps render them: from where they are seen, lit as the peers light them.

scenes.py comes before it, the sweeps after it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import octomarch as om
from octomarch.march import Method
from peers.octomarch_engine import same_shading, scene_of
from peers.tasks import Light, Mode, Task
from scenes import EPSILON, MAX_STEPS, SCENES, spheres

MODES: Sequence[Mode] = ("depth", "shaded")


@dataclass(frozen=True)
class View:
    """A scene, bare and lit, and where it is looked at from."""

    name: str
    n: int
    shape: om.Shape
    lit: om.Scene
    camera: om.Camera
    max_distance: float

    @property
    def facts(self) -> dict[str, Any]:
        return {"scene": self.name, "n": self.n}

    def task(self, size: tuple[int, int]) -> Task:
        """Return the same for `peers.octomarch_engine.truth`."""
        return Task(
            self.name,
            "depth",
            self.camera.eye,
            *size,
            n=self.n,
            fov=self.camera.fov,
            max_steps=MAX_STEPS,
            epsilon=EPSILON,
            max_distance=self.max_distance,
        )

    def render(
        self,
        size: tuple[int, int],
        mode: Mode = "depth",
        method: Method = "auto",
        *,
        isa: str | None = None,
        precision: Literal["float32", "float64"] = "float32",
        threads: int = 1,
        prune: bool = True,
    ) -> om.Image:
        """Render with octomarch's defaults, but for what is given, how far rays go and how far occlusion reaches."""
        return om.render(
            self.shape if mode == "depth" else self.lit,
            self.camera,
            size,
            march=om.March(method, max_distance=self.max_distance, prune=prune),
            shading=same_shading(Light(), "exact"),
            planes="depth" if mode == "depth" else "color",
            isa=isa,
            precision=precision,
            threads=threads,
        )


def view(name: str, n: int = 0) -> View:
    """Return scene A or B, or C with n balls."""
    scene = spheres(n) if name == "C" else SCENES[name]()
    camera = om.Camera(scene.eye, (0, 0, 0), fov=scene.fov)
    return View(name, n, scene.shape, scene_of(scene.shape, Light()), camera, scene.max_distance)


def evaluations(image: om.Image) -> dict[str, float]:
    """Return how often programs were evaluated per pixel, by each stage."""
    width, height = image.size
    return {name: stage["evaluations"] / (width * height) for name, stage in image.stats["stages"].items()}
