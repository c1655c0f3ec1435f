"""
Sphere minus box
================

What of the sphere the box leaves.
"""

import sys

import octomarch as om

ball = om.sphere(1.0).paint(om.Material(color=(0.85, 0.25, 0.1), roughness=0.35))
cube = om.box(1.5).translate(0.9, 0.3, 0).paint(om.Material(color=(0.1, 0.35, 0.75), roughness=0.35))

image = om.render(ball - cube, om.Camera(eye=(3, 2, 4), target=(0.4, 0, 0), fov=40))
image.save(sys.argv[1] if sys.argv[1:] else "subtracted.png")
