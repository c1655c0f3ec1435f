"""Mistakes that mypy must find, one on each line that says so; test_typing.py compares."""

import octomarch as om

om.sphere("1")  # wrong
om.sphere(1.0) | 2  # wrong
om.render(om.sphere(1.0), planes=3)  # wrong
om.March(method="magic")  # wrong
om.cylinder(1.0, axis="w")  # wrong
om.box(1.0, form="round")  # wrong
om.sphere(1.0).twist(30, axis="w")  # wrong
om.metaballs(om.sphere(1.0))  # wrong
om.sphere(1.0).displace(om.sphere(1.0))  # wrong
om.sphere(1.0).paint((1, 0, 0))  # wrong
om.render(3)  # wrong
om.Scene(om.sphere(1.0)).ambient = (0, 0, 0)  # wrong
print(om.sphere(1.0).colour)  # wrong
om.sqrt("1")  # wrong
om.coordinates()[0] + om.sphere(1.0)  # wrong
om.Material(roughness=om.checker(0, 1))  # wrong
om.image_texture("a.png", mapping="cubic")  # wrong
