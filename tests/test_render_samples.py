"""Supersampling: the pattern, what the mean is of, what it costs, and what it leaves alone."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from octomarch.planes import PLANES
from test_render_crop import CAMERAS, SCENE

SIZE = (21, 18)
DATA = tuple(name for name in PLANES if name != "color")
STAGES = ("primary", "normals", "objects", "occlusion", "shadow")


def pattern(count: int) -> list[tuple[int, int]]:
    """Return the places of samples in `count` columns and rows of a pixel, as docs/semantics.md says."""
    golden = (1 + math.sqrt(5)) / 2
    keys = [(0.5 + k / golden) % 1 for k in range(count)]
    return [(k, sorted(keys).index(keys[k])) for k in range(count)]


def test_the_pattern_of_four_is_a_rotated_grid():
    assert pattern(1) == [(0, 0)]
    assert pattern(4) == [(0, 2), (1, 0), (2, 3), (3, 1)]


@pytest.mark.parametrize("count", range(2, 65))
def test_patterns_are_centred_and_spread(count: int):
    """Samples stand one to a column and a row, at least a bit over half as far apart as in a square grid."""
    points = np.array(pattern(count))
    assert_array_equal(np.sort(points, axis=0), np.arange(count)[:, None] * [1, 1])
    apart = np.linalg.norm(points[:, None] - points, axis=-1)[~np.eye(count, dtype=bool)]
    assert apart.min() / math.sqrt(count) > 0.65


def mean_of_larger(count: int, camera: object, **options) -> np.ndarray:
    """Return the mean over the pixels of a picture `count` times as large each way whose centres are the samples."""
    large = om.render(SCENE, camera, (SIZE[0] * count, SIZE[1] * count), **options).color
    return np.mean([large[row::count, column::count] for column, row in pattern(count)], axis=0)


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 16])
def test_colours_are_the_mean_of_the_samples(count: int, camera: str, isa: str):
    march = om.March(pixel_tolerance=0)  # a picture of smaller pixels has smaller tolerances
    options = {"march": march, "precision": "float64", "isa": isa}
    expected = mean_of_larger(count, CAMERAS[camera], **options)
    color = om.render(SCENE, CAMERAS[camera], SIZE, samples=count, **options).color
    assert_allclose(color, expected, atol=1e-6)  # the rays differ in rounding, and shadows magnify it


@pytest.mark.parametrize("camera", CAMERAS)
def test_the_reference_takes_the_same_samples(camera: str):
    options = {"march": om.March("plain"), "samples": 3}
    color = om.render(SCENE, CAMERAS[camera], SIZE, precision="float64", **options).color
    truth = om.reference.render(SCENE, CAMERAS[camera], SIZE, **options).color
    assert np.quantile(np.abs(color - truth), 0.98) < 1e-6  # a ray along a rim may fall either way
    single = om.reference.render(SCENE, CAMERAS[camera], SIZE).color
    assert np.quantile(np.abs(color - single), 0.98) > 1e-3


def test_bits_do_not_depend_on_threads_or_instruction_set(isa: str, precision: str):
    options = {"samples": 5, "planes": tuple(PLANES), "precision": precision}
    one = om.render(SCENE, CAMERAS["perspective"], (90, 70), threads=1, isa="scalar", **options)
    other = om.render(SCENE, CAMERAS["perspective"], (90, 70), threads=3, isa=isa, **options)
    for name in PLANES:
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name


def test_equal_colours_have_themselves_for_a_mean(isa: str):
    """Sums are in double, where those of 64 floats at most are as good as exact."""
    sky = om.Sky(toward=0, away=0, base=(0.1, 0.7, 1e30))
    scene = om.Scene(om.sphere(1.0).translate(0, 0, 100), sky=sky)
    camera = om.Camera((0, 0, 4), (0, 0, 0))
    one = om.render(scene, camera, (5, 3), isa=isa).color
    for samples in (3, 7, 64):
        assert_array_equal(om.render(scene, camera, (5, 3), samples=samples, isa=isa).color, one)


@pytest.mark.parametrize("samples", [2, 9])
def test_data_are_those_of_the_centre(samples: int, isa: str):
    several = om.render(SCENE, CAMERAS["perspective"], SIZE, samples=samples, planes=tuple(PLANES), isa=isa)
    one = om.render(SCENE, CAMERAS["perspective"], SIZE, planes=tuple(PLANES), isa=isa)
    for name in DATA:
        assert_array_equal(getattr(several, name), getattr(one, name), err_msg=name)
    assert (several.color != one.color).any()


# Costs ---------------------------------------------------------------------------------------------------------------


def counts(planes: tuple[str, ...], isa: str, **options) -> dict[str, int]:
    stats = om.render(SCENE, CAMERAS["perspective"], SIZE, planes=planes, isa=isa, **options).stats
    stages = stats["stages"]
    evaluations = {name: stages[name]["evaluations"] for name in STAGES}
    return {"rays": stats["rays"], "shadow rays": stages["shadow"]["count"], **evaluations}


def test_one_sample_costs_nothing_more(isa: str):
    for planes in (("color",), tuple(PLANES), DATA):
        assert counts(planes, isa, samples=1) == counts(planes, isa)
    assert counts(tuple(PLANES), isa)["rays"] == SIZE[0] * SIZE[1]


def test_samples_without_colours_cost_nothing(isa: str):
    assert counts(DATA, isa, samples=64) == counts(DATA, isa)


@pytest.mark.parametrize("data", [("depth",), ("steps", "status"), ("normal",), ("object_id", "position")])
def test_data_beside_samples_cost_one_pass(data: tuple[str, ...], isa: str):
    colors, alone = counts(("color",), isa, samples=4), counts(data, isa)
    assert colors["rays"] == 4 * SIZE[0] * SIZE[1]
    assert counts(("color", *data), isa, samples=4) == {name: n + alone[name] for name, n in colors.items()}


# Arguments -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("samples", "error", "message"),
    [
        (0, ValueError, r"samples must lie in \[1, 64\], got 0"),
        (65, ValueError, r"samples must lie in \[1, 64\], got 65"),
        (4.0, TypeError, r"samples must be an integer, got 4.0"),
        (True, TypeError, "samples must be an integer, got True"),
        (None, TypeError, "samples must be an integer, got None"),
    ],
)
def test_bad_samples_are_refused(samples: object, error: type[Exception], message: str):
    for render in (om.render, om.reference.render):
        with pytest.raises(error, match=message):
            render(om.sphere(1.0), size=SIZE, samples=samples)


def test_metadata_hold_the_samples():
    assert om.render(om.sphere(1.0), size=SIZE, samples=3).metadata["render"]["samples"] == 3
