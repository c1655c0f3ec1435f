"""
A sphere by its distance
========================

The same sphere as a distance field: a handful of steps for each ray, and exact normals.
"""

import sys

import octomarch as om

x, y, z = om.coordinates()
ball = om.field(om.sqrt(x * x + y * y + z * z) - 1, lipschitz=1)

image = om.render(ball, om.Camera(eye=(0, 0.6, 3.4), target=(0, 0, 0)))
image.save(sys.argv[1] if sys.argv[1:] else "distance_sphere.png")
