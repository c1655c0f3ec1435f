"""Depths by POV-Ray, a ray tracer that solves for roots and shares nothing with octomarch: Debian's `povray`.

A picture holds at most 16 bits a pixel, so depth comes in two pictures: D/16, and D modulo 1/64.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import octomarch as om

PROGRAM = shutil.which("povray")
FARTHEST = 16.0
"""Depths must stay below."""
STEP = 1 / 64
RESOLUTION = STEP / 65535

SCENE = """#version 3.7;
global_settings {{ assumed_gamma 1.0 }}
background {{ rgb 0 }}
#declare D = function {{ sqrt(pow(x - ({eye[0]}), 2) + pow(y - ({eye[1]}), 2) + pow(z - ({eye[2]}), 2)) }}
camera {{
  perspective location {camera_eye}
  direction {along} right {right} up {up}
}}
union {{
  {objects}
  pigment {{ function {{ {value} }} color_map {{ [0 rgb 0] [1 rgb 1] }} }}
  finish {{ ambient 0 diffuse 0 emission 1 }}
}}
"""


def vector(v: NDArray[np.float64]) -> str:
    return "<" + ", ".join(f"{x:.17g}" for x in v) + ">"


def unit(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return v / np.linalg.norm(v)


def depth(objects: str, camera: om.Camera, size: tuple[int, int], folder: Path) -> NDArray[np.float64]:
    """Return the depth of each pixel (height, width), +inf where nothing is seen; ±RESOLUTION."""
    eye = np.array(camera.eye)
    along = unit(np.array(camera.target) - eye)
    right = unit(np.cross(along, camera.up))
    half = np.tan(np.radians(camera.fov / 2))
    common = {
        "eye": [f"{x:.17g}" for x in eye],
        "camera_eye": vector(eye),
        "along": vector(along),
        "right": vector(2 * half * size[0] / size[1] * right),
        "up": vector(2 * half * np.cross(right, along)),
        "objects": objects,
    }
    coarse = picture(SCENE.format(value=f"D(x, y, z)/{FARTHEST}", **common), size, folder) * FARTHEST
    fine = picture(SCENE.format(value=f"mod(D(x, y, z), {STEP})/{STEP}", **common), size, folder) * STEP
    exact = np.round((coarse - fine) / STEP) * STEP + fine
    return np.where(coarse == 0, np.inf, exact)


def picture(scene: str, size: tuple[int, int], folder: Path) -> NDArray[np.float64]:
    """Render a scene of greys, and return them from 0 to 1."""
    assert PROGRAM is not None
    source, target = folder / "scene.pov", folder / "scene.ppm"
    source.write_text(scene)
    flags = ["-D", "-A", "-GA", "+FP16", "File_Gamma=1.0", f"+W{size[0]}", f"+H{size[1]}"]
    done = subprocess.run(
        [PROGRAM, f"+I{source}", f"+O{target}", *flags], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    content = target.read_bytes()
    count = 3 * size[0] * size[1]
    assert content.startswith(b"P6")
    assert content[: -2 * count].split()[-3:] == [b"%d" % n for n in (*size, 65535)]
    return np.frombuffer(content[-2 * count :], dtype=">u2").reshape(size[1], size[0], 3)[..., 0] / 65535
