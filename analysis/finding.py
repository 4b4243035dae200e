"""What a check found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """The worst value of a row, and where it is.

    Attributes
    ----------
    value : float, int or None
        None where there was nothing to check.
    where : str
        In words; for a value of None, why there was nothing.
    """

    value: float | int | None
    where: str = ""


NOTHING = Finding(None)
