"""Fields as functions on numpy arrays: a volume, points drawn to a surface, and a laser scan of a room."""

import numpy as np

import octomarch as om

# The volume of a solid, by counting points inside. A ball without a tunnel through it ("napkin ring"): π h³ / 6.
height = 1.2
ring = om.sphere(1.0) - om.cylinder(np.sqrt(1 - (height / 2) ** 2))
points = np.random.default_rng(1).uniform(-1, 1, (1_000_000, 3))
volume = 8 * np.mean(ring.distance(points, precision="float32") < 0)
print(f"volume {volume:.3f}, exactly {np.pi * height**3 / 6:.3f}")

# Points drawn to the surface along the gradient.
near = points[:1000]
for _ in range(20):
    gradient = ring.gradient(near)
    near = near - ring.distance(near)[:, None] * gradient / np.maximum(np.sum(gradient**2, axis=1, keepdims=True), 1e-9)
print(f"farthest from the surface: {np.abs(ring.distance(near)).max():.1e}")

# A scanner at the centre of a room with four columns sees this far all around.
column = om.cylinder(0.3, height=3).repeat((4, None, 3), counts=(2, None, 2))
room = ~om.box((8, 3, 6)) | column
angles = np.linspace(0, 2 * np.pi, 720, endpoint=False)
directions = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
scan = room.raycast((0, 0, 0), directions, planes=("t", "status", "object_id"))
kinds = [kind for kind, _ in om.compile(room).objects]
seen = np.bincount(scan.object_id, minlength=len(kinds))
print(f"distances {scan.t.min():.2f} to {scan.t.max():.2f};", dict(zip(kinds, seen.tolist(), strict=True)))
