"""Colours of numbers: exactly the bytes that are promised, and a ramp as even as OKLab says."""

import numpy as np
import PIL.Image
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om


def oklab(rgb: np.ndarray) -> np.ndarray:
    """Return L, a, b of linear sRGB, the way that Ottosson gives first: through the responses of cones."""
    cones_from_rgb = np.array(
        [
            [0.4122214708, 0.5363325363, 0.0514459929],
            [0.2119034982, 0.6806995451, 0.1073969566],
            [0.0883024619, 0.2817188376, 0.6299787005],
        ]
    )
    lab_from_cones = np.array(
        [
            [0.2104542553, 0.7936177850, -0.0040720468],
            [1.9779984951, -2.4285922050, 0.4505937099],
            [0.0259040371, 0.7827717662, -0.8086757660],
        ]
    )
    return np.cbrt(rgb.astype(np.float64) @ cones_from_rgb.T) @ lab_from_cones.T


def test_iterations_become_their_bytes(tmp_path):
    steps = np.arange(300).reshape(15, 20)
    om.write_png(tmp_path / "steps.png", om.iteration_colors(steps))
    with PIL.Image.open(tmp_path / "steps.png") as png:
        pixels = np.asarray(png)
    assert_array_equal(pixels[..., 0], np.minimum(5 * steps, 255))
    assert_array_equal(pixels[..., 1:], 50)


def test_iterations_of_any_integers_and_shape():
    largest = np.array([2**62, 2**31 - 1, 51, 0])
    assert_array_equal(om.iteration_colors(largest)[:3], np.broadcast_to(om.iteration_colors(51), (3, 3)))
    assert om.iteration_colors(np.zeros((2, 0), np.uint8)).shape == (2, 0, 3)
    assert om.iteration_colors(7).dtype == np.float32


@pytest.mark.parametrize(
    ("steps", "error", "message"),
    [
        (np.ones(3), TypeError, "steps must be integers, got an array of dtype float64"),
        ([True], TypeError, "steps must be integers"),
        ([3, -1], ValueError, "steps must be ≥ 0, got -1"),
    ],
)
def test_bad_iterations_are_refused(steps: object, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.iteration_colors(steps)


def test_the_ramp_is_even_and_in_gamut():
    """Its lightness is a line, to the seven digits of Ottosson's matrices; no clipping has bent it."""
    share = np.linspace(0, 1, 2001)
    colors = om.colormap(share)
    assert colors.shape == (2001, 3)
    assert colors.dtype == np.float32
    assert (colors > 0).all()
    assert (colors < 1).all()
    lightness, a, b = oklab(colors).T
    assert_allclose(lightness, 0.2 + 0.75 * share, atol=1e-6)
    hue = np.unwrap(np.arctan2(b, a))
    assert_allclose(np.degrees(hue - hue[0]), 185 * share, atol=1e-3)
    assert (np.hypot(a, b) > 0.1).all()


def test_the_ramp_runs_from_the_least_to_the_greatest_finite_value():
    ends = om.colormap([0.0, 1.0])
    assert_array_equal(om.colormap([[-np.inf, 3, 7], [np.nan, 11, np.inf]])[:, 1], ends)
    assert_array_equal(om.colormap([-5, 2, 4, 9], 2, 4), ends[[0, 0, 1, 1]])
    assert_array_equal(om.colormap([False, True]), ends)


def test_what_is_not_finite_is_grey():
    grey = om.colormap([np.nan, np.inf, -np.inf, 0.5])
    assert_array_equal(grey[:3, 0], grey[:3, 1])
    assert_array_equal(grey[:3, 0], grey[:3, 2])
    assert_allclose(oklab(grey[:3])[:, 0], 0.6, atol=1e-6)
    assert_allclose(om.colormap(np.full((2, 2), np.inf)), np.broadcast_to(grey[0], (2, 2, 3)))


@given(
    values=st.lists(st.floats(width=64), max_size=6),
    vmin=st.none() | st.floats(allow_nan=False, allow_infinity=False),
    vmax=st.none() | st.floats(allow_nan=False, allow_infinity=False),
)
@example(values=[2.0**1023], vmin=-0.5, vmax=0.0)  # a share of the way beyond all numbers
def test_any_numbers_have_colours(values: list[float], vmin: float | None, vmax: float | None):
    if vmin is not None and vmax is not None and vmin >= vmax:
        return
    colors = om.colormap(np.array(values, dtype=np.float64), vmin, vmax)
    assert colors.shape == (len(values), 3)
    assert ((colors >= 0) & (colors <= 1)).all()
    finite = np.isfinite(values)
    order = np.argsort(np.array(values)[finite], kind="stable")
    assert (np.diff(oklab(colors[finite][order])[:, 0]) >= -1e-6).all()


def test_one_value_has_the_first_colour_and_all_beyond_a_limit_the_last():
    first, last = om.colormap([0.0, 1.0])
    assert_array_equal(om.colormap([4, 4]), [first, first])
    assert_array_equal(om.colormap([4, 5], vmax=3), [last, last])
    assert_array_equal(om.colormap([4, 5], vmin=6), [first, first])


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (("red",), TypeError, r"values must be real numbers, got"),
        (([1j],), TypeError, "values must be real numbers"),
        (([[1, 2], [3]],), ValueError, "values must be an array of numbers"),
        (([1], 2, 2), ValueError, "vmin must be less than vmax 2, got 2"),
        (([1], np.nan), ValueError, "vmin must be finite"),
        (([1], None, np.inf), ValueError, "vmax must be finite"),
        (([1], "low"), TypeError, "vmin must be a number"),
    ],
)
def test_bad_values_are_refused(arguments: tuple, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        om.colormap(*arguments)


# Planes of pictures ---------------------------------------------------------------------------------------------------

IMAGE = om.render(om.sphere(1.0), size=(24, 16), planes=("depth", "normal", "steps", "status", "object_id"))


def test_planes_in_false_colours_are_those_of_their_numbers():
    assert_array_equal(IMAGE.false_color(), om.colormap(IMAGE.steps))
    assert_array_equal(IMAGE.false_color(map="iterations"), om.iteration_colors(IMAGE.steps))
    assert_array_equal(IMAGE.false_color("depth", vmin=2, vmax=5), om.colormap(IMAGE.depth, 2, 5))
    assert_array_equal(IMAGE.false_color("object_id"), om.colormap(IMAGE.object_id))


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (("material_id",), AttributeError, "material_id was not rendered"),
        (("normal",), ValueError, "plane must be one of 'depth', .*got 'normal'"),
        ((3,), TypeError, "plane must be one of"),
        (("steps", "viridis"), ValueError, "map must be one of 'perceptual', 'iterations', got 'viridis'"),
        (("depth", "iterations"), TypeError, "steps must be integers"),
        (("object_id", "iterations"), ValueError, "steps must be ≥ 0, got -1"),
        (("steps", "iterations", 3), ValueError, "vmin must be None for the map 'iterations', got 3"),
        (("steps", "iterations", None, 3), ValueError, "vmax must be None for the map 'iterations', got 3"),
    ],
)
def test_bad_false_colours_are_refused(arguments: tuple, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        IMAGE.false_color(*arguments)
