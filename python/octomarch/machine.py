"""What this machine can run, and how the native module was built."""

from __future__ import annotations

from octomarch import _core
from octomarch import _validate as check


def isas() -> list[str]:
    """Return the instruction sets that this machine can run, best first.

    All give the same bits. The best is taken unless ``isa=`` or the environment's OCTOMARCH_ISA names another.

    Examples
    --------
    >>> import octomarch as om
    >>> om.isas()[-1]
    'scalar'
    """
    return _core.isas()


def resolve_isa(isa: str | None = None) -> str:
    """Return the instruction set that a call with this `isa` runs.

    Raises
    ------
    TypeError, ValueError
        If `isa` is no name, or none of `isas`.

    Examples
    --------
    >>> resolve_isa("scalar")
    'scalar'
    """
    return _core.resolve_isa(check.isa(isa))


def build_info() -> dict[str, str]:
    """Return versions, compiler and flags of the native module.

    Examples
    --------
    >>> import octomarch as om
    >>> om.build_info()["version"] == om.__version__
    True
    """
    return _core.build_info()
