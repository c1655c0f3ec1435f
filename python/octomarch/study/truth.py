"""What a picture should be: the depth of each pixel proven where that is affordable, and by float64 elsewhere.

`errors` compares with it. A picture in float64 with plain steps, a hit epsilon of 1e-9 of the scene's size and steps
enough for every ray gives depth, normals and colours. `reference.certified_picture` proves the depth of as many rays as
seconds allow, which then counts; at how many the two differ is told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from octomarch import reference
from octomarch.camera import AnyCamera
from octomarch.empty import expected
from octomarch.image import Image
from octomarch.march import March, Status
from octomarch.planes import PlaneName
from octomarch.program import compile
from octomarch.progress import ask
from octomarch.queries import Floats
from octomarch.render import render
from octomarch.scene import Scene
from octomarch.shading import Shading

TruthKind: TypeAlias = Literal["auto", "certified", "float64"]
TRUTH_KINDS = ("auto", "certified", "float64")

_PROOFS = 200_000  # rays times instructions that are proven with "auto": one or two seconds
_PROOFS_AT_ONCE = 5_000  # rays times instructions between which listeners are asked
_EPSILON = 1e-9  # of the scene's size
_MAX_STEPS = 100_000
_SOLID_STEPS = 10  # times as fine as those of the march, where fixed steps are all there is
_AGREEMENT = 1e-6  # of the scene's size


@dataclass(frozen=True, eq=False)
class Answer:
    """What pictures are held against, and no more, since it may have to travel."""

    depth: NDArray[np.float64]
    normal: NDArray[np.float64]
    levels: NDArray[np.uint8]
    """The colours as sRGB."""


@dataclass(frozen=True, eq=False)
class Truth:
    """What is seen at each pixel, in float64."""

    depth: NDArray[np.float64]
    """(height, width): +inf where nothing is met, NaN where it is not known or the ray begins inside."""
    proven: NDArray[np.bool_]
    """(height, width): where the depth is certified."""
    disagreements: int
    """Proven rays at which float64 says otherwise."""
    normal: NDArray[np.float64]
    """(height, width, 3): 0 where it is not known, or the picture in float64 has none."""
    image: Image
    """The picture in float64."""

    def __str__(self) -> str:
        return told([self])

    def answer(self) -> Answer:
        """Return what pictures are held against."""
        return Answer(self.depth, self.normal, self.image.to_srgb())


def told(truths: Sequence[Truth]) -> str:
    """Say how the truth of pictures was found.

    Examples
    --------
    >>> import octomarch as om
    >>> scene, camera = om.Scene(om.sphere(1.0)), om.Camera((0, 0, 3), (0, 0, 0))
    >>> march = om.March().resolve(om.compile(scene), camera.eye)
    >>> told([find_truth(scene, camera, (32, 24), march, kind="float64")])
    'float64, plain steps, epsilon 1e-9 of the size of the scene'
    """
    share = float(np.mean(np.concatenate([truth.proven.ravel() for truth in truths])))
    if not share:
        return "float64, plain steps, epsilon 1e-9 of the size of the scene"
    rest = "" if share == 1 else ", float64 for the rest"
    differ = sum(truth.disagreements for truth in truths)
    return f"certified for {share:.1%} of the rays{rest}; float64 says otherwise at {differ} of them"


def find_truth(
    scene: Scene,
    camera: AnyCamera,
    size: tuple[int, int],
    march: March,
    shading: Shading | None = None,
    *,
    planes: tuple[PlaneName, ...] = ("color", "depth", "normal", "status"),
    kind: TruthKind = "auto",
    share: float = 1.0,
    crop: tuple[int, int, int, int] | None = None,
    threads: int | None = None,
) -> Truth:
    """Return the truth of a picture, or of a crop of it.

    Parameters
    ----------
    scene, camera, size, shading, crop, threads
        As for `octomarch.render`.
    march : March
        Resolved: how far rays go, and where they begin.
    planes : tuple of str
        Of the picture in float64; depth and status have to be there.
    kind : {"auto", "certified", "float64"}
        Prove the depth of some lines of pixels, of all, or of none.
    share : float
        Of the budget of ``"auto"``.

    Examples
    --------
    >>> import octomarch as om
    >>> scene, camera = om.Scene(om.sphere(1.0)), om.Camera((0, 0, 3), (0, 0, 0))
    >>> march = om.March().resolve(om.compile(scene), camera.eye)
    >>> truth = find_truth(scene, camera, (33, 33), march)
    >>> round(float(truth.depth[16, 16]), 9), truth.disagreements
    (2.0, 0)
    """
    with expected():
        image = render(
            scene,
            camera,
            size,
            march=truth_march(march, compile(scene).size),
            shading=shading,
            planes=planes,
            precision="float64",
            crop=crop,
            threads=threads,
        )
    depth = np.where(image.status <= Status.MISS, image.depth, np.nan)
    window = crop or (0, 0, *size)
    lines = [] if march.min_distance > 0 else _lines(window, kind, share, compile(scene).instructions)
    proven = np.zeros(depth.shape, dtype=bool)
    disagreements = 0
    for first, count in lines:
        ask()
        part = slice(first, first + count)
        known, depths = _proof(scene, camera, size, march, (window[0], window[1] + first, window[2], count), threads)
        disagreements += _disagreements(depth[part][known], depths[known], compile(scene).size)
        depth[part] = np.where(known, depths, depth[part])
        proven[part] = known
    same = _same(image.depth, depth, compile(scene).size)
    normal = image.normal if "normal" in image.planes else np.zeros((*depth.shape, 3))
    return Truth(depth, proven, disagreements, np.where(same[..., None], normal, 0.0), image)


def truth_march(march: March, size: float) -> March:
    """Return the march of the truth for resolved settings: as far, from the same place, but with no error to speak of.

    Examples
    --------
    >>> truth_march(March(max_distance=10.0), 2.0).epsilon
    2e-09
    """
    fine: dict[str, Any] = {"pixel_tolerance": 0.0, "epsilon": _EPSILON * size, "finish": "secant"}
    if march.method == "fixed" and march.step is not None:
        return replace(march, **fine, step=march.step / _SOLID_STEPS, max_steps=None)
    return replace(march, **fine, method="plain", step=None, max_steps=_MAX_STEPS)


def _lines(
    window: tuple[int, int, int, int], kind: TruthKind, share: float, instructions: int
) -> list[tuple[int, int]]:
    """Return the lines of pixels to prove as (first, count), evenly spread where they are not all."""
    _, _, width, height = window
    affordable = int(share * _PROOFS / (width * max(instructions, 1)))
    if kind == "float64":
        return []
    if kind == "certified" or affordable >= height:
        rows = max(1, _PROOFS_AT_ONCE // (width * max(instructions, 1)))
        return [(first, min(rows, height - first)) for first in range(0, height, rows)]
    count = max(affordable, 1)
    return [(int((i + 0.5) * height / count), 1) for i in range(count)]


def _proof(
    scene: Scene,
    camera: AnyCamera,
    size: tuple[int, int],
    march: March,
    crop: tuple[int, int, int, int],
    threads: int | None,
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return where something is proven, and the depth that is; NaN for rays that begin inside."""
    verdict = reference.Verdict
    found = reference.certified_picture(scene, camera, size, march.max_distance, crop=crop, threads=threads)
    with np.errstate(invalid="ignore"):  # infinite less infinite where nothing is met
        middle = found.t_lo + (found.t_hi - found.t_lo) / 2
    depth = np.select([found.status == verdict.HIT, found.status == verdict.MISS], [middle, np.inf], np.nan)
    return found.status != verdict.UNDECIDED, depth


def _disagreements(depth: NDArray[np.float64], proven: NDArray[np.float64], size: float) -> int:
    """Return how many depths differ from those that are proven, where both are known."""
    known = ~np.isnan(depth) & ~np.isnan(proven)
    return int(np.count_nonzero(known & ~_same(depth, proven, size)))


def _same(depth: Floats, truth: NDArray[np.float64], size: float) -> NDArray[np.bool_]:
    with np.errstate(invalid="ignore"):  # infinite less infinite, and no numbers
        same: NDArray[np.bool_] = (depth == truth) | (np.abs(depth - truth) <= _AGREEMENT * np.maximum(size, truth))
    return same
