"""
A field by its samples
======================

Waves from three sources, summed at 72³ points and interpolated by splines. Their crests are no distances: how steep
they are between samples is measured, and marches go by it.
"""

import sys

import numpy as np

import octomarch as om

axis = np.linspace(-1.5, 1.5, 72)
x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
sources = [(-1, 0.2, 0.3), (0.9, -0.3, 0.6), (0.1, 0.4, -1)]
wave = sum(np.sin(9 * np.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2)) for a, b, c in sources)

crests = om.grid(0.8 - wave, ((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5)), "cubic") & om.sphere(1.4)
px, py, pz = om.coordinates()
heat = om.clamp(om.length(px, py, pz) / 1.4, 0, 1)
paint = om.Material(om.Texture(0.9 - 0.8 * heat, 0.25 + 0.2 * heat, 0.1 + 0.5 * heat), roughness=0.3)
floor = om.plane(point=(0, -1.45, 0)).paint(om.Material(0.4))

scene = om.Scene(crests.paint(paint) | floor, lights=[om.DirectionalLight((-1, -2, -1.2))], ambient=0.25)
image = om.render(scene, om.Camera((2.6, 1.6, 3.4), (0, -0.1, 0), fov=38), size=(640, 480))
image.save(sys.argv[1] if sys.argv[1:] else "sampled_field.png")
