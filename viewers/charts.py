"""Charts as SVG text: how the residuals fell, and the holes' curvature against the target's."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from viewers import theme
from viewers.report_bins import curvature_bins, decade, robust_span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SMALL = (2.7, 2.65)
"""Inches of a chart that stands in a row of charts."""

MOST_DOTS = 1500
"""Dots that are drawn as shapes; more become one picture within the chart."""

_STYLE: Any = {
    **theme.CHART_STYLE,
    "svg.hashsalt": "kirisurf",
    "svg.fonttype": "path",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlecolor": theme.INK,
    "axes.titlelocation": "left",
    "grid.color": theme.HAIRLINE,
    "grid.linewidth": 0.6,
    "text.parse_math": True,
}


def residual_history(history: Sequence[Mapping[str, float]], tolerance: float = 1e-9) -> str:
    """Draw the largest residual of every constraint block over the steps, on a logarithmic scale.

    Parameters
    ----------
    history : sequence of mapping
        For every step: block name -> largest residual, dimensionless.
    tolerance : float
        Drawn as a dashed line.

    Returns
    -------
    str
        SVG.
    """
    blocks = list(dict.fromkeys(name for step in history for name in step))
    with chart((7.2, 3.0), "Largest residual of every block") as (axes, svg):
        for k, block in enumerate(blocks):
            values = np.array([float(step.get(block, np.nan)) for step in history])
            words = block.replace("_", " ")
            if not (values > 0).any():
                axes.plot([], [], color=theme.MUTED, linestyle="none", label=f"{words}: always 0")
                continue
            # Zero has no place on a logarithmic axis: the line has a gap there.
            values = np.where(values > 0, values, np.nan)
            axes.semilogy(
                np.arange(len(values)),
                values,
                color=theme.SERIES[k % len(theme.SERIES)],
                linestyle=("-", "--", "-.", ":")[k // len(theme.SERIES) % 4],
                linewidth=1.5,
                marker="o",
                markersize=2.6,
                label=words,
            )
        axes.axhline(tolerance, color=theme.MUTED, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.annotate(
            f"tolerance {tolerance:g}",
            (1.0, tolerance),
            xycoords=("axes fraction", "data"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="right",
            fontsize=7.5,
            color=theme.MUTED,
        )
        axes.set_xlabel("step")
        axes.grid(axis="y")
        axes.xaxis.set_major_locator(whole_numbers())
        if blocks:
            axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
    return svg[0]


def curvature_scatter(
    holes: Float[np.ndarray, " h"],
    target: Float[np.ndarray, " h"],
    name: str = "Gaussian curvature",
    unit: str = "",
    span: tuple[float, float] | None = None,
    title: str | None = None,
) -> str:
    """Draw every hole's curvature over the target's at the same place, with the line of equality.

    Holes without a value (NaN) are left out. Both axes share one robust range; holes beyond it are drawn
    as triangles at the edge and counted.

    Parameters
    ----------
    holes, target : (h,)
    name, unit : str
    span : (float, float), optional
        Range of both axes; by default `robust_span` of both.
    title : str, optional
        By default the name.

    Returns
    -------
    str
        SVG.
    """
    known = np.isfinite(holes) & np.isfinite(target)
    x, y = target[known], holes[known]
    low, high = span or robust_span(x, y)
    power = decade(low, high)
    x, y, low, high = x / 10.0**power, y / 10.0**power, low / 10.0**power, high / 10.0**power
    outside = (y < low) | (y > high) | (x < low) | (x > high)
    with chart(SMALL, name if title is None else title) as (axes, svg):
        axes.plot([low, high], [low, high], color=theme.MUTED, linewidth=0.9, linestyle=(0, (4, 3)))
        dots = {"color": theme.SERIES[0], "alpha": 0.65, "linewidths": 0, "rasterized": len(x) > MOST_DOTS}
        axes.scatter(x[~outside], y[~outside], s=11, **dots)
        axes.scatter(
            np.clip(x[outside], low, high),
            np.clip(y[outside], low, high),
            s=20,
            marker="^",
            color=theme.SERIES[1],
            linewidths=0,
            clip_on=False,
        )
        if outside.any():
            count_beyond(axes, int(outside.sum()))
        axes.set_xlim(low, high)
        axes.set_ylim(low, high)
        axes.set_aspect("equal")
        axes.locator_params(axis="y", nbins=5)
        axes.locator_params(axis="x", nbins=4)
        axes.grid()
        axes.set_xlabel(with_unit("target", unit, power))
        axes.set_ylabel(with_unit("holes", unit, power))
    return svg[0]


def curvature_histogram(
    holes: Float[np.ndarray, " h"],
    target: Float[np.ndarray, " h"],
    name: str = "Gaussian curvature",
    unit: str = "",
    span: tuple[float, float] | None = None,
    title: str | None = None,
) -> str:
    """Draw how often each curvature occurs: holes as bars, the target at the same places as an outline.

    Parameters and range as in `curvature_scatter`.

    Returns
    -------
    str
        SVG.
    """
    bins = curvature_bins(holes, target, span)
    power = decade(float(bins.edges[0]), float(bins.edges[-1]))
    edges = bins.edges / 10.0**power
    with chart(SMALL, "How often" if title is None else title) as (axes, svg):
        axes.stairs(bins.holes, edges, fill=True, color=theme.SERIES[4], alpha=0.7, label="holes")
        axes.stairs(bins.target, edges, color=theme.INK, linewidth=1.2, label="target")
        axes.set_box_aspect(1)
        axes.set_xlim(float(edges[0]), float(edges[-1]))
        axes.set_ylim(0, 1.25 * max(1, bins.holes.max(initial=0), bins.target.max(initial=0)))
        axes.locator_params(axis="x", nbins=4)
        axes.yaxis.set_major_locator(whole_numbers())
        axes.grid(axis="y")
        axes.set_xlabel(with_unit(name, unit, power))
        axes.set_ylabel("holes")
        axes.legend(fontsize=8, ncols=2, loc="upper right", borderaxespad=0.1, columnspacing=1.2, handlelength=1.4)
    return svg[0]


def count_beyond(axes: Axes, count: int) -> None:
    """Write into the lower right corner how many dots lie beyond the range."""
    axes.annotate(
        f"{count} beyond", (0.97, 0.03), xycoords="axes fraction", ha="right", fontsize=7.5, color=theme.SERIES[1]
    )


def with_unit(name: str, unit: str, power: int = 0) -> str:
    """Return the label of an axis whose numbers are to be multiplied by ten to a power."""
    factor = f"$10^{{{power}}}$" if power else ""
    more = "\N{NO-BREAK SPACE}".join(part for part in (factor, unit.replace("$", r"\$")) if part)
    return f"{name}  ({more})" if more else name


def whole_numbers() -> Any:
    """Return a locator of ticks at whole numbers."""
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator("auto", integer=True)


@contextmanager
def chart(inches: tuple[float, float], title: str = "") -> Iterator[tuple[Axes, list[str]]]:
    """Give axes and a list that holds the SVG text when the block ends; no global state is touched."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=inches, layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        axes.set_axisbelow(True)
        axes.set_title(title, parse_math=False)
        svg: list[str] = []
        yield axes, svg
        buffer = io.BytesIO()
        # Without a date and a creator, equal numbers give equal bytes.
        figure.savefig(buffer, format="svg", dpi=200, metadata={"Date": None, "Creator": None})
        svg.append(buffer.getvalue().decode("utf-8"))
