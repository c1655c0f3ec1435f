"""
Building: repeated upwards
==========================

The storey once more and once more: a tower.
"""

import sys

from _building import building, scene

import octomarch as om

tower = building().repeat((None, 3, None), counts=(None, 7, None))

image = om.render(scene(tower, ground=-10.5), om.Camera(eye=(16, -4, 22), target=(0, 0, 0), fov=45), size=(480, 640))
image.save(sys.argv[1] if sys.argv[1:] else "building_repeated_y.png")
