"""Color bar, scale bars and residual curves of the page: shapes with places, which its template draws."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from viewers import theme
from viewers.drawing import colormap
from viewers.fields import Field, name_unit
from viewers.framing import round_length
from viewers.words import number
from viewers.workbench.axis import ticks

LOWEST, HIGHEST = -16.5, 1.0
"""Powers of ten at the ends of the axis of residuals."""


def color_bar(field: Field, where: str) -> dict[str, Any]:
    """Return label, colors, ticks (in percent of the length) and ends of a color bar; `where` says what is colored."""
    colors = colormap(field)(np.linspace(0.0, 1.0, 33))
    low, high = field.limits
    below, above = field.exceeds
    return {
        "label": f"{where}: {field.label}",
        "unit": field.unit,
        "note": field.range_note,
        "gradient": f"linear-gradient(to right, {', '.join(_hex(color) for color in colors)})",
        "ticks": [
            {"at": round(100.0 * (value - low) / (high - low), 3) if high > low else 50.0, "words": number(value)}
            for value in ticks(low, high)
        ],
        "below": _hex(colors[0]) if below else "",
        "above": _hex(colors[-1]) if above else "",
    }


def scale_bar(per_pixel: float | int, width: float | int, units: str) -> dict[str, Any]:
    """Return the length in pixels of a bar of a round length, and that length in words.

    Parameters
    ----------
    per_pixel : float
        Length of a pixel, in units.
    width : float
        Of the picture, in pixels.
    units : str

    Examples
    --------
    >>> scale_bar(0.01, 500.0, "mm")
    {'pixels': 100.0, 'words': '1 mm'}
    """
    if not (math.isfinite(per_pixel) and per_pixel > 0):
        return {"pixels": 0.0, "words": ""}
    length = round_length(0.22 * width * per_pixel)
    return {"pixels": round(length / per_pixel, 2), "words": f"{length:g} {name_unit(units, length)}"}


def residual_curves(steps: Sequence[Mapping[str, float]], tolerance: float | int) -> dict[str, Any]:
    """Return the largest residual of every block over the steps, as lines in a unit square (y grows downward)."""
    blocks = list(dict.fromkeys(name for step in steps for name in step))
    shown = [name for name in blocks if any(step.get(name, 0.0) > 0 for step in steps)]
    across = max(len(steps) - 1, 1)
    lines = []
    for k, name in enumerate(shown):
        places = [(i / across, _height(step[name])) for i, step in enumerate(steps) if name in step]
        lines.append(
            {
                "name": name.replace("_", " "),
                "color": theme.SERIES[k % len(theme.SERIES)],
                "is_dashed": k >= len(theme.SERIES),
                "points": [[round(x, 4), round(y, 4)] for x, y in places],
            }
        )
    grid = [{"y": _height(10.0**power), "words": f"1e{power}" if power else "1"} for power in range(-16, 1, 4)]
    count = len(steps)
    words = "No steps yet" if not count else f"{count} step{'s' * (count > 1)}; largest residual of every block"
    return {"lines": lines, "grid": grid, "tolerance": _height(tolerance), "words": words}


def _height(value: float | int) -> float:
    """Place of a residual from the top (0) to the bottom (1) of a logarithmic axis."""
    if not math.isfinite(value):
        return 0.0
    share = (math.log10(max(value, 10.0**LOWEST)) - LOWEST) / (HIGHEST - LOWEST)
    return round(1.0 - min(share, 1.0), 4)


def _hex(color: Any) -> str:
    return "#" + "".join(f"{round(255 * float(part)):02x}" for part in color[:3])
