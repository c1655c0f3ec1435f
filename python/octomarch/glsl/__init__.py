"""Scenes as fragment shaders in GLSL ES 3.00, which browsers run.

`library` has the functions. `expressions` and `writer` write what a scene is made of, by what `primitives`, `operators`
and `domain` know of each kind of node. `shader` puts all together.
"""

from octomarch.glsl import domain, operators, primitives  # noqa: F401  they enter what they write
from octomarch.glsl.shader import functions, shader

__all__ = ["functions", "shader"]
