"""Bins and ranges of the charts of curvature: what is drawn, and what the JSON of a report holds of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from viewers.fields import ROBUST_PERCENT

BINS = 24


@dataclass(frozen=True, eq=False)
class Bins:
    """How often values occur, those beyond the ends counted in the last bins.

    Attributes
    ----------
    edges : (b + 1,)
    holes, target : (b,) int
        Numbers of holes.
    below, above : int
        Holes whose own or whose target's value lies beyond the ends.
    """

    edges: Float[np.ndarray, " e"]
    holes: Int[np.ndarray, " b"]
    target: Int[np.ndarray, " b"]
    below: int
    above: int


def robust_span(*values: Float[np.ndarray, " n"]) -> tuple[float, float]:
    """Return one range for axes that show all the given values: their inner 96 %, all of fewer than 40.

    Examples
    --------
    >>> robust_span(np.array([0.0, 100.0]))
    (-8.0, 108.0)
    """
    known = np.concatenate([np.asarray(each, float)[np.isfinite(each)] for each in values]) if values else np.zeros(0)
    if not len(known):
        return -1.0, 1.0
    percent = ROBUST_PERCENT if len(known) >= 40 else 100.0
    low, high = (float(p) for p in np.percentile(known, [100 - percent, percent]))
    room = 0.08 * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


def decade(*values: float | int) -> int:
    """Return the power of ten to take out of numbers so that they can be read: 0 from 0.01 to 10000.

    Examples
    --------
    >>> decade(-2.5e-7, 1e-8), decade(0.3, 12.0), decade(2e6), decade(0.0)
    (-7, 0, 6, 0)
    """
    largest = max((abs(value) for value in values if np.isfinite(value)), default=0.0)
    return 0 if largest == 0 or 1e-2 <= largest < 1e4 else int(np.floor(np.log10(largest)))


def curvature_bins(
    holes: Float[np.ndarray, " h"], target: Float[np.ndarray, " h"], span: tuple[float, float] | None = None
) -> Bins:
    """Count the holes by their curvature, and by that of the target at the same places.

    Parameters
    ----------
    holes, target : (h,)
        Holes without one of the two (NaN) are left out.
    span : (float, float), optional
        Ends of the bins; by default `robust_span` of both.

    Examples
    --------
    >>> bins = curvature_bins(np.array([0.0, 1.0, 1.0]), np.array([0.0, 0.0, 1.0]))
    >>> int(bins.holes.sum()), bins.holes.tolist()[-3:], bins.target.tolist()[-3:]
    (3, [0, 2, 0], [0, 1, 0])
    """
    known = np.isfinite(holes) & np.isfinite(target)
    low, high = span or robust_span(holes[known], target[known])
    edges = np.linspace(low, high, BINS + 1)
    at_holes, at_target = (np.histogram(np.clip(each[known], low, high), edges)[0] for each in (holes, target))
    below = (holes[known] < low) | (target[known] < low)
    above = (holes[known] > high) | (target[known] > high)
    return Bins(edges, at_holes, at_target, int(below.sum()), int((above & ~below).sum()))
