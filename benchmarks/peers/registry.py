"""Who takes part: octomarch on each instruction set, and the libraries of requirements.txt. compare.py starts them."""

from dataclasses import dataclass, field
from typing import Any

import octomarch as om


@dataclass(frozen=True)
class Contender:
    """A module of this package, with options for its `prepare`. `packages` are what its versions are asked of."""

    key: str
    label: str
    module: str
    packages: tuple[str, ...]
    flags: str
    options: dict[str, Any] = field(default_factory=dict)
    own_environment: bool = True  # packages come from PyPI, into the peers' environment
    in_sweep: bool = True  # takes part in the scenes C of other sizes

    def specification(self) -> dict[str, Any]:
        return {"module": self.module, "options": self.options, "packages": list(self.packages)}


PEERS = (
    Contender(
        "drjit",
        "Dr.Jit, LLVM",
        "drjit_llvm",
        ("drjit", "numpy"),
        "one wavefront, symbolic loops, frozen function, fast-math; balls unrolled up to 1,000, then a loop",
    ),
    Contender(
        "numba-packets",
        "Numba, packets by hand",
        "numba_packets",
        ("numba", "llvmlite", "numpy"),
        "njit, fastmath; packets of 32 rays in short arrays",
    ),
    Contender(
        "numba-rays",
        "Numba, one ray at a time",
        "numba_rays",
        ("numba", "llvmlite", "numpy"),
        "njit, fastmath; a loop over pixels",
    ),
    Contender(
        "jax",
        "JAX, tiles",
        "jax_tiles",
        ("jax", "jaxlib", "numpy"),
        "jit, XLA's fast-math; while_loop over tiles of 5,120 rays",
    ),
    Contender(
        "warp",
        "Warp",
        "warp_cpu",
        ("warp-lang", "numpy"),
        "CPU device, fast_math, no backward pass; one thread per pixel",
    ),
    Contender(
        "taichi",
        "Taichi",
        "taichi_cpu",
        ("taichi", "numpy"),
        "arch=cpu, fast_math; a loop over the pixels of a field",
    ),
    Contender(
        "numpy",
        "numpy",
        "numpy_active",
        ("numpy",),
        "the rays under way, compacted, in tiles of 8,192",
    ),
)


def octomarch(isa: str, best: bool) -> tuple[Contender, ...]:
    """Return octomarch on an instruction set: with everybody's settings, and as it comes."""
    return tuple(
        Contender(
            f"octomarch-{isa}-{name}",
            f"octomarch {isa}, {label}",
            "octomarch_engine",
            ("numpy",),
            flags,
            {"isa": isa, "defaults": name == "defaults"},
            own_environment=False,
            in_sweep=best,
        )
        for name, label, flags in (
            ("same", "same settings", 'March("plain", 256, 1e-3, pixel_tolerance=0, finish=None), central differences'),
            ("defaults", "defaults", "March(max_distance=…), exact normals"),
        )
    )


def everybody() -> list[Contender]:
    isas = [isa for isa in om.isas() if isa != "scalar"]
    return [contender for isa in isas for contender in octomarch(isa, isa == isas[0])] + list(PEERS)
