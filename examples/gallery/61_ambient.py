"""
Ambient light only
==================

Light of the same strength from everywhere.
"""

import sys

from _still_life import CAMERA, still_life

import octomarch as om

scene = om.Scene(still_life(), ambient=0.35)

image = om.render(scene, CAMERA, shading=om.Shading(occlusion=0))
image.save(sys.argv[1] if sys.argv[1:] else "ambient.png")
