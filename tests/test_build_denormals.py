"""The floating-point state of the host stays as it was: denormal numbers survive import and render.

A library linked with fast-math switches the whole process to flush-to-zero when it is loaded; so might a kernel while
it runs. Each check is a process of its own, since the state is the process's.
"""

import subprocess
import sys

import pytest

DENORMALS_LIVE = """
import struct

smallest = struct.unpack("<d", struct.pack("<Q", 1))[0]
one = float(str(1))
assert smallest * one == smallest != 0.0, "a product of denormals was flushed"
assert (smallest * 2) / 2 == smallest, "a denormal operand was taken for zero"
"""

NUMPY_TOO = """
import numpy as np

tiny = np.full(16, np.float32(1e-45))
assert np.all(tiny * np.float32(1) == tiny) and np.all(tiny > 0), "a float32 denormal was flushed"
"""

STEPS = {
    "import": "import octomarch",
    "render": """
import octomarch as om

for isa in om.isas():
    om.render(om.sphere(1.0) - om.box(1.2), size=(32, 16), isa=isa)
""",
    "queries": """
import numpy as np
import octomarch as om

points = np.full((9, 3), 1e-320)
for isa in om.isas():
    om.sphere(1.0).distance(points)
    om.sphere(1.0).gradient(points)
    om.sphere(1.0).raycast(points + 3.0, -points - 1.0)
""",
}


@pytest.mark.parametrize("step", STEPS)
def test_denormals_survive(step: str) -> None:
    program = DENORMALS_LIVE + STEPS[step] + DENORMALS_LIVE + NUMPY_TOO
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
