"""octomarch: a SIMD ray marcher for signed distance fields.

Shapes are built by functions and operators, compiled to a flat program and marched in packets of rays.

>>> import octomarch as om
>>> image = om.render(om.sphere(1.0) - om.box(1.2), size=(64, 48))
>>> image.color.shape
(48, 64, 3)
"""
