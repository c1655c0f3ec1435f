"""
Soft shadows, k = 2
===================

Shadows join in, as soft as light through fog.
"""

import sys

from _still_life import CAMERA, LAMP, still_life

import octomarch as om

scene = om.Scene(still_life(), ambient=0.35, lights=[LAMP])

image = om.render(scene, CAMERA, shading=om.Shading(shadow_k=2))
image.save(sys.argv[1] if sys.argv[1:] else "soft_shadows_2.png")
