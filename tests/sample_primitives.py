"""Random primitives of every kind, upright and leaning, down to the sizes at which they are points and discs."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

import octomarch as om
from sample_flats import extruded, flat, revolved
from samples import Name, Sample, along, axis, direction, length, norm, positive, vector


def _sphere(radius: float) -> Sample:
    return Sample(om.sphere(radius), radius, 1, np.full(3, radius))


def _box(size: tuple[float, ...], form: str) -> Sample:
    monotone = form != "maximum"  # turned, its level sets are cubes that lean
    return Sample(om.box(size, form=form), norm(size), 1, np.array(size) / 2, monotone)


def _plane(normal: tuple[float, ...], point: tuple[float, ...]) -> Sample:
    return Sample(om.plane(normal, point), norm(point), 1, np.full(3, math.inf))


def _cylinder(radius: float, height: float | None, name: Name) -> Sample:
    half = math.inf if height is None else height / 2
    return Sample(om.cylinder(radius, height, name), radius + (height or 0), 2, along(name, radius, half))


def _cone(bottom: float, top: float, height: float, name: Name) -> Sample:
    radius = max(bottom, top)
    return Sample(om.capped_cone(bottom, top, height, name), radius + height, 3, along(name, radius, height / 2))


def _torus(radius: float, tube: float, name: Name) -> Sample:
    return Sample(om.torus(radius, tube, name), radius + tube, 2, along(name, radius + tube, tube) + tube)


def _capsule(a: tuple[float, ...], b: tuple[float, ...], radius: float) -> Sample:
    reach = np.maximum(np.abs(a), np.abs(b)) + radius
    return Sample(om.capsule(a, b, radius), norm(a) + norm(b) + radius, 1, reach)


def _octahedron(radius: float) -> Sample:
    return Sample(om.octahedron(radius), radius, 2, np.full(3, radius))


def _pyramid(edge: float, height: float) -> Sample:
    return Sample(om.pyramid(edge, height), edge + height, 2, np.array([edge, height, edge]) / 2)


def _ellipsoid(radii: tuple[float, ...]) -> Sample:
    return Sample(om.ellipsoid(radii), max(radii), 2, np.array(radii), monotone=False)  # turned, level sets lean


def _prism(sides: int, radius: float, height: float, name: Name) -> Sample:
    build = om.hexagonal_prism if sides == 6 else om.triangular_prism
    return Sample(build(radius, height, name), radius + height, 4, along(name, radius, height / 2))


def _link(straight: float, radius: float, tube: float) -> Sample:
    width = radius + tube
    reach = np.array([width, straight / 2 + width, tube])
    return Sample(om.link(straight, radius, tube), straight + width, 2, reach)


def _grid(seed: int, size: tuple[int, int, int], kind: str) -> Sample:
    """Of random samples: roundings of these weigh as much as the field between them is steep."""
    rng = np.random.default_rng(seed)
    values = rng.uniform(-0.5, 0.5, size)
    lo, hi = -rng.uniform(0.3, 1.5, 3), rng.uniform(0.3, 1.5, 3)
    shape = om.grid(values, (lo, hi), kind)
    reach = np.maximum(-lo, hi)
    gain = 1 + om.compile(shape).lipschitz + 4 * float(max((np.array(size) - 1) / (hi - lo)))
    return Sample(shape, float(np.linalg.norm(reach)), 4, reach, monotone=False, gain=gain)


triple = st.tuples(length, length, length)
PRIMITIVES: dict[str, st.SearchStrategy[Sample]] = {
    "sphere": st.builds(_sphere, length),
    "box": st.builds(_box, triple, st.just("exact")),
    "cheaper box": st.builds(_box, triple, st.sampled_from(["exterior", "maximum"])),
    "plane": st.builds(_plane, st.one_of(st.sampled_from([(0, 1, 0), (-1, 0, 0)]), direction), vector),
    "cylinder": st.builds(_cylinder, length, st.none(), axis),
    "capped_cylinder": st.builds(_cylinder, length, length, axis),
    "capped_cone": st.builds(_cone, length, length, length, axis),
    "torus": st.builds(_torus, length, length, axis),
    "capsule": st.builds(_capsule, vector, vector, length),
    "octahedron": st.builds(_octahedron, length),
    "pyramid": st.builds(_pyramid, length, length),
    "ellipsoid": st.builds(_ellipsoid, st.tuples(positive, positive, positive)),
    "prism": st.builds(_prism, st.sampled_from([3, 6]), length, length, axis),
    "link": st.builds(_link, length, length, length),
    "grid": st.builds(
        _grid,
        st.integers(0, 2**31),
        st.tuples(st.integers(2, 5), st.integers(2, 4), st.integers(2, 6)),
        st.sampled_from(["linear", "cubic"]),
    ),
    "flat": flat,
    "extruded": st.builds(extruded, flat, length),
    "revolved": st.builds(revolved, flat, length),
}
primitive = st.one_of(*PRIMITIVES.values())
