"""Scenes as fragment shaders in GLSL ES 3.00, which browsers run.

`library` has the functions, `expressions` and `shapes` write what a scene is made of, and `shader` puts all together.
"""

from octomarch.glsl.shader import functions, shader

__all__ = ["functions", "shader"]
