"""
Sphere
======

The first of all fields: the distance to a centre, less the radius.
"""

import sys

import octomarch as om

image = om.render(om.sphere(1.0))
image.save(sys.argv[1] if sys.argv[1:] else "sphere.png")
