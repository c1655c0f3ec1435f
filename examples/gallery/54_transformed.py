"""
Transformed shapes
==================

One box: moved, turned about an axis of its own choice, scaled, stretched, mirrored, twisted and bent.
"""

import sys

import octomarch as om

slab = om.rounded_box((0.5, 1.4, 0.25), 0.05)
row = [
    slab,
    slab.rotate(35, axis=(1, 1, 1)),
    slab.scale(0.6),
    slab.stretch((1.4, 0.7, 1)),
    slab.rotate(30, axis="z").translate(0.35, 0, 0).mirror("x"),
    slab.twist(90),
    slab.rotate(90, axis="z").bend(50).rotate(90, axis="z"),
]
shapes = om.plane(point=(0, -0.85, 0))
for i, shape in enumerate(row):
    color = om.Material(color=(0.9 - 0.1 * i, 0.35, 0.15 + 0.1 * i))
    shapes |= shape.paint(color).translate(1.5 * i - 4.5, 0, 0)

image = om.render(shapes, om.Camera(eye=(0, 2, 9), target=(0, -0.1, 0), fov=27), (800, 320))
image.save(sys.argv[1] if sys.argv[1:] else "transformed.png")
