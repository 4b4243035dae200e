"""Figures of planar designs: each sheet contracted beside deployed, at one scale, in its outline."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, Int

from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from viewers import theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TONES = (theme.TILE, "#e8bd7c")
"""Colors of tiles that turn one way and the other."""

GAP = 0.12
"""Room between the two states, over the sum of their widths."""

_WIDTH, _WORDS, _COLORS = 6.0, 0.5, 64


@dataclass(frozen=True, eq=False)
class Panel:
    """One design of a figure.

    Attributes
    ----------
    title, note : str
    tiles : Loops
    contracted, deployed : (n, 2)
    outline : (m, 2) or None
        Closed curve drawn over the deployed sheet.
    tones : (t,)
        0 or 1: color of every tile.
    """

    title: str
    note: str
    tiles: Loops
    contracted: Float[np.ndarray, "n 2"]
    deployed: Float[np.ndarray, "n 2"]
    outline: Float[np.ndarray, "m 2"] | None
    tones: Int[np.ndarray, " t"]

    @property
    def size(self) -> tuple[float, float]:
        """Width of both states side by side, and the larger height."""
        a, b = _extent(self.contracted), _extent(self._around)
        return float((a[0] + b[0]) * (1 + GAP)), float(max(a[1], b[1]))

    @property
    def _around(self) -> np.ndarray:
        return self.deployed if self.outline is None else np.concatenate([self.deployed, self.outline])


def planar_figure(panels: Sequence[Panel], columns: int = 2, title: str = "", dpi: int = 150) -> bytes:
    """Draw designs, each contracted on the left and deployed on the right at one scale.

    Parameters
    ----------
    panels : sequence of Panel
    columns : int
        Designs in a row.
    title : str
        Above all of them.
    dpi : int
        Pixels per inch; a design is 6 inches wide.

    Returns
    -------
    bytes
        PNG.

    Raises
    ------
    ParameterError
        Where there is nothing to draw.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not panels or columns < 1:
        raise ParameterError(f"figure: expected designs and columns, got {len(panels)} designs, {columns} columns")
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    heights = [
        max(_WIDTH * panel.size[1] / panel.size[0] for panel in panels[k * columns : (k + 1) * columns]) + _WORDS
        for k in range(rows)
    ]
    head = 0.45 if title else 0.0
    total = sum(heights) + head
    figure = Figure(figsize=(_WIDTH * columns, total), dpi=dpi, facecolor=theme.PAPER)
    FigureCanvasAgg(figure)
    if title:
        figure.text(0.15 / (_WIDTH * columns), 1 - 0.3 / total, title, fontsize=12, color=theme.INK)
    for k, panel in enumerate(panels):
        row, column = divmod(k, columns)
        top = 1 - (head + sum(heights[:row])) / total
        axes = figure.add_axes(
            (
                (column + 0.02) / columns,
                top - heights[row] / total,
                0.96 / columns,
                (heights[row] - _WORDS) / total,
            )
        )
        x = (column + 0.02) / columns
        figure.text(x, top - 0.22 / total, panel.title, fontsize=10, color=theme.INK, parse_math=False)
        figure.text(x, top - 0.40 / total, panel.note, fontsize=8, color=theme.MUTED, parse_math=False)
        _draw(axes, panel)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return _with_palette(buffer)


def _with_palette(picture: io.BytesIO) -> bytes:
    """The picture with a few colors, a third of the bytes."""
    from PIL import Image

    buffer = io.BytesIO()
    few = Image.open(picture).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    few.save(buffer, format="png", optimize=True)
    return buffer.getvalue()


def _draw(axes: Axes, panel: Panel) -> None:
    from matplotlib.collections import PolyCollection

    widths = _extent(panel.contracted)[0], _extent(panel._around)[0]
    gap = GAP * sum(widths)
    states = (
        (panel.contracted, _middle(panel.contracted), 0.5 * widths[0]),
        (panel.deployed, _middle(panel._around), widths[0] + gap + 0.5 * widths[1]),
    )
    fine = min(1.0, (150.0 / max(len(panel.tiles), 1)) ** 0.5)
    for points, middle, at in states:
        axes.add_collection(
            PolyCollection(
                [points[tile] - middle + (at, 0.0) for tile in panel.tiles],
                facecolors=[TONES[tone] for tone in panel.tones.tolist()],
                edgecolors=theme.TILE_EDGE,
                linewidths=0.6 * fine,
                joinstyle="round",
            )
        )
    if panel.outline is not None:
        curve = panel.outline - states[1][1] + (states[1][2], 0.0)
        axes.plot(*np.concatenate([curve, curve[:1]]).T, color=theme.SERIES[0], linewidth=0.9)
    total, high = panel.size
    axes.set_xlim(-0.02 * total, 1.02 * total)
    axes.set_ylim(-0.52 * high, 0.52 * high)
    axes.set_aspect("equal", anchor="W")
    axes.set_axis_off()


def _extent(points: np.ndarray) -> Any:
    return np.ptp(points, axis=0)


def _middle(points: np.ndarray) -> np.ndarray:
    return 0.5 * (points.min(axis=0) + points.max(axis=0))
