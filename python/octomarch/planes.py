"""The planes of a picture: their names, shapes and types, and the channels that hold them in an EXR file.

`render` computes them, `image` holds them, `exr` stores them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

PlaneName: TypeAlias = Literal["color", "depth", "position", "normal", "object_id", "material_id", "steps", "status"]


@dataclass(frozen=True)
class Plane:
    """One plane: EXR channels (one per component), the type in memory, and what is added to it in a file."""

    channels: tuple[str, ...]
    dtype: Literal["float", "int32", "uint8"]
    stored_offset: int = 0

    @property
    def is_float(self) -> bool:
        """Tell whether the plane holds floats; else integers ≥ 0 once `stored_offset` is added."""
        return self.dtype == "float"


PLANES: dict[PlaneName, Plane] = {
    "color": Plane(("R", "G", "B"), "float"),
    "depth": Plane(("Z",), "float"),
    "position": Plane(("P.X", "P.Y", "P.Z"), "float"),
    "normal": Plane(("N.X", "N.Y", "N.Z"), "float"),
    "object_id": Plane(("object_id",), "int32", stored_offset=1),  # EXR integers have no sign: 0 is "none"
    "material_id": Plane(("material_id",), "int32", stored_offset=1),
    "steps": Plane(("steps",), "int32"),
    "status": Plane(("status",), "uint8"),
}
