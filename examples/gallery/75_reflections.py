"""
Two bounces of reflection
=========================

Two mirrors show each other, and in each other themselves.
"""

import sys

import octomarch as om

mirror = om.Material(color=(0.2, 0.2, 0.22), roughness=0.15, metallic=0.5, reflectivity=0.6)
glaze = om.Material(color=(0.7, 0.15, 0.1), roughness=0.3, reflectivity=0.3)
tiles = om.Material(color=om.checker((0.8, 0.8, 0.75), (0.15, 0.2, 0.25), size=(0.6, None, 0.6)), reflectivity=0.15)

balls = om.sphere(0.8, center=(-0.9, 0, 0)).paint(mirror) | om.sphere(0.8, center=(0.9, 0, -0.3)).paint(mirror)
cube = om.box(0.7).rotate(30).translate(0, -0.45, 1.2).paint(glaze)
floor = om.plane(point=(0, -0.8, 0)).paint(tiles)
scene = om.Scene(balls | cube | floor, ambient=0.25, lights=[om.DirectionalLight((-1, -2, -1), 0.9)])

image = om.render(
    scene, om.Camera(eye=(0.6, 1.2, 4.6), target=(0, -0.1, 0), fov=40), shading=om.Shading(bounces=2), samples=4
)
image.save(sys.argv[1] if sys.argv[1:] else "reflections.png")
