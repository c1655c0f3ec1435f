"""
Building: combined
==================

All of the cuts together.
"""

import sys

from _building import CAMERA, building, scene

import octomarch as om

image = om.render(scene(building()), CAMERA)
image.save(sys.argv[1] if sys.argv[1:] else "building_combined.png")
