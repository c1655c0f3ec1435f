"""
With ambient occlusion
======================

Corners and contacts get less of the ambient light.
"""

import sys

from _still_life import CAMERA, LAMP, still_life

import octomarch as om

scene = om.Scene(still_life(), ambient=0.35, lights=[LAMP])

image = om.render(scene, CAMERA, shading=om.Shading(shadows="none"))
image.save(sys.argv[1] if sys.argv[1:] else "occlusion.png")
