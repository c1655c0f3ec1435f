"""
Ambient occlusion on
====================

The same light, dimmed where the field along the normal is smaller than it would be in the open.
"""

import sys

from _building import CAMERA, building, scene

import octomarch as om

image = om.render(scene(building()), CAMERA, shading=om.Shading(occlusion=5, shadows="none", occlusion_distance=0.8))
image.save(sys.argv[1] if sys.argv[1:] else "occlusion_on.png")
