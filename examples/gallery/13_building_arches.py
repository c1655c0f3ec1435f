"""
Building: arches and windows
============================

Gates with round tops, and windows beside them, through both pairs of walls.
"""

import sys

from _building import CAMERA, STONE, arches, scene, storey

import octomarch as om

image = om.render(scene((storey() - arches()).paint(STONE)), CAMERA)
image.save(sys.argv[1] if sys.argv[1:] else "building_arches.png")
