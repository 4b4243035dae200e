"""The figure of a deployment: energy along the way for several lambda, and above it the sheet on its way."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from viewers import theme
from viewers.moving_sheet import MovingSheet, deployment_film, strain_colors
from viewers.words import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Curve", "MovingSheet", "deployment_figure", "deployment_film"]

FAR_APART = 12.0
"""Curves whose highest points differ by more than this factor stand in panels of their own."""

_WIDTH, _DPI, _COLORS = 9.0, 150, 200
_LEFT, _RIGHT = 0.095, 0.975
_ROOM = 0.125
_STRIP, _PANEL, _HEAD, _FOOT = 1.75, 3.0, 1.0, 0.36
_NOTHING = 1e-12
_GAP = 0.14
_MEANING = "E: mean squared strain of the springs in the tiles, plus λ times the mean squared angle of the slits"
_AXES = {
    "free": "opening: mean angle of the slits, over that of the deployed sheet",
    "moved": "part of the way of the vertices that are moved",
}
_STYLE: Any = {
    "font.size": 10.0,
    "axes.edgecolor": theme.MUTED,
    "axes.labelcolor": theme.INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": theme.MUTED,
    "ytick.color": theme.MUTED,
    "legend.frameon": False,
    "text.color": theme.INK,
    "text.parse_math": True,
}


@dataclass(frozen=True, eq=False)
class Curve:
    """The energy along a path.

    Attributes
    ----------
    torsion : float
        lambda.
    places : (k,)
        Mean opening of the slits over that of the deployed sheet, or part of the way of what is moved.
    energies : (k,)
        Without unit.
    rests, tops : tuple of (place, energy)
        Where the sheet rests by itself, and the barriers between.
    contact : (place, energy) or None
        Where tiles first collide.
    words : str
        What the sheet does.
    """

    torsion: float
    places: Float[np.ndarray, " k"]
    energies: Float[np.ndarray, " k"]
    rests: tuple[tuple[float, float], ...]
    tops: tuple[tuple[float, float], ...]
    contact: tuple[float, float] | None
    words: str


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
    legend = 0.22 * max(len(curves) + (transition is not None), 3) + 0.12
    height = _HEAD + _STRIP + len(groups) * _PANEL + _FOOT + legend
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(_WIDTH, height), dpi=_DPI, facecolor=theme.PAPER)
        FigureCanvasAgg(figure)
        figure.text(0.035, 1 - 0.3 / height, title, fontsize=13, va="center", parse_math=False)
        figure.text(0.035, 1 - 0.57 / height, _MEANING, fontsize=9.5, color=theme.MUTED, va="center")
        strip = 1 - (_HEAD + _STRIP) / height
        _strip(figure, sheet, curves[0], rows, strip, _STRIP / height)
        for k, group in enumerate(groups):
            base = strip - ((k + 1) * _PANEL - 0.28) / height
            axes = figure.add_axes((_LEFT, base, _RIGHT - _LEFT, (_PANEL - 0.42) / height))
            axis = _AXES["free" if drive == "free" else "moved"] if k == len(groups) - 1 else ""
            _panel(axes, [curves[i] for i in group], group, curves[0].places[list(rows)], axis)
            if 0 in group:
                at = list(rows)
                axes.plot(curves[0].places[at], curves[0].energies[at], "o", **_dot(theme.SERIES[0], 5.0))
        _legend(figure, curves, transition, legend / height)
        return _written(figure)


def _groups(curves: Sequence[Curve]) -> list[list[int]]:
    """Numbers of the curves of every panel, lowest first; one without energy goes with its neighbor."""
    heights = [float(curve.energies.max()) for curve in curves]
    groups: list[list[int]] = []
    lowest = 0.0
    for k in sorted(range(len(curves)), key=lambda k: heights[k]):
        if groups and (lowest <= _NOTHING or heights[k] <= FAR_APART * lowest):
            groups[-1].append(k)
            lowest = lowest if lowest > _NOTHING else heights[k]
        else:
            groups.append([k])
            lowest = heights[k]
    return [sorted(group) for group in groups]


def _strip(figure: Figure, sheet: MovingSheet, curve: Curve, rows: Sequence[int], base: float, height: float) -> None:
    """The sheet on its way, every state tied to its place, with the scale of strain at the right."""
    from matplotlib.lines import Line2D

    width = (_RIGHT - _LEFT) / (1 + 2 * _ROOM)
    slot = 0.97 * width / max(1, len(rows) - 1)
    size = round(slot * _WIDTH * _DPI), round(0.97 * _STRIP * _DPI)
    page = figure.get_size_inches()[1]
    for k, row in enumerate(rows):
        share = k / max(1, len(rows) - 1)
        middle = _LEFT + width * (_ROOM + share)
        axes = figure.add_axes((middle - 0.5 * slot, base, slot, 0.97 * height))
        axes.imshow(np.asarray(sheet.picture(k, size)), interpolation="lanczos")
        axes.set_axis_off()
        # sheets stand evenly, their places on the curve may not
        place = _LEFT + width * (_ROOM + float(np.clip(curve.places[row], -_ROOM, 1 + _ROOM)))
        ends = (middle, place), (base - 0.02 / page, base - _GAP / page)
        figure.add_artist(Line2D(*ends, color=theme.HAIRLINE, linewidth=0.9))
    words = f"sheet at λ = {_power(curve.torsion)}" + ("" if sheet.is_strained else ", without strain")
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


def _panel(axes: Axes, curves: Sequence[Curve], numbers: Sequence[int], shown: np.ndarray, axis: str) -> None:
    highest = max(float(curve.energies.max()) for curve in curves)
    top = highest if highest > _NOTHING else 1.0
    power = int(np.floor(np.log10(top))) if highest > _NOTHING else 0
    for x in shown.tolist():
        axes.axvline(x, color=theme.HAIRLINE, linewidth=0.8, zorder=0)
    for curve, k in zip(curves, numbers, strict=True):
        color = theme.SERIES[k % len(theme.SERIES)]
        axes.plot(curve.places, curve.energies, color=color, linewidth=1.8, solid_capstyle="round")
        for marks, marker, size in ((curve.rests, "o", 8.0), (curve.tops, "^", 8.5)):
            if marks:
                axes.plot(*np.array(marks).T, marker, **_dot(color, size), clip_on=False, zorder=5)
        if curve.contact is not None:
            axes.plot(*curve.contact, "X", **_dot(color, 8.0), clip_on=False, zorder=6)
    ends = np.concatenate([curve.places for curve in curves])
    axes.set_xlim(min(-_ROOM, float(ends.min())), max(1 + _ROOM, float(ends.max())))
    axes.set_ylim(-0.04 * top, 1.12 * top)
    if highest <= _NOTHING:
        axes.set_yticks([0.0])
        axes.text(0.5, 0.5, "E = 0 all the way: no tile is strained", ha="center", color=theme.MUTED)
    axes.grid(axis="y", color=theme.HAIRLINE, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xticks(np.linspace(0, 1, 5), ["0", "0.25", "0.5", "0.75", "1"] if axis else [""] * 5)
    factor = 10.0**power
    axes.yaxis.set_major_formatter(lambda value, _: f"{value / factor:g}")
    axes.set_ylabel(f"energy E  ($10^{{{power}}}$)" if power else "energy E")
    axes.set_xlabel(axis)


def _legend(figure: Figure, curves: Sequence[Curve], transition: float | None, height: float) -> None:
    """Below the panels: what every curve is, and what the marks mean."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=theme.SERIES[k % len(theme.SERIES)], linewidth=1.8) for k in range(len(curves))]
    words = [f"λ = {_power(curve.torsion)}: {curve.words}" for curve in curves]
    if transition is not None:
        lines.append(Line2D([], [], linestyle="none"))
        words.append(f"up to λ = {_power(transition)} it rests open by itself")
    corner = (_LEFT - 0.01, height)
    common = {"fontsize": 9.5, "borderaxespad": 0.0, "handletextpad": 0.7}
    figure.legend(lines, words, loc="upper left", bbox_to_anchor=corner, **common)
    marks = [("o", "rests by itself")] if any(curve.rests for curve in curves) else []
    marks += [("^", "barrier")] if any(curve.tops for curve in curves) else []
    marks += [("X", "tiles first collide")] if any(curve.contact for curve in curves) else []
    dots = [Line2D([], [], linestyle="none", marker=marker, **_dot(theme.MUTED, 7.5)) for marker, _ in marks]
    corner = (_RIGHT, height)
    figure.legend(dots, [words for _, words in marks], loc="upper right", bbox_to_anchor=corner, **common)


def _dot(color: str, size: float) -> dict[str, Any]:
    return {"color": color, "markersize": size, "markeredgecolor": theme.PAPER, "markeredgewidth": 1.2}


def _power(value: float) -> str:
    """A number with its power of ten written out."""
    text = number(float(f"{value:.3g}"))
    if "e" not in text and value and abs(value) < 1e-2:
        exponent = int(np.floor(np.log10(abs(value))))
        text = f"{value / 10.0**exponent:.3g}e{exponent}"
    mantissa, _, exponent_text = text.partition("e")
    if not exponent_text:
        return mantissa
    power = f"$10^{{{exponent_text}}}$"
    return power if mantissa == "1" else f"{mantissa}·{power}"


def _written(figure: Figure) -> bytes:
    from PIL import Image

    picture, buffer = io.BytesIO(), io.BytesIO()
    figure.savefig(picture, format="png", metadata={"Software": None})
    few = Image.open(picture).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    few.save(buffer, format="png", optimize=True)
    return buffer.getvalue()
