"""Textures: patterns and pictures against numpy, on every instruction set with the same bits, and bad files."""

import copy
import math
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from expression_strategies import NOISE_ROUNDINGS, gradient_noise
from rounding import representable, unit_roundoff
from strategies import POINTS

X, Y, Z = om.coordinates()
RED, BLUE = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
PICTURE = np.random.default_rng(4).random((6, 9, 3)).astype(np.float32).astype(np.float64)
NAN, INF = math.nan, math.inf

ROUNDING = {"float32": 2e-5, "float64": 1e-12}
"""Coordinates within 40 units, rounded a few times at 2⁻²⁴ and 2⁻⁵³, change a texel's share by nine times as much."""


def evaluated(texture: om.Texture, points, precision: str = "float64", isa: str | None = None) -> np.ndarray:
    return texture.evaluate(points, precision=precision, isa=isa)


TEXTURES = {
    "solid": om.Texture(0.1, 0.2, 0.3),
    "checker": om.checker(RED, BLUE, 0.7),
    "stripes": om.stripes(RED, BLUE, 0.3, (1, 2, 3), soft=0.4),
    "noise": om.noise_texture(RED, BLUE, 0.4, octaves=5, seed=9),
    "planar": om.image_texture(PICTURE, "planar", size=1.3),
    "held": om.image_texture(PICTURE, "planar", size=1.3, wrap="clamp"),
    "spherical": om.image_texture(PICTURE, "spherical"),
    "nested": om.checker(om.stripes(0, 1, 0.1), 0.5 * om.image_texture(PICTURE, axis="y"), (1, None, 1)),
}


@pytest.mark.parametrize("name", TEXTURES)
def test_every_isa_gives_the_same_bits(name: str, precision: str):
    first, *others = (evaluated(TEXTURES[name], POINTS, precision, isa) for isa in om.isas())
    assert np.isfinite(first).all()
    for other in others:
        assert_array_equal(other, first)


@pytest.mark.parametrize("name", TEXTURES)
def test_the_reference_sees_the_same(name: str, precision: str):
    points = representable(POINTS, precision)
    found = evaluated(TEXTURES[name], points, precision)
    for i, component in enumerate(TEXTURES[name].components):
        truth = om.reference.distance(om.field(component, lipschitz=1), points)
        off = np.abs(found[:, i] - truth) > 4 * ROUNDING[precision]
        assert off.mean() < 0.02  # points on the edges of checkers, where a rounding decides


# Patterns -------------------------------------------------------------------------------------------------------------


def cells(points, size) -> np.ndarray:
    return np.floor(points / size + 0.5)


@pytest.mark.parametrize(
    ("size", "axes"), [(1.0, [0, 1, 2]), ((0.5, 1, 2), [0, 1, 2]), ((1, None, 1), [0, 2]), ((None, None, 3), [2])]
)
def test_checker(size, axes: list[int], isa: str, precision: str):
    points = representable(POINTS[:120], precision)
    edges = np.array([1.0 if edge is None else edge for edge in (size if np.iterable(size) else [size] * 3)])
    odd = cells(points, edges)[:, axes].sum(axis=1) % 2 == 1
    expected = np.where(odd[:, None], BLUE, RED)
    assert_array_equal(evaluated(om.checker(RED, BLUE, size), points, precision, isa), expected)


def test_checker_on_a_floor_is_even():
    """A floor at a whole height lies in the middle of a cube, not on a face."""
    points = [[x / 10, -1 + d, 0] for x in range(-4, 5) for d in (-1e-6, 0, 1e-6)]
    assert len(np.unique(evaluated(om.checker(0, 1), points), axis=0)) == 1


@pytest.mark.parametrize("soft", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("axis", ["x", "y", (1, 2, 2)])
def test_stripes(axis, soft: float, isa: str, precision: str):
    points = representable(POINTS[:120], precision)
    unit = {"x": np.eye(3)[0], "y": np.eye(3)[1]}.get(axis) if isinstance(axis, str) else np.array(axis) / 3
    along = points @ unit / 0.75
    distance = np.abs(along - 2 * np.floor(along / 2 + 0.5))
    if soft:
        t = np.clip((distance - 0.5 + soft / 2) / soft, 0, 1)
        weight = t * t * (3 - 2 * t)
    else:
        weight = (distance >= 0.5).astype(float)
    expected = RED * (1 - weight[:, None]) + BLUE * weight[:, None]
    # the weight changes by at most 1.5/soft of what the distance does
    tolerance = ROUNDING[precision] * (1.5 / soft if soft else 0)
    assert_allclose(evaluated(om.stripes(RED, BLUE, 0.75, axis, soft), points, precision, isa), expected, 0, tolerance)


@pytest.mark.parametrize("seed", [0, 1, 12345, 2**31 - 1])
def test_noise(seed: int, isa: str, precision: str):
    points = representable(POINTS, precision)
    expected = gradient_noise(points, seed * 179 % 289)
    found = om.noise(X, Y, Z, seed=seed).evaluate(points, precision=precision, isa=isa)
    assert_allclose(found, expected, 0, NOISE_ROUNDINGS * unit_roundoff(precision))


def test_noise_far_away_is_noise_still(isa: str, precision: str):
    points = np.array([[1e4 + 0.25, -1e4 + 0.5, 0.25], [289.5, 0.25, 0.5], [0.5, 0.25, 0.5]])
    found = om.noise(X, Y, Z).evaluate(points, precision=precision, isa=isa)
    assert_allclose(found, gradient_noise(points, 0), 0, 1e-6)
    assert found[1] == found[2]
    assert np.isnan(om.noise(X, Y, Z).evaluate([[NAN, 0, 0]], precision=precision, isa=isa)).all()


def test_seeds_differ():
    values = [om.noise(X, Y, Z, seed=seed).evaluate(POINTS[:120]) for seed in range(40)]
    correlation = np.corrcoef(values) - np.eye(40)
    assert np.abs(correlation).max() < 0.6  # of 120 points; sheer chance reaches 0.35
    assert np.abs(correlation).mean() < 0.12
    assert om.noise(X, Y, Z, seed=289) == om.noise(X, Y, Z)


def test_fractal_noise_and_clouds(isa: str, precision: str):
    points = representable(POINTS[:120], precision)
    expected = sum(0.5**i * gradient_noise(2**i * points, (3 + i) * 179 % 289) for i in range(4))
    found = om.fractal_noise(X, Y, Z, octaves=4, seed=3).evaluate(points, precision=precision, isa=isa)
    tolerance = 1e-5 if precision == "float32" else 1e-13
    assert_allclose(found, expected, 0, tolerance)
    clouds = evaluated(om.noise_texture(RED, BLUE, 1, 4, 3), points, precision, isa)
    weight = np.clip(0.5 + 0.5 * expected, 0, 1)[:, None]
    assert_allclose(clouds, RED * (1 - weight) + BLUE * weight, 0, tolerance)


# Pictures -------------------------------------------------------------------------------------------------------------


def bilinear(picture: np.ndarray, u: np.ndarray, v: np.ndarray, wraps=(True, True)) -> np.ndarray:
    """Return colours of a picture, texel (i, j) centred at ((i + ½)/w, 1 − (j + ½)/h)."""
    height, width = picture.shape[:2]
    column, row = u * width - 0.5, (1 - v) * height - 0.5
    i, j = np.floor(column).astype(int), np.floor(row).astype(int)
    s, t = (column - i)[:, None], (row - j)[:, None]

    def texel(a, b):
        a = a % width if wraps[0] else np.clip(a, 0, width - 1)
        b = b % height if wraps[1] else np.clip(b, 0, height - 1)
        return picture[b, a]

    above = texel(i, j) * (1 - s) + texel(i + 1, j) * s
    below = texel(i, j + 1) * (1 - s) + texel(i + 1, j + 1) * s
    return above * (1 - t) + below * t


def planar_uv(points: np.ndarray, axis: str, size: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    x, y, z = points.T
    across, up = {"x": (-z, y), "y": (x, -z), "z": (x, y)}[axis]
    return across / size[0] + 0.5, up / size[1] + 0.5


@pytest.mark.parametrize("wrap", ["repeat", "clamp"])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_planar_pictures(axis: str, wrap: str, isa: str, precision: str):
    points = representable(POINTS[:120], precision)
    texture = om.image_texture(PICTURE, "planar", size=(2, 1.5), axis=axis, wrap=wrap)
    repeats = wrap == "repeat"
    expected = bilinear(PICTURE, *planar_uv(points, axis, (2, 1.5)), (repeats, repeats))
    assert_allclose(evaluated(texture, points, precision, isa), expected, 0, ROUNDING[precision])


def test_pictures_stand_upright():
    """As seen against the axis: the first row above, the first column at the left."""
    corners = np.zeros((2, 2, 3))
    corners[0, 0], corners[0, 1], corners[1, 0] = RED, BLUE, 1
    points = np.array([[-0.25, 0.25, 5], [0.25, 0.25, 5], [-0.25, -0.25, 5]])
    assert_array_equal(evaluated(om.image_texture(corners), points), [RED, BLUE, np.ones(3)])
    floor = points[:, [0, 2, 1]] * [1, 1, -1]  # the upper edge is the far one
    assert_array_equal(evaluated(om.image_texture(corners, axis="y"), floor), [RED, BLUE, np.ones(3)])
    wall = points[:, [2, 1, 0]] * [1, 1, -1]
    assert_array_equal(evaluated(om.image_texture(corners, axis="x"), wall), [RED, BLUE, np.ones(3)])


def test_a_width_keeps_the_proportions():
    assert om.image_texture(PICTURE, size=3) == om.image_texture(PICTURE, size=(3, 2))
    assert om.image_texture(PICTURE) == om.image_texture(PICTURE, "planar", size=1, axis="z", wrap="repeat")


def test_texels_are_exact_at_their_centres(isa: str, precision: str):
    texture = om.image_texture(PICTURE[:4, :8], size=(8, 4))
    centres = np.array([(i - 3.5, 1.5 - j, 0) for j in range(4) for i in range(8)])
    assert_array_equal(evaluated(texture, centres, precision, isa), PICTURE[:4, :8].reshape(-1, 3))


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_spherical_pictures(axis: str, isa: str, precision: str):
    points = representable(POINTS[:120], precision)
    a = "xyz".index(axis)
    up, right, front = points[:, a], points[:, (a + 2) % 3], points[:, (a + 1) % 3]
    u = 0.5 + np.arctan2(right, front) / (2 * np.pi)
    v = 0.5 + np.arctan2(up, np.hypot(right, front)) / np.pi
    expected = bilinear(PICTURE, u, v, (True, False))
    found = evaluated(om.image_texture(PICTURE, "spherical", axis=axis), points, precision, isa)
    assert_allclose(found, expected, 0, ROUNDING[precision])


def test_spherical_pictures_have_no_hole(precision: str):
    """At the poles, at the centre, and at the seam, on either side of it."""
    texture = om.image_texture(PICTURE, "spherical")
    points = [[0, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, -1], [1e-30, 0, -1], [-1e-30, 0, -1]]
    found = evaluated(texture, points, precision)
    assert np.isfinite(found).all()
    assert_allclose(found[4], found[5], 0, ROUNDING[precision])
    assert_allclose(found[4], bilinear(PICTURE, np.zeros(1), np.full(1, 0.5), (True, False))[0], 0, ROUNDING[precision])


@pytest.mark.parametrize("sharpness", [1, 4, 2.5])
def test_triplanar_pictures(sharpness: float, isa: str):
    """A ball under ambient light alone shows what its surface is made of."""
    texture = om.image_texture(PICTURE, "triplanar", size=0.7, sharpness=sharpness)
    scene = om.Scene(om.sphere(1.0).paint(om.Material(color=texture, specular=0)), ambient=1)
    camera = om.Camera((2, 2.5, 3), (0, 0, 0))
    image = om.render(
        scene,
        camera,
        (40, 30),
        shading=om.Shading(occlusion=0),
        planes=("color", "position", "normal", "status"),
        precision="float64",
        isa=isa,
    )
    hit = image.status == om.Status.HIT
    points, normals = image.position[hit], image.normal[hit]
    weights = np.abs(normals) ** sharpness
    weights /= weights.sum(axis=1, keepdims=True)
    size = (0.7, 0.7 * 6 / 9)
    sides = [bilinear(PICTURE, *planar_uv(points, axis, size)) for axis in "xyz"]
    expected = sum(weights[:, [i]] * side for i, side in enumerate(sides))
    assert hit.sum() > 200
    assert_allclose(image.color[hit], expected, 0, 1e-9)


def test_triplanar_pictures_need_a_normal():
    with pytest.raises(ValueError, match="without the normal"):
        om.image_texture(PICTURE, "triplanar").evaluate([0, 0, 0])


# Sources --------------------------------------------------------------------------------------------------------------


def decoded(level: np.ndarray) -> np.ndarray:
    return np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)


def test_png_files_are_srgb(tmp_path: Path):
    levels = np.random.default_rng(2).integers(0, 256, (5, 4, 3), dtype=np.uint8)
    PIL.Image.fromarray(levels).save(tmp_path / "a.png")
    linear = decoded(levels / 255).astype(np.float32)
    assert om.image_texture(tmp_path / "a.png") == om.image_texture(levels) == om.image_texture(linear)
    assert om.image_texture(str(tmp_path / "a.png")) == om.image_texture(levels)


def test_other_kinds_of_png(tmp_path: Path):
    rgb = np.random.default_rng(2).integers(0, 256, (5, 4, 3), dtype=np.uint8)
    grey = rgb[..., 0]
    PIL.Image.fromarray(np.dstack([rgb, grey])).save(tmp_path / "alpha.png")
    assert om.image_texture(tmp_path / "alpha.png") == om.image_texture(rgb)
    PIL.Image.fromarray(grey).save(tmp_path / "grey.png")
    assert om.image_texture(tmp_path / "grey.png") == om.image_texture(grey)
    assert om.image_texture(grey) == om.image_texture(np.dstack([grey] * 3))
    PIL.Image.fromarray(grey.astype(np.uint16) * 257).save(tmp_path / "deep.png")
    assert om.image_texture(tmp_path / "deep.png") == om.image_texture(grey)
    PIL.Image.fromarray(rgb).quantize(8).save(tmp_path / "palette.png")
    om.image_texture(tmp_path / "palette.png")
    PIL.Image.fromarray(rgb).save(tmp_path / "a.jpg")
    om.image_texture(tmp_path / "a.jpg")


def test_exr_files_are_linear(tmp_path: Path):
    colors = np.random.default_rng(2).random((5, 4, 3)).astype(np.float32) * 7
    om.Image({"color": colors, "depth": colors[..., 0]}).save(tmp_path / "a.exr")
    assert om.image_texture(tmp_path / "a.exr") == om.image_texture(colors)


def test_a_file_that_is_not_there(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match=r"none\.png"):
        om.image_texture(tmp_path / "none.png")
    with pytest.raises(OSError, match=str(tmp_path)):
        om.image_texture(tmp_path)


def test_damaged_files_are_named(tmp_path: Path):
    picture = np.random.default_rng(2).integers(0, 256, (40, 40, 3), dtype=np.uint8)
    PIL.Image.fromarray(picture).save(tmp_path / "a.png")
    om.Image({"color": picture.astype(np.float32)}).save(tmp_path / "a.exr")
    for name in ("a.png", "a.exr"):
        whole = (tmp_path / name).read_bytes()
        for cut in (0, 3, 20, len(whole) // 2, len(whole) - 30):
            (tmp_path / f"cut-{name}").write_bytes(whole[:cut])
            with pytest.raises(OSError, match="cut-a"):
                om.image_texture(tmp_path / f"cut-{name}")
    (tmp_path / "text.png").write_text("no picture at all")
    with pytest.raises(OSError, match=r"text\.png: not an EXR, PNG or JPEG file"):
        om.image_texture(tmp_path / "text.png")


def test_flipped_bytes_never_get_past(tmp_path: Path):
    """Whatever byte is wrong: an OSError, or a picture that another byte could have made, but no other exception."""
    picture = np.random.default_rng(2).integers(0, 256, (3, 4, 3), dtype=np.uint8)
    PIL.Image.fromarray(picture).save(tmp_path / "a.png")
    whole = (tmp_path / "a.png").read_bytes()
    for at in range(len(whole)):
        (tmp_path / "b.png").write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        try:
            om.image_texture(tmp_path / "b.png")
        except OSError as error:
            assert "b.png" in str(error)  # noqa: PT017


def test_an_exr_without_colours(tmp_path: Path):
    om.Image({"depth": np.ones((4, 4), np.float32)}).save(tmp_path / "a.exr")
    with pytest.raises(OSError, match=r"a\.exr: there are no channels R, G, B"):
        om.image_texture(tmp_path / "a.exr")
    om.Image({"color": np.full((4, 4, 3), np.inf, np.float32)}).save(tmp_path / "b.exr")
    with pytest.raises(OSError, match=r"b\.exr: some of its colours are not finite"):
        om.image_texture(tmp_path / "b.exr")


# The algebra ----------------------------------------------------------------------------------------------------------


def test_textures_are_values():
    same = om.Texture(X, 0.5, Y)
    assert same == om.Texture(X, 0.5, Y)
    assert hash(same) == hash(om.Texture(X, 0.5, Y))
    assert same != om.Texture(X, 0.5, Z)
    assert same != X
    assert copy.copy(same) is same
    assert copy.deepcopy(same) is same
    with pytest.raises(AttributeError, match="textures are immutable"):
        same.components = ()
    with pytest.raises(AttributeError, match="textures are immutable"):
        del same.components
    assert repr(same) == "<Texture coordinate, constant, coordinate>"


def test_textures_combine_like_numbers():
    texture = om.Texture(X, Y, 0.5)
    assert texture * 2 == om.Texture(X * 2, Y * 2, om.minimum(0.5) * 2)
    assert 2 * texture == om.Texture(2 * X, 2 * Y, 2 * om.minimum(0.5))
    assert texture + (1, 2, 3) == om.Texture(X + 1, Y + 2, om.minimum(0.5) + 3)  # noqa: RUF005
    assert np.array([1, 2, 3]) + texture == om.Texture(1 + X, 2 + Y, 3 + om.minimum(0.5))
    assert np.float64(2) * texture == 2 * texture
    assert Z - texture == om.Texture(Z - X, Z - Y, Z - om.minimum(0.5))
    assert texture - Z == om.Texture(X - Z, Y - Z, om.minimum(0.5) - Z)
    assert texture * texture == om.Texture(X * X, Y * Y, om.minimum(0.5) * 0.5)


def test_mixes_and_choices_of_textures():
    a, b = om.Texture(X, X, X), om.Texture(Y, Y, Y)
    assert om.mix(a, b, Z) == a * (1 - Z) + b * Z
    assert om.mix((1, 0, 0), 0.5, Z).evaluate([0, 0, 0.5]).tolist() == [0.75, 0.25, 0.25]
    assert om.where(Z < 0, a, 0.5) == om.Texture(*[om.where(Z < 0, X, 0.5)] * 3)


@pytest.mark.parametrize("value", ["a", None, True, (1, "a", 2), om.sphere(1)], ids=str)
@pytest.mark.parametrize(
    ("use", "argument"),
    [
        (lambda v: om.checker(v, 0), "a"),
        (lambda v: om.checker(0, v), "b"),
        (lambda v: om.stripes(0, v), "b"),
        (lambda v: om.noise_texture(v, 0), "a"),
        (lambda v: om.mix(v, om.Texture(0, 0, 0), 0.5), "a"),
        (lambda v: om.where(X < 0, om.Texture(0, 0, 0), v), "b"),
        (lambda v: om.Texture(0, v, 0), "green"),
        (lambda v: om.Material(color=v), "color"),
    ],
)
def test_wrong_colours_are_named(use, argument, value):
    with pytest.raises(TypeError, match=f"^{argument}"):
        use(value)


@pytest.mark.parametrize("value", ["a", None, True], ids=str)
def test_textures_do_not_add_to_anything(value):
    for use in (lambda: om.Texture(0, 0, 0) + value, lambda: value * om.Texture(0, 0, 0)):
        with pytest.raises(TypeError):
            use()


@pytest.mark.parametrize(
    ("use", "error", "message"),
    [
        (lambda: om.checker(0, 1, 0), ValueError, "size must be > 0, got 0"),
        (lambda: om.checker(0, 1, NAN), ValueError, "size must be finite"),
        (lambda: om.checker(0, 1, (1, 2)), ValueError, "size must be one number or three"),
        (lambda: om.checker(0, 1, (None, None, None)), ValueError, "size must hold a number"),
        (lambda: om.checker(0, 1, "a"), TypeError, "size"),
        (lambda: om.checker((1, 2), 1), ValueError, r"a must have three components, got \(1, 2\)"),
        (lambda: om.checker((1, NAN, 2), 1), ValueError, r"a\[1\] must be a number, got nan"),
        (lambda: om.stripes(0, 1, -1), ValueError, "width must be > 0"),
        (lambda: om.stripes(0, 1, 1, (0, 0, 0)), ValueError, "axis must not be the zero vector"),
        (lambda: om.stripes(0, 1, 1, "w"), ValueError, "axis must be 'x', 'y', 'z'"),
        (lambda: om.stripes(0, 1, soft=2), ValueError, r"soft must lie in \[0, 1\]"),
        (lambda: om.noise_texture(0, 1, 0), ValueError, "size must be > 0"),
        (lambda: om.noise_texture(0, 1, octaves=17), ValueError, "octaves must lie in"),
        (lambda: om.noise_texture(0, 1, seed=1.5), TypeError, "seed must be an integer"),
        (lambda: om.image_texture(3), TypeError, "source must be a path or an array, got 3"),
        (lambda: om.image_texture([[1, 2]]), TypeError, "source must be a path or an array"),
        (lambda: om.image_texture(np.ones((2, 2, 4))), ValueError, r"source must have shape .* got \(2, 2, 4\)"),
        (lambda: om.image_texture(np.ones(3)), ValueError, "source must have shape"),
        (lambda: om.image_texture(np.ones((0, 2, 3))), ValueError, "source must have shape"),
        (lambda: om.image_texture(np.ones((2, 2), int)), TypeError, "source must hold floats"),
        (lambda: om.image_texture(np.full((2, 2), NAN)), ValueError, "source must hold finite numbers"),
        (lambda: om.image_texture(np.full((2, 2), 1e300)), ValueError, "source must hold finite numbers"),
        (lambda: om.image_texture(PICTURE, "cubic"), ValueError, "mapping must be one of"),
        (lambda: om.image_texture(PICTURE, 3), TypeError, "mapping must be one of"),
        (lambda: om.image_texture(PICTURE, size=0), ValueError, "size must be > 0"),
        (lambda: om.image_texture(PICTURE, size=(1, 2, 3)), ValueError, "size must be one number or two"),
        (lambda: om.image_texture(PICTURE, axis="w"), ValueError, "axis must be one of 'x', 'y', 'z'"),
        (lambda: om.image_texture(PICTURE, wrap="mirror"), ValueError, "wrap must be one of 'repeat', 'clamp'"),
        (lambda: om.image_texture(PICTURE, sharpness=2), ValueError, "sharpness is not used by the planar mapping"),
        (lambda: om.image_texture(PICTURE, "spherical", size=2), ValueError, "size is not used by the spherical"),
        (lambda: om.image_texture(PICTURE, "triplanar", axis="x"), ValueError, "axis is not used by the triplanar"),
        (lambda: om.image_texture(PICTURE, "triplanar", sharpness=0), ValueError, r"sharpness must lie in \[1, 64\]"),
    ],
)
def test_impossible_values_are_refused(use, error, message):
    with pytest.raises(error, match=message):
        use()
