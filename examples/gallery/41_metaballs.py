"""
Metaballs
=========

Exponentially blended balls over a floor, two textured materials, under a sky of two colours.
"""

import sys

import octomarch as om

marble = om.noise_texture((0.9, 0.85, 0.8), (0.45, 0.2, 0.25), size=0.35, octaves=4)
tiles = om.checker((0.85, 0.85, 0.8), (0.25, 0.28, 0.32), size=(0.5, None, 0.5))
centres = [(-0.9, 0, 0), (0.1, 0.35, 0.2), (0.9, -0.1, -0.3), (0.2, -0.3, 0.8)]

balls = om.metaballs(*(om.sphere(0.55, center=c) for c in centres), k=0.12).paint(
    om.Material(color=marble, roughness=0.3)
)
floor = om.plane((0, 1, 0), (0, -0.9, 0)).paint(om.Material(color=tiles, roughness=0.8))
scene = om.Scene(
    balls | floor,
    sky=om.Sky(axis=(0.3, 1, -0.2), toward=(0.35, 0.55, 0.9), away=(0.25, 0.2, 0.15), base=0.05),
    ambient=0.25,
    lights=[om.DirectionalLight(direction=(-1, -2, -1.5), color=0.9)],
)

image = om.render(scene, om.Camera(eye=(2.4, 0.5, 4), target=(0, 0, 0), fov=38), samples=4)
image.save(sys.argv[1] if sys.argv[1:] else "metaballs.png")
