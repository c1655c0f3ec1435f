"""
A sphere by a condition
=======================

All that is known of a point is whether it is inside: rays take steps of a fixed length, and normals come from which of
the points around are inside.
"""

import sys

import octomarch as om

x, y, z = om.coordinates()
ball = om.solid(x * x + y * y + z * z <= 1)

march = om.March(method="fixed", step=0.01, min_distance=2, max_distance=5)
image = om.render(ball, om.Camera(eye=(0, 0.6, 3.4), target=(0, 0, 0)), march=march)
image.save(sys.argv[1] if sys.argv[1:] else "solid_sphere.png")
