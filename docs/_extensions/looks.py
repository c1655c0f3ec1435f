"""The two looks that pages give to shapes: lit on a floor, and cut to show the field around it."""

import numpy as np

import octomarch as om

CLAY = om.Material(color=(0.78, 0.33, 0.16), roughness=0.45)
PAPER = om.Material(color=(0.86, 0.84, 0.80), roughness=1.0, specular=0.0)


def portrait(shape: om.Shape) -> om.Image:
    """Show a shape on a floor, under a light from the left and a little light from all sides."""
    lo, _ = shape.bounds()
    floor = om.plane(point=(0, lo[1], 0) if np.isfinite(lo[1]) else (0, -1, 0))
    light = om.DirectionalLight(direction=(0.5, -1.1, -0.9), color=0.75)
    scene = om.Scene(shape.paint(CLAY) | floor.paint(PAPER), ambient=0.24, lights=[light])
    return om.render(scene, size=(440, 330))


def contours(shape: om.Shape, half: float = 2.0, spacing: float = 0.2) -> om.Image:
    """Show the field in the plane z = 0: blue inside, lines of equal distance, the surface as a dark line."""
    width, height = 440, 330
    y, x = np.mgrid[half : -half : height * 1j, -half * width / height : half * width / height : width * 1j]
    distance = shape.distance(np.stack([x, y, 0 * x], axis=-1))
    inside = np.array([0.20, 0.42, 0.68])
    outside = np.array([0.93, 0.89, 0.82])
    pixel = 2 * half / height
    lines = np.clip(np.abs((distance / spacing + 0.5) % 1 - 0.5) * spacing / pixel, 0, 1)
    surface = np.clip(np.abs(distance) / pixel - 1, 0, 1)
    fade = 0.5 + 0.5 * np.exp(-0.35 * np.abs(distance))
    color = np.where((distance < 0)[..., None], inside, outside) * fade[..., None]
    return om.Image({"color": (color * (0.80 + 0.20 * lines)[..., None] * (0.1 + 0.9 * surface)[..., None]) ** 2.2})
