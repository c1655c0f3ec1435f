"""Scene C as numbers: n balls in a cube whose volume grows with n. scenes.py makes a shape of them, peers/ theirs.

README.md says the recipe; nothing here needs octomarch.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SEED = 20
SMOOTH = 0.1
VOLUME_PER_BALL = 1.0
RADII = (0.15, 0.35)
DIRECTION = (0.48, 0.36, 0.8)  # from the cube's middle to the eye, of length 1
FOV = 45.0


@dataclass(frozen=True)
class Balls:
    """Centres and radii, where they are seen from so that all are in the picture, and how far rays go to pass them."""

    centers: NDArray[np.float32]
    radii: NDArray[np.float32]
    eye: tuple[float, float, float]
    max_distance: float


def balls(n: int) -> Balls:
    """Return n balls. The same n gives the same balls, and those of another n have nothing to do with them."""
    if n < 1:
        raise ValueError(f"n must be at least 1, got {n}")
    random = np.random.default_rng([SEED, n])
    edge = (n * VOLUME_PER_BALL) ** (1 / 3)
    centers = random.uniform(-edge / 2, edge / 2, (n, 3)).astype(np.float32)
    radii = random.uniform(*RADII, n).astype(np.float32)
    around = edge * math.sqrt(3) / 2 + RADII[1]
    distance = around / math.sin(math.radians(FOV / 2))
    x, y, z = (distance * along for along in DIRECTION)
    return Balls(centers, radii, (x, y, z), max(100.0, 2 * distance))
