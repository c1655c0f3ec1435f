"""Colours for numbers: how many evaluations a ray took, how far it went, what became of it.

All give linear colours, which `octomarch.write_png` and `image.Image` turn into what screens show.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch import _validate as check
from octomarch import png

_RED_PER_STEP = 5
_GREEN_AND_BLUE = 50

# The ramp of `colormap` in OKLCh: lightness, hue in degrees, and chroma at its ends and what it has more in between.
# No colour of it leaves the gamut of sRGB, which would bend the lightness.
_LIGHTNESS = 0.20, 0.95
_HUE = 285.0, 470.0
_CHROMA = 0.11, 0.24
_GREY = 0.6  # lightness of what is not finite


def iteration_colors(steps: ArrayLike) -> NDArray[np.float32]:
    """Colour numbers of evaluations: a picture shows (5 n, 50, 50) of 255 for n of them, the red at most 255.

    These are bytes on the screen, so the linear colours are chosen to become exactly them in a PNG file.

    Parameters
    ----------
    steps : array_like of int, shape (...,)
        ≥ 0, such as the plane ``steps`` of an image.

    Returns
    -------
    ndarray of float32, shape (..., 3)
        Linear RGB.

    Raises
    ------
    TypeError, ValueError
        If the numbers are no integers, or negative.

    Examples
    --------
    >>> import octomarch as om
    >>> image = om.render(om.sphere(1.0), size=(64, 48), planes=("steps",))
    >>> om.iteration_colors(image.steps).shape
    (48, 64, 3)
    """
    counts = _array("steps", steps)
    if counts.dtype.kind not in "iu":
        raise TypeError(f"steps must be integers, got {check.shown_array(counts, steps)}")
    if counts.size and counts.min() < 0:
        raise ValueError(f"steps must be ≥ 0, got {counts.min()}")
    colors = np.full((*counts.shape, 3), _GREEN_AND_BLUE, dtype=np.uint8)
    colors[..., 0] = np.minimum(counts, 255 // _RED_PER_STEP) * _RED_PER_STEP
    return png.linear(colors)


def colormap(values: ArrayLike, vmin: float | None = None, vmax: float | None = None) -> NDArray[np.float32]:
    """Colour numbers by a ramp from dark violet through red and orange to light yellow.

    Equal steps of the number are equal steps of perceived lightness: the ramp is a line in OKLCh [1]_, whose lightness
    grows from 0.2 to 0.95 while its hue turns from 285° to 470°. It says the same in black and white.

    Parameters
    ----------
    values : array_like of float, shape (...,)
        Numbers of any kind.
    vmin, vmax : float, optional
        What gets the first and the last colour, vmin < vmax; numbers beyond get them too. None: the least and the
        greatest of the finite values.

    Returns
    -------
    ndarray of float32, shape (..., 3)
        Linear RGB in [0, 1]; a grey where a value is not finite.

    Raises
    ------
    TypeError, ValueError
        If `values` are no real numbers, or a limit is not finite, or vmin is not less than vmax.

    References
    ----------
    .. [1] B. Ottosson, "A perceptual color space for image processing", 2020,
       https://bottosson.github.io/posts/oklab/

    Examples
    --------
    >>> import numpy as np, octomarch as om
    >>> om.colormap([0.0, 0.5, 1.0, np.inf]).astype(float).round(2).tolist()
    [[0.01, 0.0, 0.06], [0.58, 0.06, 0.09], [0.89, 0.92, 0.34], [0.22, 0.22, 0.22]]
    """
    numbers = _array("values", values)
    if numbers.dtype.kind not in "fiub":
        raise TypeError(f"values must be real numbers, got {check.shown_array(numbers, values)}")
    low = None if vmin is None else check.finite("vmin", vmin)
    high = None if vmax is None else check.finite("vmax", vmax)
    if low is not None and high is not None and low >= high:
        raise ValueError(f"vmin must be less than vmax {check.shown(vmax)}, got {check.shown(vmin)}")
    numbers = numbers.astype(np.float64)
    finite = np.isfinite(numbers)
    share = _share(np.where(finite, numbers, 0.0), numbers[finite], low, high)
    lightness = np.where(finite, _LIGHTNESS[0] + (_LIGHTNESS[1] - _LIGHTNESS[0]) * share, _GREY)
    chroma = np.where(finite, _CHROMA[0] + _CHROMA[1] * share * (1 - share), 0.0)
    return _linear_rgb(lightness, chroma, np.radians(_HUE[0] + (_HUE[1] - _HUE[0]) * share))


def _array(name: str, values: ArrayLike) -> NDArray[Any]:
    try:
        return np.asarray(values)
    except ValueError as error:  # a ragged nesting
        raise ValueError(f"{name} must be an array of numbers, got {check.shown(values)}") from error


def _share(
    numbers: NDArray[np.float64], finite: NDArray[np.float64], low: float | None, high: float | None
) -> NDArray[np.float64]:
    """Return where numbers lie between two limits, from 0 to 1."""
    low = float(finite.min(initial=np.inf)) if low is None else low
    high = float(finite.max(initial=-np.inf)) if high is None else high
    if not low < high:  # one value only, or all of them beyond the one limit that was given
        return np.where(numbers > high, 1.0, 0.0)
    # halves, since the difference of two numbers need not be one; brought within the limits first: a share need not
    return (np.clip(numbers, low, high) / 2 - low / 2) / (high / 2 - low / 2)


def _linear_rgb(
    lightness: NDArray[np.float64], chroma: NDArray[np.float64], hue: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Return the linear sRGB colours of OKLCh ones, by Ottosson's matrices."""
    a, b = chroma * np.cos(hue), chroma * np.sin(hue)
    cones = np.stack(
        [
            lightness + 0.3963377774 * a + 0.2158037573 * b,
            lightness - 0.1055613458 * a - 0.0638541728 * b,
            lightness - 0.0894841775 * a - 1.2914855480 * b,
        ],
        axis=-1,
    )
    rgb_from_cones = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    colors: NDArray[np.float64] = cones**3 @ rgb_from_cones.T
    return np.clip(colors, 0.0, 1.0).astype(np.float32)
