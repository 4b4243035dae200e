"""What a drawing holds: curves as the file gives them, its unit, and sentences on what was left out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.outlines.curve import Curve

LARGEST_NUMBER = 1e60
"""Coordinates (units) up to which fourth powers do not overflow."""

MOST_PIECES = 100_000
"""Lines, arcs and Bezier pieces of one drawing; as many points of one curve."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """The curves of one file.

    Attributes
    ----------
    name : str
        File name.
    curves : tuple of Curve
        Open or closed, in any direction and order; y upwards.
    units : str or None
        Of the coordinates, where the file says so.
    notes : tuple of str
        Sentences.
    """

    name: str
    curves: tuple[Curve, ...]
    units: str | None
    notes: tuple[str, ...] = ()


def plain_float(text: str) -> float:
    """Return a number as files have them; of what Python reads beyond that, 1_000 and digits of other scripts, none.

    Raises
    ------
    ValueError
        Where the text is no number.
    """
    if "_" in text or not text.isascii():
        raise ValueError(text)
    return float(text)


def checked_number(text: str, name: str, what: str) -> float:
    """Return a finite number of a sensible size.

    Raises
    ------
    UnreadableError
        Where the text is no number.
    UnusableError
        Where it is not finite, or beyond `LARGEST_NUMBER`.
    """
    try:
        value = plain_float(text)
    except ValueError:
        raise UnreadableError(f"{name}: expected a number for {what}, got {text[:40]!r}") from None
    check_numbers([value], name, what)
    return value


def check_numbers(values: Sequence[float] | np.ndarray, name: str, what: str) -> None:
    """Raise UnusableError where a number is not finite, or beyond `LARGEST_NUMBER`."""
    array = np.asarray(values, dtype=np.float64).ravel()
    if len(array) and not (np.abs(array) <= LARGEST_NUMBER).all():
        wrong = float(array[~(np.abs(array) <= LARGEST_NUMBER)][0])
        kind = "smaller numbers" if math.isfinite(wrong) else "finite numbers"
        raise UnusableError(f"{name}: expected {kind} for {what}, got {wrong:g}")


def check_count(count: int, name: str, what: str = "points, lines and curves") -> None:
    """Raise UnusableError where a drawing holds more than `MOST_PIECES` pieces."""
    if count > MOST_PIECES:
        raise UnusableError(
            f"{name}: expected at most {MOST_PIECES} {what}, got {count} or more: "
            "simplify the outline, or save nothing but the outline"
        )


def counted(counts: dict[str, int]) -> str:
    """Return counts in words: 2 text, 1 use."""
    return ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
