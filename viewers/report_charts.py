"""Charts of integrated curvature: cells of holes by angle defects, and where curvature resides."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from viewers import theme
from viewers.charts import MOST_DOTS, chart, count_beyond, with_unit
from viewers.report_bins import decade, robust_span

_BAR = 0.56
_ROOM_FOR_WORDS = 0.08


def balance_chart(defects: Float[np.ndarray, " h"], target: Float[np.ndarray, " h"]) -> str:
    """Draw the angle defect of every cell over the curvature of the target beneath it; NaN are left out.

    Returns
    -------
    str
        SVG.
    """
    known = np.isfinite(defects) & np.isfinite(target)
    x, y = target[known], defects[known]
    low, high = robust_span(x, y)
    power = decade(low, high)
    x, y, low, high = x / 10.0**power, y / 10.0**power, low / 10.0**power, high / 10.0**power
    beyond = int(((x < low) | (x > high) | (y < low) | (y > high)).sum())
    with chart((4.1, 3.6), "Cells of the inner holes") as (axes, svg):
        axes.plot([low, high], [low, high], color=theme.MUTED, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.scatter(
            np.clip(x, low, high),
            np.clip(y, low, high),
            s=12,
            color=theme.SERIES[2],
            alpha=0.65,
            linewidths=0,
            rasterized=len(x) > MOST_DOTS,
        )
        if beyond:
            count_beyond(axes, beyond)
        axes.set_xlim(low, high)
        axes.set_ylim(low, high)
        axes.set_aspect("equal")
        axes.locator_params(nbins=5)
        axes.grid()
        axes.set_xlabel(with_unit("target, K integrated", "rad", power))
        axes.set_ylabel(with_unit("sheet, angle defect", "rad", power))
    return svg[0]


def residence_chart(shares: Mapping[str, Mapping[str, float | int]]) -> str:
    """Draw the parts of area and curvature that lie in tiles and in holes, as bars of one length.

    Parameters
    ----------
    shares : mapping of str to mapping
        For area, target and sheet: `tiles` and `holes`, together 1.

    Returns
    -------
    str
        SVG.
    """
    names = {"area": "area", "target": "|K| of the\ntarget", "sheet": "|K| of the\nsheet"}
    colors = {"tiles": theme.TILE, "holes": theme.SERIES[0]}
    with chart((6.2, 2.5)) as (axes, svg):
        for k, key in enumerate(names):
            start = 0.0
            for where, color in colors.items():
                share = float(shares[key][where])
                axes.barh(-k, share, _BAR, left=start, color=color, edgecolor=theme.PAPER, linewidth=0.6)
                if share >= _ROOM_FOR_WORDS:
                    light = theme.PAPER if where == "holes" else theme.INK
                    words = f"{where}  {100 * share:.3g} %"
                    axes.text(start + 0.5 * share, -k, words, ha="center", va="center", fontsize=9, color=light)
                start += share
        axes.set_yticks([0, -1, -2], list(names.values()))
        axes.set_xlim(0, 1)
        axes.set_xticks([0, 0.25, 0.5, 0.75, 1], ["0", "25 %", "50 %", "75 %", "100 %"])
        axes.tick_params(axis="y", length=0, labelcolor=theme.INK)
        axes.spines["left"].set_visible(False)
        axes.grid(axis="x")
    return svg[0]
