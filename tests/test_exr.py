"""EXR files come back bit by bit, appear whole or not at all, and damage never passes for data."""

import json
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from octomarch.planes import PLANES

HEIGHT, WIDTH = 37, 53  # neither a multiple of the 16 rows of a chunk


@pytest.fixture
def image() -> om.Image:
    """Return an image of every plane, with nasty values and arrays that are not contiguous."""
    rng = np.random.default_rng(1)
    flipped = rng.standard_normal((HEIGHT, WIDTH, 3))[:, ::-1].astype(np.float32)
    depth = rng.random((WIDTH, HEIGHT), dtype=np.float32).T
    depth[0, :4] = [np.inf, np.nan, -0.0, 1e-40]
    return om.Image(
        {
            "color": rng.random((HEIGHT, WIDTH, 3), dtype=np.float32),
            "depth": depth,
            "position": flipped,
            "normal": np.zeros((HEIGHT, WIDTH, 3), np.float32),
            "object_id": rng.integers(-1, 2**31 - 1, (HEIGHT, WIDTH), dtype=np.int32),
            "material_id": rng.integers(-1, 4, (HEIGHT, WIDTH), dtype=np.int32),
            "steps": rng.integers(0, 256, (HEIGHT, WIDTH), dtype=np.int32),
            "status": rng.integers(0, 5, (HEIGHT, WIDTH), dtype=np.uint8),
        },
        stats={"rays": WIDTH * HEIGHT, "occupancy": np.float64(0.5)},
        metadata={"camera": {"eye": (3.0, 2.0, 4.0)}, "note": "größer 🙂", "far": np.inf},
    )


@pytest.fixture
def saved(image: om.Image, tmp_path: Path) -> Path:
    path = tmp_path / "picture.exr"
    image.save(path)
    return path


def bits(array: np.ndarray) -> bytes:
    return np.ascontiguousarray(array).tobytes()


def contents(path: Path) -> tuple[dict, dict[str, np.ndarray]]:
    """Return header and channels as the library itself reads them."""
    with OpenEXR.File(os.fspath(path), separate_channels=True) as file:
        return dict(file.header()), {name: channel.pixels.copy() for name, channel in file.channels().items()}


def test_round_trip_keeps_every_bit(image: om.Image, saved: Path):
    back = om.read_exr(saved)
    assert back.planes == image.planes == tuple(PLANES)
    for name in image.planes:
        wrote, read = getattr(image, name), getattr(back, name)
        assert read.dtype == wrote.dtype
        assert bits(read) == bits(wrote), name


def test_round_trip_keeps_metadata_and_stats(saved: Path):
    back = om.read_exr(saved)
    assert back.metadata == {"camera": {"eye": [3.0, 2.0, 4.0]}, "note": "größer 🙂", "far": "inf"}
    assert back.stats == {"rays": WIDTH * HEIGHT, "occupancy": 0.5}


@pytest.mark.parametrize("name", PLANES)
def test_each_plane_can_be_saved_alone(name: str, image: om.Image, tmp_path: Path):
    path = tmp_path / "one.exr"
    om.write_exr(path, om.Image({name: getattr(image, name)}))
    back = om.read_exr(path)
    assert back.planes == (name,)
    assert bits(getattr(back, name)) == bits(getattr(image, name))


def test_file_holds_standard_channels_and_attributes(saved: Path):
    header, channels = contents(saved)
    assert set(channels) == {channel for plane in PLANES.values() for channel in plane.channels}
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert header["software"] == f"octomarch {om.__version__}"
    assert len(header["chromaticities"]) == 8
    assert json.loads(header["octomarch"])["version"] == om.__version__


def test_ids_are_stored_plus_one(image: om.Image, saved: Path):
    stored = contents(saved)[1]["material_id"]
    assert stored.dtype == np.uint32
    assert_array_equal(stored, image.material_id + 1)


def test_doubles_are_stored_as_floats(tmp_path: Path):
    path = tmp_path / "double.exr"
    om.Image({"depth": np.array([[1 / 3, 1e300]])}).save(path)
    assert_array_equal(om.read_exr(path).depth, np.array([[1 / 3, np.inf]], np.float32))


def test_one_pixel(tmp_path: Path):
    path = tmp_path / "one.exr"
    om.Image({"color": np.full((1, 1, 3), 0.25, np.float32)}).save(path)
    assert om.read_exr(path).color.tolist() == [[[0.25, 0.25, 0.25]]]


def test_a_crop_lies_in_the_display_window_where_it_belongs(tmp_path: Path):
    path = tmp_path / "crop.exr"
    image = om.render(om.sphere(1.0), size=(60, 50), crop=(7, 20, 9, 21), planes=("color", "steps"))
    image.save(path)
    for _ in range(2):  # as rendered, and as read back
        header, channels = contents(path)
        windows = {name: [corner.tolist() for corner in header[f"{name}Window"]] for name in ("display", "data")}
        assert windows == {"display": [[0, 0], [59, 49]], "data": [[7, 20], [15, 40]]}
        assert_array_equal(channels["steps"], image.steps)
        back = om.read_exr(path)
        assert bits(back.color) == bits(image.color)
        back.save(path)


@pytest.mark.parametrize(
    "render",
    [
        None,
        3,
        {"crop": None},
        {"crop": [0, 0, 2, 2]},
        {"crop": "all", "size": 2},
        {"crop": [0, 0, 2, 3], "size": [2, 2]},
        {"crop": [0, 0, 3, 3], "size": [9, 9]},
    ],
)
def test_metadata_that_say_nothing_of_a_crop_leave_the_windows(render: object, tmp_path: Path):
    path = tmp_path / "other.exr"
    om.Image({"depth": np.ones((2, 2))}, metadata={"render": render}).save(path)
    assert contents(path)[0]["dataWindow"][1].tolist() == [1, 1]


# Damage ---------------------------------------------------------------------------------------------------------------


def test_truncation_at_any_length_is_an_error_that_names_the_file(saved: Path, tmp_path: Path):
    data = saved.read_bytes()
    header = data.index(b"scanlineimage")
    lengths = [*range(header + 60), *range(header + 60, len(data), 97), len(data) - 2, len(data) - 1]
    path = tmp_path / "cut.exr"
    for length in lengths:
        path.write_bytes(data[:length])
        with pytest.raises(OSError, match=r"cut\.exr: ") as error:
            om.read_exr(path)
        assert "empty" in str(error.value) or "ends after" in str(error.value) or "chunk" in str(error.value)


def test_changed_bytes_are_an_error_or_change_no_pixel(image: om.Image, saved: Path, tmp_path: Path):
    data, rng, path = saved.read_bytes(), np.random.default_rng(2), tmp_path / "flipped.exr"
    pixels = data.index(b"scanlineimage") + 24
    survivors = 0
    for at in [*rng.integers(0, pixels, 300), *rng.integers(pixels, len(data), 100)]:
        path.write_bytes(data[:at] + bytes([data[at] ^ rng.integers(1, 256)]) + data[at + 1 :])
        try:
            back = om.read_exr(path)
        except OSError as error:
            assert "flipped.exr" in str(error)  # noqa: PT017 (either outcome is right)
        else:
            survivors += 1
            assert back.planes == image.planes
            assert all(bits(getattr(back, name)) == bits(getattr(image, name)) for name in image.planes)
    assert survivors > 0  # attributes that no pixel depends on


def test_uncompressed_damage_is_found_by_the_checksum(tmp_path: Path):
    """Chunks that ZIP cannot shrink are stored as they are, without the checksum of a compressed stream."""
    noise = np.random.default_rng(3).integers(0, 2**31 - 1, (HEIGHT, WIDTH), dtype=np.int32)
    path = tmp_path / "noise.exr"
    om.Image({"object_id": noise}).save(path)
    data = bytearray(path.read_bytes())
    data[-1000] ^= 1
    path.write_bytes(data)
    with pytest.raises(OSError, match=r"noise\.exr"):
        om.read_exr(path)


def test_header_claiming_more_pixels_than_the_file_can_hold(saved: Path):
    data = saved.read_bytes()
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    assert data.count(window) == 2
    saved.write_bytes(data.replace(window, struct.pack("<4i", 0, 0, 60000, 60000)))
    with pytest.raises(OSError, match=r"picture\.exr: damaged EXR file: .*60001×60001|picture\.exr.*chunk"):
        om.read_exr(saved)


def test_large_file_claiming_too_many_columns(saved: Path):
    data = saved.read_bytes()
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    saved.write_bytes(data.replace(window, struct.pack("<4i", 0, 0, 2**31 - 2, HEIGHT - 1)))
    with pytest.raises(OSError, match="bytes of pixels"):
        om.read_exr(saved)


def test_other_files_are_refused(tmp_path: Path):
    for name, content, message in [
        ("empty.exr", b"", "empty"),
        ("text.exr", b"not a picture at all", "not an OpenEXR file"),
        ("tiled.exr", struct.pack("<2i", 20000630, 2 | 0x200), "tiled"),
        ("deep.exr", struct.pack("<2i", 20000630, 2 | 0x800), "deep"),
    ]:
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(OSError, match=f"{name}.*{message}"):
            om.read_exr(path)


def test_missing_file_is_an_os_error(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match=r"none\.exr"):
        om.read_exr(tmp_path / "none.exr")


# Files of other programs ----------------------------------------------------------------------------------------------


def foreign(path: Path, channels: dict[str, np.ndarray], **header: object) -> Path:
    kinds = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.PIZ_COMPRESSION}
    OpenEXR.File({**kinds, **header}, channels).write(os.fspath(path))
    return path


def test_foreign_file_is_read_without_metadata(tmp_path: Path):
    half = np.random.default_rng(4).random((40, 30)).astype(np.float16)
    path = foreign(tmp_path / "foreign.exr", {"R": half, "G": half, "B": half, "A": half})
    back = om.read_exr(path)
    assert back.planes == ("color",)
    assert back.metadata == back.stats == {}
    assert_array_equal(back.color[..., 1], half.astype(np.float32))


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ({"R": np.float32}, "color is incomplete: there is no channel G, B"),
        ({"Y": np.float32}, "none of its channels is a plane octomarch knows: Y"),
        ({"Z": np.uint32}, "channel 'Z' has the type uint"),
        ({"steps": np.float32}, "channel 'steps' has the type float"),
    ],
)
def test_foreign_channels_that_are_no_planes(tmp_path: Path, channels: dict[str, type], message: str):
    arrays = {name: np.ones((4, 4), kind) for name, kind in channels.items()}
    path = foreign(tmp_path / "foreign.exr", arrays)
    with pytest.raises(OSError, match=message):
        om.read_exr(path)


def test_foreign_integers_too_large_for_the_plane(tmp_path: Path):
    path = foreign(tmp_path / "foreign.exr", {"status": np.full((2, 2), 256, np.uint32)})
    with pytest.raises(OSError, match="status holds 256"):
        om.read_exr(path)


def test_edited_pixels_are_read_when_asked_to(tmp_path: Path, saved: Path):
    header, channels = contents(saved)
    channels["Z"][0, 0] = 7
    path = foreign(tmp_path / "edited.exr", channels, octomarch=header["octomarch"])
    with pytest.raises(OSError, match="the pixels of depth are not those that octomarch wrote"):
        om.read_exr(path)
    assert om.read_exr(path, verify=False).depth[0, 0] == 7
    del channels["Z"]
    path = foreign(tmp_path / "lost.exr", channels, octomarch=header["octomarch"])
    with pytest.raises(OSError, match="the plane depth was written but is not there"):
        om.read_exr(path)


def test_write_changes_nothing_of_the_image(image: om.Image, tmp_path: Path):
    before = {name: zlib.crc32(bits(getattr(image, name))) for name in image.planes}
    metadata = json.dumps(image.metadata)
    image.save(tmp_path / "a.exr")
    assert {name: zlib.crc32(bits(getattr(image, name))) for name in image.planes} == before
    assert json.dumps(image.metadata) == metadata


def test_write_takes_images_only(tmp_path: Path):
    with pytest.raises(TypeError, match=r"image must be an om\.Image, got 3"):
        om.write_exr(tmp_path / "a.exr", 3)  # type: ignore[arg-type]


def test_large_images_are_written_in_parts_to_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    planes = tuple(PLANES)
    for name, crop in {"whole": None, "crop": (7, 5, 60, 43)}.items():
        image = om.render(om.sphere(1.0) - om.box(1.2), size=(90, 100), planes=planes, crop=crop)
        image.save(tmp_path / f"{name}.exr")
        with monkeypatch.context() as patched:
            patched.setattr("octomarch.exr._PIXELS", 90 * 40)
            image.save(tmp_path / f"{name}_parts.exr")
        assert (tmp_path / f"{name}.exr").read_bytes() == (tmp_path / f"{name}_parts.exr").read_bytes()
    assert len(list(tmp_path.iterdir())) == 4
