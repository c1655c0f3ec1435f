"""
Box
===

Full edge lengths along the axes. The distance is exact everywhere, outside of corners and inside too.
"""

import sys

import octomarch as om

image = om.render(om.box((2.0, 1.2, 1.6)))
image.save(sys.argv[1] if sys.argv[1:] else "box.png")
