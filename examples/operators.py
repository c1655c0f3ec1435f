"""Every operator on the same two shapes, hard in front and blended behind."""

import octomarch as om

ball, cube = om.sphere(1.0), om.box(1.5).translate(0.7, 0.4, 0.5)
operators = {"union": om.union, "intersection": om.intersection, "difference": om.difference}
colors = [(0.85, 0.30, 0.10), (0.06, 0.34, 0.38), (0.50, 0.12, 0.24)]

shapes = [om.plane(point=(0, -1, 0)).paint(om.Material(color=0.5, roughness=0.9, specular=0.05))]
for row, smooth in enumerate([0.0, 0.3]):
    for column, (operator, color) in enumerate(zip(operators.values(), colors, strict=True)):
        shape = operator(ball, cube, smooth=smooth).paint(om.Material(color, roughness=0.35))
        shapes.append(shape.translate(3.4 * (column - 1), 0, -3.4 * row))

scene = om.Scene(
    om.union(*shapes),
    ambient=0.2,
    lights=[om.DirectionalLight(direction=(0.6, -1, -0.5), color=(0.9, 0.85, 0.75))],
)
camera = om.Camera(eye=(3, 5, 11), target=(0, -0.2, -1.4), fov=36)
om.render(scene, camera, size=(960, 600), march=om.March(max_distance=1000)).save("operators.png")
