"""The figure of a deployment: energy along the way for several lambda, and above it the sheet on its way."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from viewers import theme
from viewers.deployment_curves import NOTHING, ROOM, Curve, dot, draw_curves, draw_legend, power_words
from viewers.moving_sheet import MovingSheet, deployment_film, strain_colors

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Curve", "MovingSheet", "deployment_figure", "deployment_film"]

FAR_APART = 12.0
"""Curves whose highest points differ by more than this factor stand in panels of their own."""

_WIDTH, _DPI, _COLORS = 9.0, 150, 200
_LEFT, _RIGHT = 0.095, 0.975
_STRIP, _LEAST_STRIP, _PANEL, _HEAD, _FOOT = 1.75, 0.7, 3.0, 1.0, 0.36
_GAP = 0.14
_MEANING = "E: mean squared strain of the springs in the tiles, plus λ times the mean squared angle of the slits"
_AXES = {
    "free": "opening: mean angle of the slits, over that of the deployed sheet",
    "moved": "part of the way of the vertices that are moved",
}
_STYLE: Any = {
    **theme.CHART_STYLE,
    "font.size": 10.0,
    "text.parse_math": True,
}


def deployment_figure(
    curves: Sequence[Curve],
    sheet: MovingSheet,
    rows: Sequence[int],
    title: str,
    transition: float | None = None,
    drive: str = "free",
) -> bytes:
    """Draw energy against opening, or against the part of the way where vertices are moved.

    Parameters
    ----------
    curves : sequence of Curve
    sheet : MovingSheet
        The states of the first curve that are shown above, at most six.
    rows : sequence of int
        Numbers of these states among those of the first curve.
    title : str
    transition : float, optional
        lambda above which the sheet does not rest open by itself.
    drive : str
        Whatever but free moves vertices.

    Returns
    -------
    bytes
        PNG.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    groups = _groups(curves)
    marks = 5 if any(curve.branches for curve in curves) else 3
    legend = 0.22 * max(len(curves) + (transition is not None), marks) + 0.12
    tall = _strip_height(sheet, len(rows))
    height = _HEAD + tall + len(groups) * _PANEL + _FOOT + legend
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(_WIDTH, height), dpi=_DPI, facecolor=theme.PAPER)
        FigureCanvasAgg(figure)
        figure.text(0.035, 1 - 0.3 / height, title, fontsize=13, va="center", parse_math=False)
        figure.text(0.035, 1 - 0.57 / height, _MEANING, fontsize=9.5, color=theme.MUTED, va="center")
        strip = 1 - (_HEAD + tall) / height
        _strip(figure, sheet, curves[0], rows, strip, tall / height)
        for k, group in enumerate(groups):
            base = strip - ((k + 1) * _PANEL - 0.28) / height
            axes = figure.add_axes((_LEFT, base, _RIGHT - _LEFT, (_PANEL - 0.42) / height))
            axis = _AXES["free" if drive == "free" else "moved"] if k == len(groups) - 1 else ""
            draw_curves(axes, [curves[i] for i in group], group, curves[0].places[list(rows)], axis)
            if 0 in group:
                at = list(rows)
                axes.plot(curves[0].places[at], curves[0].energies[at], "o", **dot(theme.SERIES[0], 5.0))
        draw_legend(figure, curves, transition, (_LEFT, _RIGHT), legend / height)
        return _written(figure)


def _groups(curves: Sequence[Curve]) -> list[list[int]]:
    """Numbers of the curves of every panel, lowest first; one without energy goes with its neighbor."""
    heights = [float(curve.energies.max()) for curve in curves]
    groups: list[list[int]] = []
    lowest = 0.0
    for k in sorted(range(len(curves)), key=lambda k: heights[k]):
        if groups and (lowest <= NOTHING or heights[k] <= FAR_APART * lowest):
            groups[-1].append(k)
            lowest = lowest if lowest > NOTHING else heights[k]
        else:
            groups.append([k])
            lowest = heights[k]
    return [sorted(group) for group in groups]


def _slot(count: int) -> float:
    """Width of a state above the panels, as a part of the page."""
    return 0.97 * (_RIGHT - _LEFT) / (1 + 2 * ROOM) / max(1, count - 1)


def _strip_height(sheet: MovingSheet, count: int) -> float:
    """Height that states need above the panels, in inches: sheets that lie low leave no empty band."""
    width, height = sheet.extent
    return float(np.clip(1.1 * _slot(count) * _WIDTH * height / width, _LEAST_STRIP, _STRIP))


def _strip(figure: Figure, sheet: MovingSheet, curve: Curve, rows: Sequence[int], base: float, height: float) -> None:
    """The sheet on its way, every state tied to its place, with the scale of strain at the right."""
    from matplotlib.lines import Line2D

    width = (_RIGHT - _LEFT) / (1 + 2 * ROOM)
    slot = _slot(len(rows))
    page = figure.get_size_inches()[1]
    size = round(slot * _WIDTH * _DPI), round(0.97 * height * page * _DPI)
    for k, row in enumerate(rows):
        share = k / max(1, len(rows) - 1)
        middle = _LEFT + width * (ROOM + share)
        axes = figure.add_axes((middle - 0.5 * slot, base, slot, 0.97 * height))
        axes.imshow(np.asarray(sheet.picture(k, size)), interpolation="lanczos")
        axes.set_axis_off()
        # sheets stand evenly, their places on the curve may not
        place = _LEFT + width * (ROOM + float(np.clip(curve.places[row], -ROOM, 1 + ROOM)))
        ends = (middle, place), (base - 0.02 / page, base - _GAP / page)
        figure.add_artist(Line2D(*ends, color=theme.HAIRLINE, linewidth=0.9))
    words = f"sheet at λ = {power_words(curve.torsion)}" + ("" if sheet.is_strained else ", without strain")
    y = base + height + 0.12 / page
    small = {"fontsize": 8.5, "color": theme.MUTED, "va": "center"}
    if not sheet.is_strained:
        figure.text(_RIGHT, y, words, ha="right", **small)
        return
    left, width = 0.79, 0.13
    bar = figure.add_axes((left, y - 0.035 / page, width, 0.07 / page))
    bar.imshow(strain_colors()(np.linspace(0, 1, 200))[None], aspect="auto")
    bar.set_axis_off()
    figure.text(left - 0.008, y, f"{words}; largest strain of a tile:  0", ha="right", **small)
    figure.text(left + width + 0.008, y, f"{100 * sheet.largest_strain:.2g} %", ha="left", **small)


def _written(figure: Figure) -> bytes:
    from PIL import Image

    picture, buffer = io.BytesIO(), io.BytesIO()
    figure.savefig(picture, format="png", metadata={"Software": None})
    few = Image.open(picture).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    few.save(buffer, format="png", optimize=True)
    return buffer.getvalue()
