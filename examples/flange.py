"""A flange with bolts in a ring, drawn without perspective: from the front, from the side and from above."""

import octomarch as om

plate = om.cylinder(2.0, height=0.3) - om.cylinder(0.9)
ring = om.torus(1.45, 0.12).translate(0, 0.15, 0)
bolt = om.capsule((1.45, -0.4, 0), (1.45, 0.4, 0), 0.14)
bolts = om.union(*(bolt.rotate(60 * i, axis="y") for i in range(6)))
feet = om.box((0.3, 0.5, 0.3)).repeat((2.2, None, 2.2), counts=(2, None, 2)).translate(0, -0.3, 0)

steel = om.Material(color=(0.60, 0.63, 0.68), roughness=0.35, specular=0.5)
brass = om.Material(color=(0.75, 0.55, 0.20), roughness=0.3, specular=0.5)
flange = om.union(plate, ring, feet, smooth=0.08).paint(steel) | bolts.paint(brass)

lo, hi = flange.bounds()
print("extent:", (hi - lo).round(3))
views = {"front": ((0, 0, 9), (0, 1, 0)), "side": ((9, 0, 0), (0, 1, 0)), "above": ((0, 9, 0), (0, 0, -1))}
for name, (eye, up) in views.items():
    camera = om.OrthographicCamera(eye, target=(0, 0, 0), up=up, height=4.6)
    om.render(flange, camera, size=(400, 400)).save(f"flange-{name}.png")
