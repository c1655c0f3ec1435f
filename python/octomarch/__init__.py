"""octomarch: a SIMD ray marcher for signed distance fields.

Shapes are built by functions and operators, compiled to a flat program and marched in packets of rays.

>>> import octomarch as om
>>> image = om.render(om.sphere(1.0) - om.box(1.2), size=(64, 48))
>>> image.color.shape
(48, 64, 3)
"""

import sys

from octomarch import _spelling, reference
from octomarch._core import SceneError
from octomarch.bands import render_file
from octomarch.camera import Camera, OrthographicCamera, PanoramicCamera
from octomarch.choices import equal, mix, smoothstep, where
from octomarch.colormaps import colormap, iteration_colors
from octomarch.empty import RenderWarning
from octomarch.expressions import Expression, coordinates, normals
from octomarch.exr import read_exr, write_exr
from octomarch.fields import field, solid
from octomarch.flat import circle, ellipse, polygon, rectangle, regular_polygon, segment, star
from octomarch.frames import FramesError, render_frames
from octomarch.functions import (
    absolute,
    acos,
    asin,
    atan,
    atan2,
    ceil,
    clamp,
    cos,
    dot,
    exp,
    floor,
    fract,
    length,
    log,
    maximum,
    minimum,
    mod,
    power,
    sign,
    sin,
    sqrt,
    tan,
)
from octomarch.grids import grid
from octomarch.image import Image
from octomarch.lights import DirectionalLight, PointLight, SpotLight
from octomarch.machine import build_info, isas
from octomarch.many import boxes, capsules, spheres
from octomarch.march import March, Status
from octomarch.materials import Material
from octomarch.meshes import from_mesh
from octomarch.movies import write_movie
from octomarch.noises import fractal_noise, noise
from octomarch.operators import difference, intersection, metaballs, union
from octomarch.outlines import from_path, text
from octomarch.png import write_png
from octomarch.primitives import box, capsule, cylinder, plane, rounded_box, sphere, torus
from octomarch.program import Program, compile
from octomarch.progress import CancelledError, Progress
from octomarch.queries import Hits
from octomarch.render import render
from octomarch.scene import Scene
from octomarch.scenefile import load
from octomarch.shading import Shading
from octomarch.shapes import Shape
from octomarch.shot import Shot
from octomarch.skies import ConstantSky, CustomSky, EnvironmentMap, GradientSky, Sky
from octomarch.solids import (
    capped_cone,
    cone,
    ellipsoid,
    hexagonal_prism,
    link,
    octahedron,
    pyramid,
    triangular_prism,
)
from octomarch.study import Measured, Study, StudyRow, StudyTable, study
from octomarch.surfaces import diamond, gyroid, schwarz_p
from octomarch.textures import Texture, checker, image_texture, noise_texture, stripes
from octomarch.turntables import turntable
from octomarch.viewer import Pick, Viewer, view

__version__ = build_info()["version"]

__all__ = [
    "Camera",
    "CancelledError",
    "ConstantSky",
    "CustomSky",
    "DirectionalLight",
    "EnvironmentMap",
    "Expression",
    "FramesError",
    "GradientSky",
    "Hits",
    "Image",
    "March",
    "Material",
    "Measured",
    "OrthographicCamera",
    "PanoramicCamera",
    "Pick",
    "PointLight",
    "Program",
    "Progress",
    "RenderWarning",
    "Scene",
    "SceneError",
    "Shading",
    "Shape",
    "Shot",
    "Sky",
    "SpotLight",
    "Status",
    "Study",
    "StudyRow",
    "StudyTable",
    "Texture",
    "Viewer",
    "__version__",
    "absolute",
    "acos",
    "asin",
    "atan",
    "atan2",
    "box",
    "boxes",
    "build_info",
    "capped_cone",
    "capsule",
    "capsules",
    "ceil",
    "checker",
    "circle",
    "clamp",
    "colormap",
    "compile",
    "cone",
    "coordinates",
    "cos",
    "cylinder",
    "diamond",
    "difference",
    "dot",
    "ellipse",
    "ellipsoid",
    "equal",
    "exp",
    "field",
    "floor",
    "fract",
    "fractal_noise",
    "from_mesh",
    "from_path",
    "grid",
    "gyroid",
    "hexagonal_prism",
    "image_texture",
    "intersection",
    "isas",
    "iteration_colors",
    "length",
    "link",
    "load",
    "log",
    "maximum",
    "metaballs",
    "minimum",
    "mix",
    "mod",
    "noise",
    "noise_texture",
    "normals",
    "octahedron",
    "plane",
    "polygon",
    "power",
    "pyramid",
    "read_exr",
    "rectangle",
    "reference",
    "regular_polygon",
    "render",
    "render_file",
    "render_frames",
    "rounded_box",
    "schwarz_p",
    "segment",
    "sign",
    "sin",
    "smoothstep",
    "solid",
    "sphere",
    "spheres",
    "sqrt",
    "star",
    "stripes",
    "study",
    "tan",
    "text",
    "torus",
    "triangular_prism",
    "turntable",
    "union",
    "view",
    "where",
    "write_exr",
    "write_movie",
    "write_png",
]

_spelling.install(sys.modules[__name__])
