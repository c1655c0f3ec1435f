"""Many shapes from arrays: the same nodes as one by one, and arguments refused by name, row and value."""

import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import octomarch as om

NAN, INF = float("nan"), float("inf")
MANY = 100_000
CENTERS = np.array([[0, 0, 0], [1.5, -2, 0.25], [-0.0, 3, 0], [1.5, -2, 0.25]])
RADII = np.array([1, 0.5, 0, 0.5])
SIZES = np.array([[1, 2, 3], [0, 0, 0], [1, 2, 3], [0.1, 0.2, 0.3]])
BRICK = om.box((1, 2, 3)) - om.sphere(0.75)

numbers = st.floats(-1e6, 1e6) | st.sampled_from([0.0, -0.0, 1.0, 0.1])
lengths = st.floats(0, 1e6) | st.sampled_from([0.0, -0.0, 1.0])
points = st.tuples(numbers, numbers, numbers)
offsets = st.tuples(*[st.floats(-9, 9) | st.just(0.0)] * 3)
blends = st.sampled_from([0.0, 0.1, 3])
angles = st.integers(-3600, 3600).map(lambda tenths: tenths / 10)
turns = st.sampled_from(["x", "y", "z", (1, 2, 3), (-0.3, 0.1, 0.2)])


def crowd(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return centers and radii, all different."""
    random = np.random.default_rng(5)
    return random.uniform(-50, 50, (count, 3)), random.uniform(0.1, 0.4, count)


def placed(matrix: Any, offset: Any = (0, 0, 0)) -> np.ndarray:
    return np.column_stack([np.asarray(matrix, dtype=np.float64), offset])


def rotation(degrees: float, axis: Any) -> np.ndarray:
    """Return the matrix by which shapes are rotated."""
    node = om.sphere(1.0).rotate(degrees, axis)._node
    return np.reshape(node.parameters, (3, 3)) if node.kind == "rotate" else np.eye(3)


# One by one -----------------------------------------------------------------------------------------------------------


@given(st.lists(st.tuples(points, lengths), min_size=1, max_size=5), blends)
def test_spheres_are_a_union_of_spheres(balls: list[tuple[tuple[float, ...], float]], smooth: float):
    centers, radii = zip(*balls, strict=True)
    one_by_one = om.union(*(om.sphere(radius, center) for center, radius in balls), smooth=smooth)
    assert om.spheres(centers, radii, smooth) == one_by_one


@given(st.lists(st.tuples(points, st.tuples(lengths, lengths, lengths)), min_size=1, max_size=5), blends)
def test_boxes_are_a_union_of_boxes(given_boxes: list[tuple[tuple[float, ...], tuple[float, ...]]], smooth: float):
    centers, sizes = zip(*given_boxes, strict=True)
    one_by_one = om.union(*(om.box(size, center) for center, size in given_boxes), smooth=smooth)
    assert om.boxes(centers, sizes, smooth) == one_by_one


@given(st.lists(st.tuples(points, points, lengths), min_size=1, max_size=5), blends)
def test_capsules_are_a_union_of_capsules(rods: list[tuple[Any, Any, float]], smooth: float):
    a, b, radii = zip(*rods, strict=True)
    assert om.capsules(a, b, radii, smooth) == om.union(*(om.capsule(*rod) for rod in rods), smooth=smooth)


@given(
    st.lists(st.tuples(st.sampled_from([1, 2, 0.25]), angles, turns, offsets), min_size=1, max_size=5),
    blends,
)
def test_instances_are_a_union_of_placed_copies(places: list[tuple[float, float, Any, Any]], smooth: float):
    matrices = [placed(rotation(degrees, axis) * factor, offset) for factor, degrees, axis, offset in places]
    copies = (BRICK.scale(s).rotate(degrees, axis).translate(to) for s, degrees, axis, to in places)
    many, one_by_one = BRICK.instances(matrices, smooth), om.union(*copies, smooth=smooth)
    where = np.random.default_rng(1).uniform(-3, 3, (50, 3)) + matrices[0][:, 3]
    assert many.distance(where) == pytest.approx(one_by_one.distance(where), rel=1e-12, abs=1e-13)


def test_matrices_of_rotate_are_taken_as_they_are():
    for degrees in (0, 33, 90, -120, 180, 270):
        for axis in ("x", "z", (1, 2, 3)):
            turned = BRICK.rotate(degrees, axis).translate(1, 2, 3)
            assert BRICK.instances([placed(rotation(degrees, axis), (1, 2, 3))]) == turned


@pytest.mark.parametrize("smooth", [0.0, 0.3])
def test_fields_have_the_same_bits(smooth: float):
    centers, radii = crowd(200)
    one_by_one = om.union(*map(om.sphere, radii, centers), smooth=smooth)
    where = np.random.default_rng(2).uniform(-60, 60, (500, 3))
    for precision in ("float32", "float64"):
        expected = one_by_one.distance(where, precision=precision)
        assert np.array_equal(om.spheres(centers, radii, smooth).distance(where, precision=precision), expected)


def test_one_row_is_the_shape_itself():
    assert om.spheres([(1, 2, 3)], [0.5], smooth=1) == om.sphere(0.5, (1, 2, 3))
    assert om.boxes([(1, 2, 3)], [(4, 5, 6)]) == om.box((4, 5, 6), (1, 2, 3))
    assert om.capsules([(1, 2, 3)], [(4, 5, 6)], [1]) == om.capsule((1, 2, 3), (4, 5, 6), 1)
    assert BRICK.instances([np.eye(4)]) == BRICK


# Arrays ---------------------------------------------------------------------------------------------------------------


def test_one_length_serves_all():
    assert om.spheres(CENTERS, 0.5) == om.spheres(CENTERS, [0.5] * 4) == om.spheres(CENTERS, np.float32(0.5))
    assert om.capsules(CENTERS, CENTERS + 1, 0.5) == om.capsules(CENTERS, CENTERS + 1, [0.5] * 4)
    assert om.boxes(CENTERS, 2) == om.boxes(CENTERS, (2, 2, 2)) == om.boxes(CENTERS, [[2]] * 4)
    assert om.boxes(CENTERS, (1, 2, 3)) == om.boxes(CENTERS, [(1, 2, 3)] * 4)
    assert om.boxes(CENTERS[:3], (1, 2, 3)) == om.boxes(CENTERS[:3], [(1, 2, 3)] * 3)  # not three cubes


ARRAYS: dict[str, Callable[[np.ndarray], Any]] = {
    "lists": lambda array: array.tolist(),
    "float32": lambda array: array.astype(np.float32),
    "big endian": lambda array: array.astype(">f8"),
    "long double": lambda array: array.astype(np.longdouble),
    "column by column": np.asfortranarray,
    "every other row": lambda array: np.repeat(array, 2, axis=0)[::2],
    "backwards": lambda array: array[::-1].copy()[::-1],
}


@pytest.mark.parametrize("kind", ARRAYS)
def test_numbers_may_lie_in_memory_in_any_way(kind: str):
    form, exact = ARRAYS[kind], np.array([[0, 1, 2], [0.5, -0.25, 8], [1, 1, 1.0]])
    assert om.spheres(form(exact), form(exact[:, 1] ** 2)) == om.spheres(exact, exact[:, 1] ** 2)
    matrices = np.stack([placed(np.eye(3) * 2, row) for row in exact])
    assert BRICK.instances(form(matrices)) == BRICK.instances(matrices)


def test_arrays_are_only_read():
    centers, radii = crowd(3)
    kept = centers.copy(), radii.copy()
    for array in (centers, radii):
        array.setflags(write=False)
    shape = om.spheres(centers, radii)
    assert np.array_equal(centers, kept[0])
    assert shape == om.spheres(*kept)
    changing = kept[0].copy()
    before = om.spheres(changing, kept[1])
    changing[:] = 0
    assert before == shape


def test_whole_numbers_are_numbers():
    assert om.spheres(np.array([[1, 2, 3]]), np.array([4], dtype=np.uint8)) == om.sphere(4, (1, 2, 3))


# Matrices -------------------------------------------------------------------------------------------------------------


def turned_by_numpy(degrees: float, kind: Any) -> np.ndarray:
    angle = kind(np.radians(degrees))
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.zeros((4, 4), dtype=kind)
    matrix[:3, :3] = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    matrix[3, 3] = 1
    return matrix


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("degrees", [0, 90, 180, 270, -90])
def test_quarter_turns_off_by_rounding_are_exact(degrees: float, kind: Any):
    matrix = turned_by_numpy(degrees, kind)
    assert BRICK.instances([matrix]) == BRICK.rotate(degrees, "z")
    matrix[:3, :3] *= 2
    assert BRICK.instances([matrix]) == BRICK.scale(2).rotate(degrees, "z")


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("factor", [1, 2, 0.3, 1.7, 1e-3])
def test_flat_shapes_stay_flat_when_turned_in_their_plane(factor: float, kind: Any):
    matrices = [turned_by_numpy(degrees, kind) for degrees in (0, 1, 33, 60, 90, 123.4, 180.5, 270)]
    for matrix in matrices:
        matrix[:3, :3] *= factor
        matrix[:2, 3] = 1, 2
    om.rectangle((1, 2)).instances(matrices).extrude(1)
    with pytest.raises(ValueError, match="flat"):
        om.rectangle((1, 2)).instances([placed(rotation(1e-5, "x"))]).extrude(1)


def test_small_turns_are_not_lost():
    assert BRICK.instances([turned_by_numpy(1e-9, np.float64)]) != BRICK
    assert BRICK.instances([turned_by_numpy(90 + 1e-9, np.float64)]) != BRICK.rotate(90, "z")


@given(angles, turns, st.floats(1e-3, 1e3))
def test_turned_and_scaled_shapes_keep_true_distances(degrees: float, axis: Any, factor: float):
    copy = BRICK.instances([placed(rotation(degrees, axis) * factor)])
    where = np.random.default_rng(3).uniform(-3, 3, (20, 3))
    images = where @ (rotation(degrees, axis) * factor).T
    assert copy.distance(images) == pytest.approx(BRICK.distance(where) * factor, rel=1e-11, abs=1e-11 * factor)


@given(angles, turns, st.integers(0, 2**32 - 1), st.sampled_from([1e-12, 1e-9, 1e-7, 2e-6]))
def test_rotations_slightly_off_become_the_nearest(degrees: float, axis: Any, seed: int, noise: float):
    exact = rotation(degrees, axis)
    given_matrix = exact + np.random.default_rng(seed).uniform(-noise, noise, (3, 3))
    node = om.box(1).instances([placed(given_matrix)])._node
    while node.kind != "rotate":
        node = node.children[0]
    taken = np.reshape(node.parameters, (3, 3))
    assert np.abs(taken @ taken.T - np.eye(3)).max() < 1e-15
    assert np.linalg.det(taken) > 0
    u, sizes, v = np.linalg.svd(given_matrix)  # the polar factor is the nearest orthonormal matrix
    assert taken == pytest.approx(u @ v, abs=1e-14 + noise**2)
    assert np.ptp(sizes) < 1e-4


@given(st.floats(1e-300, 1e300))
def test_factors_are_exact_where_nothing_is_turned(factor: float):
    assert BRICK.instances([placed(np.eye(3) * factor)]) == BRICK.scale(factor)


# Refused --------------------------------------------------------------------------------------------------------------

EYE = np.eye(4)
ROTATED = turned_by_numpy(30, np.float64)


def spoilt(row: int, column: int, value: float, matrix: np.ndarray = EYE) -> list[np.ndarray]:
    """Return three matrices, the last with another entry."""
    result = matrix.copy()
    result[row, column] = value
    return [EYE, ROTATED, result]


VALUES: dict[str, tuple[Callable[[], Any], str]] = {
    "center": (
        lambda: om.spheres([(0, 0, 0), (1, NAN, 2)], 1),
        "centers[1] must be finite, got (1, nan, 2)",
    ),
    "endless center": (lambda: om.boxes([(0, INF, 0)], 1), "centers[0] must be finite, got (0, inf, 0)"),
    "radius": (
        lambda: om.spheres(CENTERS, [1, 2, -0.5, NAN]),
        "radii[2] must be finite and >= 0, got -0.5",
    ),
    "radius nan": (lambda: om.spheres(CENTERS, NAN), "radii[0] must be finite and >= 0, got nan"),
    "size": (
        lambda: om.boxes(CENTERS, [(1, 1, 1), (1, 1, -1), (1, 1, 1), (1, 1, 1)]),
        "sizes[1] must be finite and >= 0 on every axis, got (1, 1, -1)",
    ),
    "end": (lambda: om.capsules([(0, 0, 0)], [(0, 0, INF)], 1), "b[0] must be finite, got (0, 0, inf)"),
    "beginning": (lambda: om.capsules([(NAN, 0, 0)], [(0, 0, 0)], 1), "a[0] must be finite, got (nan, 0, 0)"),
    "capsule's radius": (
        lambda: om.capsules(CENTERS, CENTERS, [0, 0, 0, INF]),
        "radii[3] must be finite and >= 0, got inf",
    ),
    "blend": (lambda: om.spheres(CENTERS, 1, smooth=-1), "smooth must be finite and >= 0, got -1"),
    "blend of copies": (lambda: BRICK.instances([EYE], NAN), "smooth must be finite and >= 0, got nan"),
    "no center": (
        lambda: om.spheres(np.zeros((0, 3)), []),
        "centers must have shape (n, 3) with n ≥ 1, got shape (0, 3)",
    ),
    "nothing": (lambda: om.boxes([], []), "centers must have shape (n, 3) with n ≥ 1, got shape (0,)"),
    "no capsule": (lambda: om.capsules([], [], 1), "a must have shape (n, 3) with n ≥ 1, got shape (0,)"),
    "no matrix": (
        lambda: BRICK.instances(np.zeros((0, 4, 4))),
        "matrices must have shape (n, 3, 4) or (n, 4, 4) with n ≥ 1, got shape (0, 4, 4)",
    ),
    "one center": (lambda: om.spheres((1, 2, 3), 1), "centers must have shape (n, 3) with n ≥ 1, got shape (3,)"),
    "flat centers": (lambda: om.spheres([(1, 2)], 1), "centers must have shape (n, 3) with n ≥ 1, got shape (1, 2)"),
    "deep centers": (lambda: om.boxes([[(1, 2, 3)]], 1), "got shape (1, 1, 3)"),
    "too few radii": (lambda: om.spheres(CENTERS, [1, 2]), "radii must broadcast to shape (4,), got shape (2,)"),
    "radii in a column": (
        lambda: om.spheres(CENTERS, [[1]] * 4),
        "radii must broadcast to shape (4,), got shape (4, 1)",
    ),
    "sizes in a row": (lambda: om.boxes(CENTERS, [1] * 4), "sizes must broadcast to shape (4, 3), got shape (4,)"),
    "too few ends": (lambda: om.capsules(CENTERS, CENTERS[:3], 1), "b must have as many rows as a, 4, got 3"),
    "ragged": (lambda: om.spheres([(1, 2, 3), (4, 5)], 1), "centers must have shape (n, 3), got [(1, 2, 3), (4, 5)]"),
    "one matrix": (lambda: BRICK.instances(EYE), "got shape (4, 4)"),
    "small matrices": (lambda: BRICK.instances([np.eye(3)]), "got shape (1, 3, 3)"),
    "last row": (
        lambda: BRICK.instances(spoilt(3, 0, 0.5)),
        "matrices[2] must end in the row (0, 0, 0, 1), got (0.5, 0.0, 0.0, 1.0)",
    ),
    "last row nan": (lambda: BRICK.instances(spoilt(3, 3, NAN)), "matrices[2] must end in the row (0, 0, 0, 1)"),
    "entry": (
        lambda: BRICK.instances(spoilt(0, 1, NAN)),
        "matrices[2] must be finite, got ((1, nan, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))",
    ),
    "offset": (
        lambda: BRICK.instances(spoilt(1, 3, INF)),
        "matrices[2] must be finite, got ((1, 0, 0, 0), (0, 1, 0, inf)",
    ),
    "reflection": (
        lambda: BRICK.instances(spoilt(0, 0, -1)),
        "matrices[2] must be a rotation times one factor > 0, without reflection, got ((-1, 0, 0, 0), (0, 1, 0, 0), ",
    ),
    "turned reflection": (
        lambda: BRICK.instances([-ROTATED[:3]]),
        "matrices[0] must be a rotation times one factor > 0, wi",
    ),
    "zero": (
        lambda: BRICK.instances([np.zeros((3, 4))]),
        "matrices[0] must be a rotation times a factor that is finite and > 0, got ((0, 0, 0, 0), ",
    ),
    "shear": (
        lambda: BRICK.instances(spoilt(0, 1, 1e-4)),
        "matrices[2] must be a rotation times one factor > 0, without shear or stretch, got ((1, 1e-04, 0, 0)",
    ),
    "stretch": (
        lambda: BRICK.instances(spoilt(1, 1, 1.0001)),
        "matrices[2] must be a rotation times one factor > 0, wi",
    ),
    "flat": (lambda: BRICK.instances(spoilt(1, 1, 0)), "matrices[2] must be a rotation times one factor > 0, wi"),
    "too large": (lambda: BRICK.instances([np.full((3, 4), 1.7e308)]), "matrices[0] must be a rotation times"),
    "too small": (lambda: BRICK.instances([np.eye(4)[:3] * 5e-324]), "matrices[0] must be a rotation times"),
}


@pytest.mark.parametrize("name", VALUES)
def test_bad_values_are_refused(name: str):
    build, message = VALUES[name]
    with pytest.raises(ValueError, match=re.escape(message)):
        build()


TYPES: dict[str, tuple[Callable[[], Any], str]] = {
    "centers of text": (lambda: om.spheres("abc", 1), "centers must be real numbers, got 'abc'"),
    "no centers": (lambda: om.spheres(None, 1), "centers must be real numbers, got None"),
    "complex radii": (
        lambda: om.spheres(CENTERS, [1j] * 4),
        "radii must be real numbers, got ",
    ),
    "truth values": (lambda: om.boxes(CENTERS, True), "sizes must be real numbers, got True"),
    "shapes": (lambda: om.capsules(CENTERS, [om.sphere(1)], 1), "b must be real numbers, got [<Shape"),
    "times": (lambda: BRICK.instances(np.zeros((1, 3, 4), "m8[s]")), "matrices must be real numbers, got an array"),
    "blend": (lambda: om.spheres(CENTERS, 1, smooth="much"), "smooth must be a number, got 'much'"),
}


@pytest.mark.parametrize("name", TYPES)
def test_wrong_types_are_refused(name: str):
    build, message = TYPES[name]
    with pytest.raises(TypeError, match=re.escape(message)):
        build()


def test_nothing_is_left_of_what_is_refused():
    """The last row is looked at when all others have become nodes."""
    centers, radii = crowd(1000)
    radii[-1] = -1
    with pytest.raises(ValueError, match=re.escape("radii[999]")):
        om.spheres(centers, radii)
    assert om.spheres(centers[:-1], radii[:-1])._node.node_count == 2 * 999 + 1


# Large ----------------------------------------------------------------------------------------------------------------


def test_programs_of_many_spheres():
    centers, radii = crowd(MANY)
    shape = om.spheres(centers, radii, smooth=0.1)
    assert repr(shape) == f"<Shape union, {2 * MANY + 1} nodes>"
    program = om.compile(shape)
    assert (program.instructions, program.registers) == (2 * MANY - 1, 5)
    assert str(program).count("smooth_union") == MANY - 1
    assert len(program.objects) == MANY
    lo, hi = centers - radii[:, None], centers + radii[:, None]
    assert np.array(program.bounds) == pytest.approx(np.array([lo.min(axis=0) - 0.1, hi.max(axis=0) + 0.1]))


def test_what_many_have_in_common_is_one_node():
    centers, _ = crowd(1000)
    assert om.spheres(centers, 0.2)._node.node_count == 1000 + 2
    assert om.boxes(centers, 0.2)._node.node_count == 1000 + 2
    copies = BRICK.instances([placed(np.eye(3), center) for center in centers])
    assert copies._node.node_count == BRICK._node.node_count + 1000 + 1
    assert om.compile(copies).instructions == 3 * 1000 + 999  # box, sphere, difference of each; unions


def test_files_and_pickles_of_many_come_back(tmp_path: Path):
    scene = om.Scene(om.spheres(*crowd(MANY), smooth=0.1))
    scene.save(tmp_path / "many.json")
    assert om.load(tmp_path / "many.json") == scene
    few = BRICK.instances([placed(rotation(i, (1, 2, 3)), (i, 0, 0)) for i in range(500)])
    assert pickle.loads(pickle.dumps(few)) == few
