"""
Object ids
==========

Which primitive each pixel shows, as numbers in colour: the wall of a cut belongs to what cut it.
"""

import sys

import octomarch as om

cut = om.sphere(1.0) - om.box(1.5).translate(0.9, 0.3, 0)
shape = cut.union(om.torus(1.0, 0.15), smooth=0.2) | om.plane(point=(0, -1, 0))

camera = om.Camera(eye=(3, 2, 4), target=(0.2, 0, 0), fov=40)
ids = om.render(shape, camera, planes="object_id")
image = om.Image({"color": ids.false_color("object_id")})
image.save(sys.argv[1] if sys.argv[1:] else "object_ids.png")
