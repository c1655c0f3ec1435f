"""The shortest way to a picture: a shape, framed and lit by default."""

import octomarch as om

image = om.render(om.sphere(1.0) - om.box(1.2))
image.save("hello.png")
print(image, f"in {image.stats['seconds'] * 1e3:.0f} ms")
