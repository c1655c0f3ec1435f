"""
Building: floors
================

The block without its inside, cut open: floor, ceiling and walls are left.
"""

import sys

from _building import CAMERA, STONE, rooms, scene, storey

import octomarch as om

image = om.render(scene((storey() - rooms() - om.box((5, 5, 5)).translate(2.5, 0, 2.5)).paint(STONE)), CAMERA)
image.save(sys.argv[1] if sys.argv[1:] else "building_floors.png")
