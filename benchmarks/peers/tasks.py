"""What a peer is asked for: scene, camera, march and light as numbers. compare.py sends it, worker.py reads it."""

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from spheres import balls

Mode = Literal["depth", "shaded"]
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """How "shaded" is lit. One grey, one light without end; `direction` leads to the light and has length 1."""

    direction: Vector = (1 / math.sqrt(6), 2 / math.sqrt(6), 1 / math.sqrt(6))
    normal_step: float = 1e-3
    offset: float = 2e-3  # from the surface, along the normal, where shadow rays and occlusion begin
    shadow_steps: int = 64
    shadow_k: float = 32.0
    occlusion_samples: int = 5
    occlusion_distance: float = 0.5
    ambient: float = 0.2
    albedo: float = 0.8
    specular: float = 0.3
    exponent: float = 30.0
    sky: float = 0.5

    @property
    def occlusion(self) -> list[tuple[float, float]]:
        """Heights above the surface and weights, which sum to 1 over a surface with nothing near."""
        heights = [self.occlusion_distance * (i / self.occlusion_samples) ** 2 for i in self._numbers]
        total = sum(height / 2**i for i, height in zip(self._numbers, heights, strict=True))
        return [(height, 1 / 2**i / total) for i, height in zip(self._numbers, heights, strict=True)]

    @property
    def _numbers(self) -> range:
        return range(1, self.occlusion_samples + 1)


@dataclass(frozen=True)
class Task:
    """One picture. "depth" is t per pixel, +inf on a miss; "shaded" is the luminance per pixel, float32 both."""

    scene: str
    mode: Mode
    eye: Vector
    width: int
    height: int
    n: int = 0  # balls of scene C
    fov: float = 45.0
    max_steps: int = 256
    epsilon: float = 1e-3
    max_distance: float = 100.0
    light: Light = Light()

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Right, up and forward for a camera that looks at the origin. A pixel is right·sx + up·sy + forward.

        Right and up have the length of half the picture's height at distance 1.
        """
        forward = -np.asarray(self.eye) / np.linalg.norm(self.eye)
        right = np.cross(forward, (0.0, 1.0, 0.0))
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        half = math.tan(math.radians(self.fov) / 2)
        return _vector(right * half), _vector(up * half), _vector(forward)

    def balls(self) -> NDArray[np.float32]:
        """Return centre and radius of the balls of scene C, (n, 4)."""
        recipe = balls(self.n)
        return np.column_stack([recipe.centers, recipe.radii])

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, values: dict[str, Any]) -> "Task":
        light = Light(**{**values["light"], "direction": tuple(values["light"]["direction"])})
        return cls(**{**values, "eye": tuple(values["eye"]), "light": light})


def _vector(values: NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
