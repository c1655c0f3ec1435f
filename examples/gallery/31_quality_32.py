"""
Quality: 32 steps
=================

The wall of towers, seen along it, with 32 steps per ray at the most.
"""

import sys

from _quality import CAMERA, street

import octomarch as om

image = om.render(street(), CAMERA, march=om.March("plain", max_steps=32))
image.save(sys.argv[1] if sys.argv[1:] else "quality_32.png")
