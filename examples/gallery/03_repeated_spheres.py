"""
Repeated spheres
================

One sphere, and as many copies as a grid has cells: the field of one, taken at the place within the nearest cell.
"""

import sys

import octomarch as om

grid = om.sphere(0.35).repeat((1, 1, 1), counts=(6, 4, 6)).paint(om.Material(color=(0.2, 0.45, 0.7)))

image = om.render(grid)
image.save(sys.argv[1] if sys.argv[1:] else "repeated_spheres.png")
