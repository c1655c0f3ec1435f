"""Polygons with holes, matplotlib's paths and text: distances by their edges, and what is refused."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties, findfont
from matplotlib.path import Path
from matplotlib.textpath import TextPath
from numpy.testing import assert_allclose

import octomarch as om
from test_messages import refuse_nonsense

SQUARE = [(-2, -2), (2, -2), (2, 2), (-2, 2)]
HOLES = [[(-1.5, -1), (-0.5, -1), (-0.5, 1), (-1.5, 1)], [(0.5, 0.5), (1, -1), (1.5, 0.5)]]
POINTS = np.random.default_rng(31).uniform(-3, 3, (2000, 3))
ROUNDING = 1e-12


def distance_to_edges(rings: list, p: np.ndarray) -> np.ndarray:
    """Return how far points (n, 2) are from the nearest edge."""
    a = np.concatenate([np.asarray(ring, float) for ring in rings])
    b = np.concatenate([np.roll(np.asarray(ring, float), -1, axis=0) for ring in rings])
    along = ((p[:, None] - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
    nearest = a + np.clip(along, 0, 1)[..., None] * (b - a)
    return np.linalg.norm(p[:, None] - nearest, axis=-1).min(axis=1)


def inside(ring: list, p: np.ndarray) -> np.ndarray:
    return Path(np.asarray(ring, float)).contains_points(p)


# Polygons with holes -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reverse", [False, True])
def test_polygons_with_holes_are_exact(reverse: bool):
    shape = om.polygon(SQUARE, holes=[hole[::-1] if reverse else hole for hole in HOLES])
    p = POINTS[:, :2]
    solid = inside(SQUARE, p) & ~inside(HOLES[0], p) & ~inside(HOLES[1], p)
    exact = np.where(solid, -1, 1) * distance_to_edges([SQUARE, *HOLES], p)
    assert_allclose(om.reference.distance(shape, POINTS), exact, atol=ROUNDING)
    assert om.compile(shape).lipschitz == 1


def test_polygons_with_holes_stay_flat_and_without_them_are_as_before():
    shape = om.polygon(SQUARE, holes=HOLES)
    assert shape.extrude(1).bounds()[1].tolist() == [2, 2, 0.5]
    assert np.isfinite(shape.translate(4, 0, 0).revolve().distance([1, 2, 3]))
    assert om.polygon(SQUARE, holes=()) == om.polygon(SQUARE)
    assert om.polygon(np.array(SQUARE), holes=np.array([HOLES[0]])) == om.polygon(SQUARE, [HOLES[0]])


@pytest.mark.parametrize(
    ("build", "error", "message"),
    [
        (lambda: om.polygon(SQUARE, [[(0, 0), (1, 1)]]), ValueError, r"holes\[0\] must be three points or more, got 2"),
        (
            lambda: om.polygon(SQUARE, [[(0, 0), (5, 0), (0, 1)]]),
            ValueError,
            r"corners must not cross holes\[0\].*at \(2, ",
        ),
        (
            lambda: om.polygon(SQUARE, [[(5, 5), (6, 5), (5, 6)]]),
            ValueError,
            r"holes\[0\] must lie within corners, got one outside at \(5, 5\)",
        ),
        (
            lambda: om.polygon(SQUARE, [SQUARE[:3], [(0.5, -0.5), (1, -0.5), (1, -0.25)]]),
            ValueError,
            r"holes\[1\] must not lie within another hole, got one within holes\[0\]",
        ),
        (
            lambda: om.polygon(SQUARE, [[(-1, -1), (1, 1), (1, -1), (-1, 1)]]),
            ValueError,
            r"holes\[0\] must not cross itself in a polygon with holes, got edges that do at \(0, 0\)",
        ),
        (
            lambda: om.polygon([(-1, -1), (1, 1), (1, -1), (-1, 1)], [HOLES[0]]),
            ValueError,
            "corners must not cross itself",
        ),
        (lambda: om.polygon(SQUARE, [[(0, 0), (1, np.nan), (1, 1)]]), ValueError, r"holes\[0\]\[1\] must be finite"),
        (lambda: om.polygon(SQUARE, 5), TypeError, "holes must be polygons, got 5"),
        (lambda: om.polygon([(0, 0), (1, 1)]), ValueError, "corners must be three points or more, got 2"),
    ],
)
def test_bad_polygons_are_named(build, error, message: str):
    with pytest.raises(error, match=f"^{message}"):
        build()


# Paths ---------------------------------------------------------------------------------------------------------------


def rings_of(*rings: list) -> Path:
    return Path.make_compound_path(*(Path([*ring, ring[0]], closed=True) for ring in rings))


def test_outlines_of_one_sense_fill_and_those_of_the_other_are_holes():
    p = POINTS[:, :2]
    hole, island = HOLES[0][::-1], [(-1.25, -0.5), (-0.75, -0.5), (-0.75, 0.5)]
    shape = om.from_path(rings_of(SQUARE, hole, island), tolerance=1)
    solid = inside(SQUARE, p) & ~(inside(hole, p) & ~inside(island, p))
    exact = np.where(solid, -1, 1) * distance_to_edges([SQUARE, hole, island], p)
    assert_allclose(om.reference.distance(shape, POINTS), exact, atol=ROUNDING)
    filled = om.from_path(rings_of(SQUARE, HOLES[0]), tolerance=1)  # of the same sense: nothing is cut
    assert filled == om.from_path(rings_of(SQUARE), tolerance=1)


def test_outlines_that_cross_in_one_sense_are_united():
    p = POINTS[:, :2]
    other = [(1, -1), (2.75, -1), (2.75, 1), (1, 1)]
    shape = om.from_path(rings_of(SQUARE, other), tolerance=1)
    solid = inside(SQUARE, p) | inside(other, p)
    assert ((om.reference.distance(shape, POINTS) < 0) == solid).all()


@pytest.mark.parametrize("tolerance", [0.1, 1e-2, 1e-4])
def test_curves_are_met_within_the_tolerance_by_few_edges(tolerance: float):
    cubic = Path([(-1, 0), (-1, 2), (2, 1), (1, 0), (-1, 0)], [Path.MOVETO, *[Path.CURVE4] * 3, Path.CLOSEPOLY])
    square = Path([(-1, 0), (0.5, 3), (1, 0), (-1, 0)], [Path.MOVETO, *[Path.CURVE3] * 2, Path.CLOSEPOLY])
    t = np.linspace(0, 1, 500)[:, None]
    for path, degree in ((cubic, 3), (square, 2)):
        curve = path.vertices[: degree + 1][:, None]
        while len(curve) > 1:
            curve = curve[:-1] * (1 - t) + curve[1:] * t
        shape = om.from_path(path, tolerance)
        off = np.abs(shape.distance(np.concatenate([curve[0], 0 * t], axis=1), precision="float64"))
        assert off.max() <= tolerance
        assert om.compile(shape).instructions <= 4 + 2 / np.sqrt(tolerance)


@pytest.mark.parametrize(
    ("build", "error", "message"),
    [
        (lambda: om.from_path("M 0 0", 0.1), TypeError, "path must be a matplotlib.path.Path, got 'M 0 0'"),
        (lambda: om.from_path(rings_of(SQUARE), 0), ValueError, "tolerance must be > 0, got 0"),
        (lambda: om.from_path(Path([(0, 0), (1, 1)]), 0.1), ValueError, "path must enclose something"),
        (lambda: om.from_path(Path(np.zeros((0, 2))), 0.1), ValueError, "path must enclose something"),
        (lambda: om.from_path(Path([(0, 0), (1, np.inf), (1, 0)]), 0.1), ValueError, "path must have finite corners"),
        (
            lambda: om.from_path(Path([(-1, -1), (1, 1.5), (1, -1), (-1, 1)]), 0.1),
            ValueError,
            r"outlines must not cross themselves, got one that does at \(",
        ),
        (
            lambda: om.from_path(rings_of(SQUARE, [(1, -1), (1, 1), (3, 1), (3, -1)]), 0.1),
            ValueError,
            r"a hole must not cross an outline, got one that does at \(2, ",
        ),
    ],
)
def test_bad_paths_are_named(build, error, message: str):
    with pytest.raises(error, match=f"^{message}"):
        build()


# Text ----------------------------------------------------------------------------------------------------------------


def test_letters_are_where_matplotlib_draws_them():
    """All of a row of letters, holes included, but for a band about the outlines as wide as the tolerance."""
    line, tolerance = "og&B8%@Ä", 1e-3
    shape = om.text(line, size=2, align="left", tolerance=tolerance)
    path = TextPath((0, 0), line, size=2000, prop=FontProperties(family="DejaVu Sans"))  # curves are for such sizes
    rings = [np.asarray(ring) / 1000 for ring in path.to_polygons()]
    lo, hi = np.concatenate(rings).min(axis=0), np.concatenate(rings).max(axis=0)
    p = np.random.default_rng(32).uniform(lo - 0.1, hi + 0.1, (20000, 2))
    drawn = np.logical_xor.reduce([inside(ring, p) for ring in rings])
    found = shape.distance(np.concatenate([p - [lo[0], 0], 0 * p[:, :1]], axis=1))
    wrong = (found < 0) != drawn
    assert np.abs(found[wrong]).max(initial=0) <= 2 * tolerance
    assert 0.1 < drawn.mean() < 0.6


def test_every_letter_of_the_usual_fonts_has_outlines_that_work():
    letters = "".join(map(chr, [*range(33, 127), *range(0xA1, 0x180)])).replace("$", "").replace("\xad", "")
    for font in ("DejaVu Sans", "DejaVu Serif"):
        for letter in letters:
            assert np.isfinite(om.text(letter, font=font).distance([0, 0, 0])), letter


@pytest.mark.parametrize(("align", "left", "right"), [("left", 0, 1), ("center", -0.5, 0.5), ("right", -1, 0)])
def test_text_is_aligned(align: str, left: float, right: float):
    lo, hi = om.text("octomarch", size=3, align=align).bounds()
    width = hi[0] - lo[0]
    assert_allclose([lo[0], hi[0]], [left * width, right * width], atol=1e-6)
    assert_allclose(om.text("X", size=3).bounds()[1][1], 3 * 0.73, rtol=0.01)  # of capitals


def test_fonts_are_names_or_files():
    file = findfont(FontProperties(family="DejaVu Serif"))
    assert om.text("a", font=file) == om.text("a", font="DejaVu Serif")
    assert om.text("a", font=file) != om.text("a")
    assert np.isfinite(om.text(r"$\frac{1}{2}$").distance([0, 0, 0]))


def test_text_is_rendered_extruded_and_revolved():
    sign = om.text("om").extrude(0.3)
    image = om.render(sign, om.Camera((0.2, 0.8, 3), (0, 0.3, 0), fov=40), size=(64, 48), planes=("depth",))
    assert 0.05 < np.isfinite(image.depth).mean() < 0.3
    ring = om.text("om", size=0.5).translate(2, 0, 0).revolve()
    assert ring.bounds()[1][0] == pytest.approx(2 + om.text("om", size=0.5).bounds()[1][0])


def test_long_text_far_away_is_not_cut_in_vain():
    """Where all letters are about as far, smaller cells have no shorter programs: few are made."""
    letters = [om.text(letter, size=0.5).extrude(0.3).translate(0, -0.18, 1.1) for letter in "0123456789"]
    drum = om.cylinder(1.05, 0.8) - om.union(*(letter.rotate(36 * i, "y") for i, letter in enumerate(letters)))
    scene = om.text("octomarch").extrude(0.3).translate(0, 0, 2) | drum | om.plane(point=(0, -0.5, 0))
    image = om.render(scene, om.Camera((1, 2, 8), (0, 0, 0), fov=36), size=(80, 50), planes=("depth",))
    assert om.compile(scene).instructions > 512
    assert image.stats["cells"] < 2000


@pytest.mark.parametrize(
    ("build", "error", "message"),
    [
        (lambda: om.text(5), TypeError, "string must be a str, got 5"),
        (lambda: om.text(" "), ValueError, "string must be one line of text that is not blank, got ' '"),
        (lambda: om.text("a\nb"), ValueError, "string must be one line"),
        (lambda: om.text("a", size=0), ValueError, "size must be > 0, got 0"),
        (lambda: om.text("a", tolerance=-1), ValueError, "tolerance must be > 0, got -1"),
        (
            lambda: om.text("a", align="middle"),
            ValueError,
            "align must be one of 'left', 'center', 'right', got 'middle'",
        ),
        (
            lambda: om.text("a", font="No Such Font"),
            ValueError,
            "font must be a family that matplotlib finds, or a file, got 'No Such Font'",
        ),
        (lambda: om.text("a", font="/nowhere/font.ttf"), FileNotFoundError, "font '/nowhere/font.ttf' is no file"),
        (lambda: om.text("a", font=5), TypeError, "font must be a name or a file, got 5"),
    ],
)
def test_bad_text_is_named(build, error, message: str):
    with pytest.raises(error, match=f"^{message}"):
        build()


def test_nonsense_is_told_by_name_and_value():
    refuse_nonsense(om.from_path, {"path": rings_of(SQUARE), "tolerance": 0.1})
    line = {"string": "a", "size": 1, "font": "DejaVu Sans", "align": "left", "tolerance": 0.1}
    refuse_nonsense(om.text, line)


def test_missing_matplotlib_is_answered_with_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r'need matplotlib: pip install "octomarch\[plot\]"'):
        om.text("a")
