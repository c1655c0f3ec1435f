"""
Subtraction
===========

A box without a sphere: the larger of one distance and the negative of the other.
"""

import sys

import octomarch as om

ball = om.sphere(1.0).paint(om.Material(color=(0.8, 0.3, 0.1)))
cube = om.box(1.6).paint(om.Material(color=(0.1, 0.4, 0.5)))

image = om.render(cube - ball)
image.save(sys.argv[1] if sys.argv[1:] else "subtraction.png")
