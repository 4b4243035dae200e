"""Figure 1: the regular pattern opening, what a general sheet has to meet, and the way to one."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from kirisurf.loops import Loops
from kirisurf.reproducing_first import MeetingCorner, OpeningSquares
from viewers import theme
from viewers.figures import TONES
from viewers.framing import round_length

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT, _DPI, _COLORS = 12.0, 11.2, 150, 128
_WORDS, _NOTES = 15.0, 12.0
_ROWS = ((0.735, 0.20), (0.39, 0.24), (0.04, 0.25))
"""Lower edge and height of the pictures of every row, over the height of the page."""


def first_figure(
    squares: OpeningSquares,
    corner: MeetingCorner,
    tiles: Loops,
    tones: Int[np.ndarray, " t"],
    stages: Sequence[tuple[str, Float[np.ndarray, "n 2"]]],
    outline: Float[np.ndarray, "m 2"],
    worst: tuple[float, float],
) -> bytes:
    """Draw the figure.

    Parameters
    ----------
    squares : OpeningSquares
    corner : MeetingCorner
        Of the sheet that the stages lead to.
    tiles : Loops
    tones : (t,)
        0 or 1: color of every tile.
    stages : sequence of (str, (n, 2))
        Words, and the sheet then: the start and the result, both in the outline, and the closed sheet.
    outline : (m, 2)
        Closed curve.
    worst : (float, float)
        Largest difference of two sides that meet, over the tile edge, and largest difference of a sum of angles to a
        full turn, in radians.

    Returns
    -------
    bytes
        PNG.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, _HEIGHT), dpi=_DPI, facecolor=theme.PAPER)
    FigureCanvasAgg(figure)
    _heading(figure, 0, "a", "The regular pattern: squares hinged at their corners, turned by one angle")
    width = max(float(np.ptp(state, axis=0).max()) for state in squares.states)
    for k, (state, degree, stretch) in enumerate(zip(squares.states, squares.degrees, squares.stretches, strict=True)):
        axes = _axes(figure, 0, 0.02 + 0.24 * k, 0.24)
        _sheet(axes, squares.tiles, squares.tones, state, width)
        words = "closed" if not degree else f"{degree:g}°: {stretch:.2f} times as wide"
        _below(figure, axes, words)
    _heading(figure, 1, "b", "A general sheet closes where what meets is equal")
    _corner(_axes(figure, 1, 0.02, 0.22), corner, corner.tiles)
    _corner(_axes(figure, 1, 0.25, 0.30), corner, corner.opened)
    lines = (
        "Sides that meet (one color) are equally long:",
        f"worst of the sheet below {_small(worst[0])} of a tile edge.",
        "Angles that meet (shaded) sum to a full turn, here",
        " + ".join(f"{angle:.1f}°" for angle in np.degrees(corner.angles))
        + f" = {np.degrees(corner.angles.sum()):.1f}°;",
        f"worst of the sheet below {_small(worst[1])} rad.",
    )
    for line, high in zip(lines, (0.80, 0.68, 0.46, 0.34, 0.22), strict=True):
        place = _ROWS[1][0] + _ROWS[1][1] * high
        figure.text(0.575, place, line, fontsize=_NOTES, color=theme.INK, parse_math=False)
    _heading(figure, 2, "c", "From the regular pattern to a square that opens into a disc")
    width = max(float(np.ptp(points, axis=0).max()) for points in (outline, *(points for _, points in stages)))
    for k, (words, points) in enumerate(stages):
        axes = _axes(figure, 2, 0.02 + 0.32 * k, 0.32)
        curve = outline if k < len(stages) - 1 else None
        _sheet(axes, tiles, tones, points, width, curve)
        _below(figure, axes, words)
    _scale(axes, width)
    return _written(figure)


def _heading(figure: Figure, row: int, letter: str, words: str) -> None:
    base, height = _ROWS[row]
    y = base + height + 0.027
    figure.text(0.02, y, letter, fontsize=_WORDS, color=theme.INK, fontweight="bold")
    figure.text(0.045, y, words, fontsize=_WORDS, color=theme.INK)


def _axes(figure: Figure, row: int, left: float, width: float) -> Axes:
    base, height = _ROWS[row]
    axes = figure.add_axes((left, base, width, height))
    axes.set_axis_off()
    axes.set_aspect("equal")
    return axes


def _below(figure: Figure, axes: Axes, words: str) -> None:
    box = axes.get_position(original=True)
    figure.text(
        0.5 * (box.x0 + box.x1), box.y0 - 0.015, words, fontsize=_NOTES, color=theme.MUTED, ha="center", va="center"
    )


def _sheet(
    axes: Axes,
    tiles: Loops,
    tones: np.ndarray,
    points: np.ndarray,
    width: float,
    outline: np.ndarray | None = None,
) -> None:
    """Draw a sheet in the middle of axes that are `width` high, with the outline that it is held against."""
    from matplotlib.collections import PolyCollection

    colors = [TONES[tone] for tone in tones.tolist()]
    polygons = [points[tile] for tile in tiles]
    axes.add_collection(
        PolyCollection(polygons, facecolors=colors, edgecolors=theme.TILE_EDGE, linewidths=0.9, joinstyle="round")
    )
    around = points if outline is None else np.concatenate([points, outline])
    if outline is not None:
        axes.plot(*np.concatenate([outline, outline[:1]]).T, color=theme.SERIES[0], linewidth=1.4)
    _limits(axes, 0.5 * (around.min(axis=0) + around.max(axis=0)), width)


def _corner(axes: Axes, corner: MeetingCorner, polygons: Sequence[np.ndarray]) -> None:
    """Draw the tiles round a point, the sides that meet in one color each, the angles as sectors."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.patches import Wedge

    axes.add_collection(
        PolyCollection(polygons, facecolors=theme.TILE, edgecolors=theme.TILE_EDGE, linewidths=0.8, joinstyle="round")
    )
    radius = 0.32 * float(corner.lengths.min())
    for points, k in zip(polygons, corner.corners, strict=True):
        ahead, back = (points[(k + step) % len(points)] - points[k] for step in (1, -1))
        first, last = (float(np.degrees(np.arctan2(side[1], side[0]))) for side in (ahead, back))
        axes.add_patch(Wedge(points[k], radius, first, last, facecolor="#b9a5d6", edgecolor=theme.INK, linewidth=0.6))
    for color, pair in zip(theme.SERIES, corner.pairs, strict=False):
        lines = []
        for tile, side in pair:
            points = polygons[tile]
            a, b = points[side], points[(side + 1) % len(points)]
            # a little inside of its tile, so that both of a pair are seen where they lie on one another
            inward = np.array([a[1] - b[1], b[0] - a[0]]) / np.linalg.norm(b - a)
            lines.append(np.array([a, b]) + 0.12 * radius * inward)
        axes.add_collection(LineCollection(lines, colors=color, linewidths=3.2, capstyle="butt"))
    points = np.concatenate(polygons)
    _limits(axes, 0.5 * (points.min(axis=0) + points.max(axis=0)), float(np.ptp(points, axis=0).max()))


def _limits(axes: Axes, middle: np.ndarray, width: float) -> None:
    box, page = axes.get_position(original=True), axes.figure.get_size_inches()
    half = 0.53 * width
    wide = half * max(1.0, box.width * page[0] / (box.height * page[1]))
    high = half * max(1.0, box.height * page[1] / (box.width * page[0]))
    axes.set_xlim(middle[0] - wide, middle[0] + wide)
    axes.set_ylim(middle[1] - high, middle[1] + high)


def _scale(axes: Axes, width: float) -> None:
    """Draw a scale bar at the right of the last picture."""
    length = round_length(0.25 * width)
    (_, right), (low, _) = axes.get_xlim(), axes.get_ylim()
    x, y, tick = right - 0.02 * width, low + 0.12 * width, 0.025 * width
    bar = np.array([(x - length, y + tick), (x - length, y), (x, y), (x, y + tick)])
    axes.plot(*bar.T, color=theme.INK, linewidth=1.4)
    words = f"{length:g} {'unit' if length == 1 else 'units'}"
    axes.text(x - 0.5 * length, y - 0.03 * width, words, fontsize=_NOTES, color=theme.MUTED, ha="center", va="top")


def _small(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def _written(figure: Figure) -> bytes:
    from PIL import Image

    picture, buffer = io.BytesIO(), io.BytesIO()
    figure.savefig(picture, format="png", metadata={"Software": None})
    few = Image.open(picture).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    few.save(buffer, format="png", optimize=True)
    return buffer.getvalue()
