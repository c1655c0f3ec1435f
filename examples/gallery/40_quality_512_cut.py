"""
Quality: 512 steps, 60 units
============================

The same with 512 steps, and no farther than 60 units.
"""

import sys

from _quality import CAMERA, street

import octomarch as om

image = om.render(street(), CAMERA, march=om.March("plain", max_steps=512, max_distance=60))
image.save(sys.argv[1] if sys.argv[1:] else "quality_512_cut.png")
