"""
Steps of each ray
=================

Spheres over a floor, coloured by the number n of evaluations that each ray took: (5 n, 50, 50) of 255. Rays that graze
a surface take most.
"""

import sys

import octomarch as om

balls = om.sphere(0.4).repeat((1, 1, 1), counts=(3, 3, 3))
scene = balls | om.plane(point=(0, -1.6, 0))

camera = om.Camera(eye=(3, 2, 5), target=(0, -0.2, 0))
rays = om.render(scene, camera, march=om.March("plain", max_distance=100), planes=("steps",))

image = om.Image({"color": om.iteration_colors(rays.steps)})
image.save(sys.argv[1] if sys.argv[1:] else "iterations.png")
