"""The scene of the lighting series: four simple solids on a table under a lamp."""

import octomarch as om

LAMP = om.PointLight(position=(3, 4.5, 3), color=(15, 14, 12))
CAMERA = om.Camera(eye=(2.5, 2.6, 5.5), target=(0, 0.3, 0), fov=34)


def still_life() -> om.Shape:
    """Return the solids and the table."""
    table = om.plane(point=(0, 0, 0)).paint(om.Material(color=(0.7, 0.68, 0.62), roughness=0.9, specular=0.05))
    ball = om.sphere(0.6, center=(-1.2, 0.6, 0.5)).paint(om.Material(color=(0.75, 0.2, 0.15), roughness=0.3))
    cube = om.rounded_box(0.9, 0.05).rotate(25).translate(0.1, 0.45, -0.7).paint(om.Material(color=(0.2, 0.4, 0.65)))
    ring = om.torus(0.45, 0.15).translate(0.8, 0.15, 0.9).paint(om.Material(color=(0.85, 0.65, 0.2), metallic=0.8))
    spire = om.cone(0.45, 1.5).translate(1.5, 0.75, -0.5).paint(om.Material(color=(0.3, 0.55, 0.3)))
    return table | ball | cube | ring | spire
