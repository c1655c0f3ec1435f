"""Planes beside the colours: saved to one EXR file, read back, and turned into pictures of their own."""

import numpy as np

import octomarch as om
from octomarch.demo import building

demo = building()
names = ("color", "depth", "normal", "object_id", "steps", "status")
om.render(demo.scene, demo.camera, size=(480, 360), march=demo.march, planes=names, progress=True).save("building.exr")

image = om.read_exr("building.exr")
print(image, image.metadata["camera"])
hit = image.status == om.Status.HIT
print(f"{hit.mean():.0%} of the rays hit, {image.steps.mean():.1f} evaluations per ray")
print(f"nearest {image.depth[hit].min():.2f}, farthest {image.depth[hit].max():.2f}")

near, far = np.percentile(image.depth[hit], [0, 90])
fog = np.clip((far - image.depth) / (far - near), 0, 1)
pictures = {
    "depth": np.repeat(fog[..., None], 3, axis=2),
    "normal": 0.5 + 0.5 * image.normal,
    "steps": np.stack([image.steps / 64, image.steps / 256, 0.2 + 0 * image.steps], axis=2),
}
for name, color in pictures.items():
    om.Image({"color": color}).save(f"building-{name}.png")
