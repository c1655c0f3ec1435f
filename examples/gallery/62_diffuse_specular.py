"""
Diffuse and specular
====================

A lamp joins in: Lambert for what is dull, Phong for the highlights.
"""

import sys

from _still_life import CAMERA, LAMP, still_life

import octomarch as om

scene = om.Scene(still_life(), ambient=0.35, lights=[LAMP])

image = om.render(scene, CAMERA, shading=om.Shading(occlusion=0, shadows="none"))
image.save(sys.argv[1] if sys.argv[1:] else "diffuse_specular.png")
