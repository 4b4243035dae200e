"""The axis of a color bar: round numbers between two limits."""

from __future__ import annotations

import math

from viewers.framing import round_length


def ticks(low: float | int, high: float | int) -> list[float]:
    """Return about five round numbers between two limits, zero among them where it lies between.

    Examples
    --------
    >>> ticks(-1.3, 1.3)
    [-1.0, -0.5, 0.0, 0.5, 1.0]
    """
    if not high > low:
        return [low]
    step = round_length((high - low) / 4.0)
    if (high - low) / step > 7:
        step *= 2
    first = math.ceil(low / step - 1e-9)
    return [round(k * step, 12) + 0.0 for k in range(first, math.floor(high / step + 1e-9) + 1)]
