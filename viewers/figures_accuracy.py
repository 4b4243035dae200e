"""The figure of the accuracy law: boundary layer and gaps against the number of tiles, on logarithmic axes."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from viewers import theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_DPI = 150


def accuracy_figure(
    tiles: Sequence[int],
    area: Sequence[float],
    base: Sequence[float],
    height: Sequence[float],
    exponents: tuple[float, float, float],
    kind: str = "png",
) -> bytes:
    """Draw the area of the boundary layer over the number of tiles, and gaps over the tiles along a side.

    Parameters
    ----------
    tiles : sequence of int
    area, base, height : sequence of float
    exponents : (float, float, float)
        Fitted slopes of area, base and height, which are written beside them.
    kind : str
        png or svg.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    style = {"svg.hashsalt": "kirisurf", "svg.fonttype": "path", "font.size": 9.0}
    with matplotlib.rc_context(style):
        figure = Figure(figsize=(8.4, 3.8), dpi=_DPI, layout="constrained", facecolor=theme.PAPER)
        FigureCanvasAgg(figure)
        left, right = figure.subplots(1, 2)
        _law(left, tiles, area, "measured", exponents[0], -0.5, 0)
        left.set_xlabel("number of tiles")
        left.set_title("Boundary layer: area / area of the target", loc="left", fontsize=9.5)
        side = [each**0.5 for each in tiles]
        _law(right, side, base, "base of a gap, mean", exponents[1], -1.0, 1)
        _law(right, side, height, "height of a gap, mean", exponents[2], -1.0, 2)
        right.set_xlabel("tiles along a side")
        right.set_title("Gaps along the outline", loc="left", fontsize=9.5)
        for axes in (left, right):
            _finish(axes)
        buffer = io.BytesIO()
        metadata = {"Software": None} if kind == "png" else {"Date": None, "Creator": None}
        figure.savefig(buffer, format=kind, metadata=metadata)
    return buffer.getvalue()


def _law(
    axes: Axes, x: Sequence[int | float], y: Sequence[int | float], words: str, slope: float, ideal: float, color: int
) -> None:
    """Points, and through their middle the line of the slope that is expected."""
    axes.loglog(
        x, y, "o", color=theme.SERIES[color], markersize=5, label=f"{words}: slope {slope:.3f}".replace("-", "\u2212")
    )
    middle = np.exp(np.mean(np.log(x))), np.exp(np.mean(np.log(y)))
    ends = np.array([min(x), max(x)])
    axes.loglog(
        ends,
        middle[1] * (ends / middle[0]) ** ideal,
        color=theme.SERIES[color],
        linewidth=0.9,
        linestyle=(0, (4, 3)),
        label=f"slope {ideal:g}".replace("-", "\u2212"),
    )


def _finish(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    plain = FuncFormatter(lambda value, _: f"{value:g}")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(plain)
        axis.set_minor_formatter(NullFormatter())
    axes.grid(color=theme.HAIRLINE, linewidth=0.6)
    axes.set_axisbelow(True)
    for name in ("top", "right"):
        axes.spines[name].set_visible(False)
    axes.legend(frameon=False, fontsize=8, loc="lower left")
