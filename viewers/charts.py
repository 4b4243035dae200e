"""Charts as SVG text: how the residuals fell, and the holes' curvature against the target's."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from viewers import theme
from viewers.fields import ROBUST_PERCENT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STYLE: Any = {
    "svg.hashsalt": "kirisurf",
    "svg.fonttype": "path",
    "font.size": 9.0,
    "axes.edgecolor": theme.MUTED,
    "axes.labelcolor": theme.INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9.5,
    "axes.titlecolor": theme.INK,
    "axes.titlelocation": "left",
    "xtick.color": theme.MUTED,
    "ytick.color": theme.MUTED,
    "grid.color": theme.HAIRLINE,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "text.color": theme.INK,
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
    with _chart((7.2, 3.3)) as (axes, svg):
        lowest = 1e-17
        for k, block in enumerate(blocks):
            values = np.array([float(step.get(block, np.nan)) for step in history])
            words = block.replace("_", " ")
            if not (values > 0).any():
                axes.plot([], [], color=theme.MUTED, linestyle="none", label=f"{words}: always 0")
                continue
            # Zero has no place on a logarithmic axis: it is drawn at the floor.
            values = np.where(values <= 0, lowest, values)
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
        axes.set_title("Largest residual of every block")
        axes.grid(axis="y")
        axes.xaxis.set_major_locator(_whole_numbers())
        if blocks:
            axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
    return svg[0]


def curvature_scatter(
    holes: Float[np.ndarray, " h"], target: Float[np.ndarray, " h"], name: str = "Gaussian curvature", unit: str = ""
) -> str:
    """Draw every hole's curvature over the target's at the same place, with the line of equality.

    Holes without a value (NaN) are left out. Both axes share one robust range; holes beyond it are drawn
    as triangles at the edge and counted.

    Parameters
    ----------
    holes, target : (h,)
    name, unit : str

    Returns
    -------
    str
        SVG.
    """
    known = np.isfinite(holes) & np.isfinite(target)
    x, y = target[known], holes[known]
    low, high = _range(np.concatenate([x, y]))
    outside = (y < low) | (y > high) | (x < low) | (x > high)
    with _chart((3.6, 3.5)) as (axes, svg):
        axes.plot([low, high], [low, high], color=theme.MUTED, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.scatter(x[~outside], y[~outside], s=13, color=theme.SERIES[0], alpha=0.65, linewidths=0)
        axes.scatter(
            np.clip(x[outside], low, high),
            np.clip(y[outside], low, high),
            s=22,
            marker="^",
            color=theme.SERIES[1],
            linewidths=0,
            clip_on=False,
        )
        axes.set_xlim(low, high)
        axes.set_ylim(low, high)
        axes.set_aspect("equal")
        axes.locator_params(axis="y", nbins=5)
        axes.locator_params(axis="x", nbins=3)
        axes.grid()
        suffix = f"  ({unit})" if unit else ""
        axes.set_xlabel(f"target{suffix}")
        axes.set_ylabel(f"holes{suffix}")
        axes.set_title(name + (f" ({int(outside.sum())} beyond the range)" if outside.any() else ""))
    return svg[0]


def curvature_histogram(
    holes: Float[np.ndarray, " h"], target: Float[np.ndarray, " h"], name: str = "Gaussian curvature", unit: str = ""
) -> str:
    """Draw how often each curvature occurs: holes as bars, the target at the same places as an outline.

    Parameters and range as in `curvature_scatter`.

    Returns
    -------
    str
        SVG.
    """
    known = np.isfinite(holes) & np.isfinite(target)
    low, high = _range(np.concatenate([holes[known], target[known]]))
    bins = np.linspace(low, high, 25).tolist()
    with _chart((3.6, 3.5)) as (axes, svg):
        axes.hist(np.clip(holes[known], low, high), bins, color=theme.SERIES[4], alpha=0.7, label="holes")
        axes.hist(
            np.clip(target[known], low, high), bins, histtype="step", color=theme.INK, linewidth=1.3, label="target"
        )
        axes.set_xlim(low, high)
        axes.locator_params(axis="x", nbins=3)
        axes.yaxis.set_major_locator(_whole_numbers())
        axes.grid(axis="y")
        axes.set_xlabel(f"{name}  ({unit})" if unit else name)
        axes.set_ylabel("number of holes")
        axes.set_title("How often")
        axes.legend(fontsize=8)
    return svg[0]


def _whole_numbers() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator("auto", integer=True)


def _range(values: np.ndarray) -> tuple[float, float]:
    if not len(values):
        return -1.0, 1.0
    percent = ROBUST_PERCENT if len(values) >= 40 else 100.0
    low, high = (float(p) for p in np.percentile(values, [100 - percent, percent]))
    room = 0.08 * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


@contextmanager
def _chart(inches: tuple[float, float]) -> Iterator[tuple[Axes, list[str]]]:
    """Give axes and a list that holds the SVG text when the block ends; no global state is touched."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=inches, layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        axes.set_axisbelow(True)
        svg: list[str] = []
        yield axes, svg
        buffer = io.BytesIO()
        # Without a date and a creator, equal numbers give equal bytes.
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
        svg.append(buffer.getvalue().decode("utf-8"))
