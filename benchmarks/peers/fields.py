"""The fields of the scenes, one text for every library: what differs is what its functions are called.

`Words` names those. A field takes and returns whatever the library computes with: floats in its compiler, arrays,
traced variables. Constants stand outside of the functions, rounded by `number`, since some compilers would take a
literal for a double; parameters and results say float for those compilers that want to know.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Words:
    """What a library calls the functions that fields are made of."""

    sqrt: Any
    absolute: Any
    minimum: Any
    maximum: Any
    floor: Any
    number: Callable[[float], Any] = float
    compiled: Callable[[Any], Any] = lambda function: function


def field(words: Words, scene: str) -> Any:
    """Return the function from x, y, z to the distance in scene A or B."""
    return {"A": blend, "B": building}[scene](words)


def box(words: Words, width: float, height: float, depth: float) -> Any:
    """Return the distance to a box around the origin."""
    sqrt, absolute, minimum, maximum = words.sqrt, words.absolute, words.minimum, words.maximum
    half_width, half_height, half_depth = (words.number(edge / 2) for edge in (width, height, depth))
    zero = words.number(0.0)

    def box_distance(x: float, y: float, z: float) -> float:
        qx = absolute(x) - half_width
        qy = absolute(y) - half_height
        qz = absolute(z) - half_depth
        ox = maximum(qx, zero)
        oy = maximum(qy, zero)
        oz = maximum(qz, zero)
        return sqrt(ox * ox + oy * oy + oz * oz) + minimum(maximum(maximum(qx, qy), qz), zero)

    return words.compiled(box_distance)


def smooth_minimum(words: Words, k: float) -> Any:
    """Return the polynomial smooth minimum of width k (I. Quilez)."""
    absolute, minimum, maximum = words.absolute, words.minimum, words.maximum
    width, factor, zero = words.number(k), words.number(1 / (4 * k)), words.number(0.0)

    def smooth(a: float, b: float) -> float:
        near = maximum(width - absolute(a - b), zero)
        return minimum(a, b) - near * near * factor

    return words.compiled(smooth)


def blend(words: Words) -> Any:
    """Return scene A."""
    sqrt, minimum = words.sqrt, words.minimum
    cube, smooth = box(words, 1.5, 1.5, 1.5), smooth_minimum(words, 0.25)
    one, right, above = words.number(1.0), words.number(0.9), words.number(0.3)

    def blend_distance(x: float, y: float, z: float) -> float:
        ball = sqrt(x * x + y * y + z * z) - one
        return minimum(smooth(ball, cube(x - right, y - above, z)), y + one)

    return words.compiled(blend_distance)


def building(words: Words) -> Any:
    """Return scene B."""
    sqrt, floor, minimum, maximum = words.sqrt, words.floor, words.minimum, words.maximum
    block, window = box(words, 4.0, 12.0, 4.0), box(words, 0.6, 0.8, 0.6)
    half, storey, per_storey = words.number(0.5), words.number(1.5), words.number(1 / 1.5)
    radius, ground = words.number(1.2), words.number(6.0)

    def building_distance(x: float, y: float, z: float) -> float:
        wx = x - floor(x + half)
        wy = y - storey * floor(y * per_storey + half)
        wz = z - floor(z + half)
        tower = maximum(block(x, y, z), -window(wx, wy, wz))
        tower = maximum(tower, radius - sqrt(x * x + z * z))
        return minimum(tower, y + ground)

    return words.compiled(building_distance)


def with_ball(words: Words, k: float) -> Any:
    """Return the function that smoothly unites a distance with that to a ball: scene C is this, ball after ball."""
    sqrt, smooth = words.sqrt, smooth_minimum(words, k)

    def united(d: float, dx: float, dy: float, dz: float, radius: float) -> float:
        return smooth(d, sqrt(dx * dx + dy * dy + dz * dz) - radius)

    return words.compiled(united)
