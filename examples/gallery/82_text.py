"""
Text
====

A line of text, extruded and rounded, and a band of it engraved around a drum.
"""

import sys

import octomarch as om

gold, steel = om.Material((0.85, 0.6, 0.2), roughness=0.3, metallic=1), om.Material((0.35, 0.4, 0.45), roughness=0.35)
title = om.text("octomarch", size=1.0, font="DejaVu Serif").extrude(0.3).round(0.015).paint(gold)
letters = [om.text(letter, size=0.5).extrude(0.3).translate(0, -0.18, 1.1) for letter in "0123456789"]
band = om.union(*(letter.rotate(36 * i, "y") for i, letter in enumerate(letters)))
drum = om.cylinder(1.05, 0.8).round(0.05).paint(steel) - band.paint(gold)
floor = om.plane(point=(0, -0.02, 0)).paint(om.Material(0.5))

scene = om.Scene(
    title | drum.translate(0, 0.46, -1.8) | floor,
    lights=[om.DirectionalLight((-1, -1.6, -1.2))],
    ambient=0.25,
)
image = om.render(scene, om.Camera((0.8, 2.0, 5.4), (0, 0.4, 0), fov=36), size=(640, 400))
image.save(sys.argv[1] if sys.argv[1:] else "text.png")
