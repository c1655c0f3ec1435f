"""Pictures are written whole or not at all, whatever happens meanwhile."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

import octomarch as om


@pytest.fixture
def image() -> om.Image:
    return om.Image({"color": np.random.default_rng(1).random((4, 6, 3))})


@pytest.fixture
def saved(image: om.Image, tmp_path: Path) -> Path:
    path = tmp_path / "picture.exr"
    image.save(path)
    return path


def test_failed_write_leaves_the_old_file_and_nothing_else(
    image: om.Image, saved: Path, monkeypatch: pytest.MonkeyPatch
):
    before = saved.read_bytes()

    def interrupted(_: object, path: str) -> None:
        Path(path).write_bytes(b"half a file")
        raise KeyboardInterrupt

    monkeypatch.setattr(OpenEXR.File, "write", interrupted)
    with pytest.raises(KeyboardInterrupt):
        image.save(saved)
    assert saved.read_bytes() == before
    assert list(saved.parent.iterdir()) == [saved]


@pytest.mark.skipif(sys.platform == "win32", reason="limits are of POSIX")
def test_full_disk_is_an_os_error_and_leaves_nothing(tmp_path: Path):
    script = (
        "import resource, numpy as np, octomarch as om\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "noise = np.random.default_rng(5).random((100, 100, 3), dtype=np.float32)\n"
        "try:\n"
        "    om.Image({'color': noise}).save('full.exr')\n"
        "except OSError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "cannot write full.exr" in done.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".exr", ".png"])
def test_unwritable_paths_are_os_errors_that_name_them(image: om.Image, tmp_path: Path, suffix: str):
    with pytest.raises(FileNotFoundError, match=f"nowhere/picture{suffix}"):
        image.save(tmp_path / "nowhere" / f"picture{suffix}")
    folder = tmp_path / f"folder{suffix}"
    folder.mkdir()
    with pytest.raises(IsADirectoryError, match=f"folder{suffix}"):
        image.save(folder)
    pipe = tmp_path / f"pipe{suffix}"
    os.mkfifo(pipe)
    with pytest.raises(OSError, match="not a regular file"):
        image.save(pipe)
    assert pipe.is_fifo()


def test_replaced_file_keeps_its_permissions_and_links(image: om.Image, saved: Path):
    saved.chmod(0o640)
    link = saved.with_name("link.exr")
    link.symlink_to(saved)
    image.save(link)
    assert link.is_symlink()
    assert stat.S_IMODE(saved.stat().st_mode) == 0o640
