"""
Building: a block
=================

Step by step towards a city: everything begins with a box.
"""

import sys

from _building import CAMERA, STONE, scene, storey

import octomarch as om

image = om.render(scene(storey().paint(STONE)), CAMERA)
image.save(sys.argv[1] if sys.argv[1:] else "building_box.png")
