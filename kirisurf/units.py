"""Units of length that a target or a drawing may name."""

from __future__ import annotations

from types import MappingProxyType

from kirisurf.errors import ParameterError

MILLIMETERS = MappingProxyType({"um": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8})
"""Units of length and how many millimeters they are."""

UNITS = tuple(MILLIMETERS)
"""Their names."""


def checked_unit(unit: str, name: str = "units") -> str:
    """Return `unit`.

    Raises
    ------
    ParameterError
        Where it is none of `UNITS`; `name` is what the caller calls it.
    """
    if unit not in UNITS:
        raise ParameterError(f"{name}: expected one of {', '.join(UNITS)}, got {unit!r}")
    return unit
