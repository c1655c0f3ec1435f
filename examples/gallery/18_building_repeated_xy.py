"""
Building: repeated upwards and sideways
=======================================

Cells along x and y: a wall of towers, seen from the street.
"""

import sys

from _building import building, scene

import octomarch as om

towers = building().repeat((6, 3, None), counts=(9, 7, None))

image = om.render(scene(towers, ground=-10.5), om.Camera(eye=(14, -8, 22), target=(0, -1, 0), fov=50))
image.save(sys.argv[1] if sys.argv[1:] else "building_repeated_xy.png")
