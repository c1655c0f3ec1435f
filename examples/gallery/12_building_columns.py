"""
Building: columns cut
=====================

Bars along both walls are taken out of the block; what stays are columns.
"""

import sys

from _building import CAMERA, STONE, scene, slots, storey

import octomarch as om

image = om.render(scene((storey() - slots()).paint(STONE)), CAMERA)
image.save(sys.argv[1] if sys.argv[1:] else "building_columns.png")
