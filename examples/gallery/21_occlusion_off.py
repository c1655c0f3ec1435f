"""
Ambient occlusion off
=====================

Sun without shadows, and light from all sides as if nothing stood in its way.
"""

import sys

from _building import CAMERA, building, scene

import octomarch as om

image = om.render(scene(building()), CAMERA, shading=om.Shading(occlusion=0, shadows="none"))
image.save(sys.argv[1] if sys.argv[1:] else "occlusion_off.png")
