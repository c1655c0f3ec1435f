"""
Building: holes
===============

Shafts through floor and ceiling.
"""

import sys

from _building import CAMERA, STONE, holes, scene, storey

import octomarch as om

image = om.render(scene((storey() - holes()).paint(STONE)), CAMERA)
image.save(sys.argv[1] if sys.argv[1:] else "building_holes.png")
