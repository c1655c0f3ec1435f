"""
Metal and roughness
===================

From dull to sharp highlights, left to right; below, metal gives the highlight the colour of the surface.
"""

import sys

import octomarch as om

balls = []
for row, metallic in enumerate((0.0, 1.0)):
    for column in range(5):
        gold = om.Material(color=(0.9, 0.6, 0.2), roughness=0.9 - 0.2 * column, specular=0.6, metallic=metallic)
        balls.append(om.sphere(0.45, center=(column - 2, 0.5 - row, 0)).paint(gold))
lights = [om.DirectionalLight((-1, -1.5, -2), 0.7), om.SpotLight((-4, 3, 4), target=(0, 0, 0), color=9)]

image = om.render(om.Scene(om.union(*balls), ambient=0.15, lights=lights), om.Camera((0, 0, 6), (0, 0, 0), fov=44))
image.save(sys.argv[1] if sys.argv[1:] else "metal_and_roughness.png")
