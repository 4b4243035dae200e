"""Curves of a deployment in a panel: energy over opening, where the sheet rests, and what the marks mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

from viewers import theme
from viewers.words import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROOM = 0.125
"""Room at both ends of the axis of openings, over its length."""

NOTHING = 1e-12
"""Energy up to which a curve is drawn as zero."""

_NEAR, _BELOW, _THIN = 0.005, 0.08, 0.7


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
    followed : (k - 1,) bool, optional
        Whether a smooth way leads from one state to the next, both in equilibrium; by default it does everywhere.
    ends : float
        Mean opening of the last state over that of the deployed sheet.
    branches : tuple of (places, energies)
        Equilibria past the jumps, most of which no opening holds.
    """

    torsion: float
    places: Float[np.ndarray, " k"]
    energies: Float[np.ndarray, " k"]
    rests: tuple[tuple[float, float], ...]
    tops: tuple[tuple[float, float], ...]
    contact: tuple[float, float] | None
    words: str
    followed: Bool[np.ndarray, " _"] | None = None
    ends: float = 1.0
    branches: tuple[tuple[Float[np.ndarray, " _"], Float[np.ndarray, " _"]], ...] = ()

    @property
    def is_smooth(self) -> bool:
        """Is every state reached without a jump?"""
        return self.followed is None or bool(np.all(self.followed))


def draw_curves(axes: Axes, curves: Sequence[Curve], numbers: Sequence[int], shown: np.ndarray, axis: str) -> None:
    """Draw the curves of a panel.

    Parameters
    ----------
    axes : Axes
    curves : sequence of Curve
    numbers : sequence of int
        Their places in the row of colors.
    shown : (k,)
        Places of the states that are shown above.
    axis : str
        Words for the axis of openings; it has no numbers where they are empty.
    """
    highest = max(max([float(curve.energies.max()), *(energy for _, energy in curve.tops)]) for curve in curves)
    top = highest if highest > NOTHING else 1.0
    power = int(np.floor(np.log10(top))) if highest > NOTHING else 0
    for x in shown.tolist():
        axes.axvline(x, color=theme.HAIRLINE, linewidth=0.8, zorder=0)
    for curve, k in zip(curves, numbers, strict=True):
        color = theme.SERIES[k % len(theme.SERIES)]
        axes.plot(curve.places, curve.energies, ":", color=color, linewidth=1.2)
        for places, energies in curve.branches:
            axes.plot(places, energies, color=color, linewidth=_THIN, alpha=0.75, zorder=1.5)
        for piece in _pieces(curve):
            axes.plot(curve.places[piece], curve.energies[piece], color=color, linewidth=1.8, solid_capstyle="round")
        for marks, marker, size in ((curve.rests, "o", 8.0), (curve.tops, "^", 8.5)):
            if marks:
                axes.plot(*np.array(marks).T, marker, **dot(color, size), clip_on=False, zorder=5)
        if curve.contact is not None:
            # on the axis, where it covers no state of rest
            axes.plot(curve.contact[0], -_BELOW * top, "X", **dot(color, 7.5), clip_on=False, zorder=6)
    ends = np.concatenate([curve.places for curve in curves])
    axes.set_xlim(min(-ROOM, float(ends.min())), max(1 + ROOM, float(ends.max())))
    axes.set_ylim(-_BELOW * top, 1.12 * top)
    if highest <= NOTHING:
        axes.set_yticks([0.0])
        axes.text(0.5, 0.5, "E = 0 all the way: no tile is strained", ha="center", color=theme.MUTED)
    axes.grid(axis="y", color=theme.HAIRLINE, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xticks(np.linspace(0, 1, 5), ["0", "0.25", "0.5", "0.75", "1"] if axis else [""] * 5)
    factor = 10.0**power
    axes.yaxis.set_major_formatter(lambda value, _: f"{value / factor:g}")
    axes.set_ylabel(f"energy E  ($10^{{{power}}}$)" if power else "energy E")
    axes.set_xlabel(axis)


def draw_legend(
    figure: Figure, curves: Sequence[Curve], transition: float | None, sides: tuple[float, float], height: float
) -> None:
    """Say below the panels what every curve is, and what the marks mean; sides and height are parts of the page."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=theme.SERIES[k % len(theme.SERIES)], linewidth=1.8) for k in range(len(curves))]
    words = [f"λ = {power_words(curve.torsion)}: {curve.words}{_reach(curve)}" for curve in curves]
    if transition is not None:
        lines.append(Line2D([], [], linestyle="none"))
        words.append(f"up to λ = {power_words(transition)} it rests open by itself")
    corner = (sides[0] - 0.01, height)
    common = {"fontsize": 9.5, "borderaxespad": 0.0, "handletextpad": 0.7}
    figure.legend(lines, words, loc="upper left", bbox_to_anchor=corner, **common)
    marks = [("o", "rests by itself")] if any(curve.rests for curve in curves) else []
    marks += [("^", "barrier")] if any(curve.tops for curve in curves) else []
    marks += [("X", "tiles first collide")] if any(curve.contact for curve in curves) else []
    dots = [Line2D([], [], linestyle="none", marker=marker, **dot(theme.MUTED, 7.5)) for marker, _ in marks]
    if not all(curve.is_smooth for curve in curves):
        dots.append(Line2D([], [], linestyle=":", linewidth=1.2, color=theme.MUTED))
        marks.append((":", "jumps, or is not in equilibrium"))
    if any(curve.branches for curve in curves):
        dots.append(Line2D([], [], linewidth=_THIN, color=theme.MUTED))
        marks.append(("-", "equilibria past the jumps"))
    corner = (sides[1], height)
    figure.legend(dots, [words for _, words in marks], loc="upper right", bbox_to_anchor=corner, **common)


def _pieces(curve: Curve) -> list[slice]:
    """Rows of a curve between its jumps, where there is more than one state."""
    if curve.followed is None:
        return [slice(0, len(curve.places))]
    edges = np.r_[0, 1 + np.flatnonzero(~np.asarray(curve.followed)), len(curve.places)]
    return [slice(a, b) for a, b in pairwise(edges.tolist()) if b - a > 1]


def _reach(curve: Curve) -> str:
    """Where a path ends that does not come to the shape."""
    return "" if abs(1 - curve.ends) <= _NEAR else f"; ends {100 * curve.ends:.0f} % open"


def dot(color: str, size: float) -> dict[str, Any]:
    """Return how a mark looks: in a color, with a rim of paper."""
    return {"color": color, "markersize": size, "markeredgecolor": theme.PAPER, "markeredgewidth": 1.2}


def power_words(value: float) -> str:
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
