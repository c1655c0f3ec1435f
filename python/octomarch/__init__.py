"""octomarch: a SIMD ray marcher for signed distance fields.

Shapes are built by functions and operators, compiled to a flat program and marched in packets of rays.

>>> import octomarch as om
>>> image = om.render(om.sphere(1.0) - om.box(1.2), size=(64, 48))
>>> image.color.shape
(48, 64, 3)
"""

from octomarch import reference
from octomarch._core import SceneError
from octomarch.camera import Camera, OrthographicCamera, PanoramicCamera
from octomarch.exr import read_exr, write_exr
from octomarch.image import Image
from octomarch.lights import DirectionalLight, PointLight, Sky
from octomarch.machine import build_info, isas
from octomarch.march import March, Status
from octomarch.materials import Material
from octomarch.operators import difference, intersection, union
from octomarch.primitives import box, capsule, cylinder, plane, sphere, torus
from octomarch.program import Program, compile
from octomarch.queries import Hits
from octomarch.render import render
from octomarch.scene import Scene
from octomarch.shading import Shading
from octomarch.shapes import Shape

__version__ = build_info()["version"]

__all__ = [
    "Camera",
    "DirectionalLight",
    "Hits",
    "Image",
    "March",
    "Material",
    "OrthographicCamera",
    "PanoramicCamera",
    "PointLight",
    "Program",
    "Scene",
    "SceneError",
    "Shading",
    "Shape",
    "Sky",
    "Status",
    "__version__",
    "box",
    "build_info",
    "capsule",
    "compile",
    "cylinder",
    "difference",
    "intersection",
    "isas",
    "plane",
    "read_exr",
    "reference",
    "render",
    "sphere",
    "torus",
    "union",
    "write_exr",
]
