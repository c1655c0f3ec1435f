"""
Union
=====

All that lies in a sphere or in a box: the smaller of two distances.
"""

import sys

import octomarch as om

ball = om.sphere(1.0).paint(om.Material(color=(0.8, 0.3, 0.1)))
cube = om.box(1.5).translate(0.9, 0.3, 0).paint(om.Material(color=(0.1, 0.4, 0.5)))

image = om.render(ball | cube)
image.save(sys.argv[1] if sys.argv[1:] else "union.png")
