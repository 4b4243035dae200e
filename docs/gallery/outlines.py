"""The planar outlines as examples, each with a number that follows from how the outline is drawn."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

import kirisurf
from docs.gallery.example import Example, Measured
from docs.gallery.geometry import chord_loss, line_through, parabola_area, polygon_area, side_tips, tips

_ROUNDING = 1e-9
"""What rows that vanish to 1e-9 of a tile edge leave of a length of about 1."""


def _circle(design: kirisurf.Design) -> Measured:
    found, low = tips(design), np.sqrt(0.5)
    # a square and four parabolas on its sides, whose curvature is largest in their middles: 8 rise / chord^2
    expected = 2 + 4 * parabola_area(2 * low, 1 - low)
    return Measured(polygon_area(found), expected, chord_loss(found, 8 * (1 - low) / 2))


def _egg(design: kirisurf.Design) -> Measured:
    found = tips(design)
    half = np.sqrt(0.5) * np.array([1.065, 1.125])
    low, high = -1.5 * np.sqrt(0.5), 1.125 * np.sqrt(0.5)
    side = np.array([[half[0], low], [1.065, -0.213], [half[1], high]])
    corners = [(-half[0], low), (half[0], low), (half[1], high), (-half[1], high)]
    # a parabola evenly through three points holds four thirds of their triangle
    expected = polygon_area(corners) + 2 * 4 / 3 * polygon_area(side)
    expected += parabola_area(2 * half[0], low + 1.425) + parabola_area(2 * half[1], 1.425 - high)
    sharpest = 8 * (1.425 - high) / (2 * half[1]) ** 2
    return Measured(polygon_area(found), expected, chord_loss(found, sharpest))


def _rainbow(design: kirisurf.Design) -> Measured:
    above = side_tips(design, 2)
    bend = np.polynomial.Polynomial.fit(above[:, 0], above[:, 1], 2).convert().coef[2]
    return Measured(float(-bend) * 1.75**2, 0.5, _ROUNDING)


def _anvil(design: kirisurf.Design) -> Measured:
    right, left = line_through(side_tips(design, 1)), line_through(side_tips(design, 3))
    widths = [right[0] * y + right[1] - left[0] * y - left[1] for y in (-1.0, 1.0)]
    return Measured(widths[1] / widths[0], 1.75, _ROUNDING)


def _shear(design: kirisurf.Design) -> Measured:
    angles = [np.degrees(np.arctan2(1, line_through(side_tips(design, side))[0])) for side in (1, 3)]
    return Measured(float(np.mean(angles)), float(np.degrees(np.arctan2(2, 1))), float(np.degrees(_ROUNDING)))


def _wedge(design: kirisurf.Design) -> Measured:
    right, left = side_tips(design, 1), side_tips(design, 3)
    bends = [np.polynomial.Polynomial.fit(p[:, 1], p[:, 0], 2).convert()(0.0) for p in (right, left)]
    return Measured(float(bends[0] - bends[1]), 1.5, _ROUNDING)


def _star(design: kirisurf.Design) -> Measured:
    knots, points = np.arange(4), np.array([(-0.75, -2), (0, -1), (1, -1), (2, -0.75)])
    x, y = (np.polynomial.Polynomial.fit(knots, points[:, k], 3).convert() for k in range(2))
    worst = 0.0
    for side, turned in enumerate((1, 1j, -1, -1j)):
        for place in side_tips(design, side) @ (1, 1j) / turned:
            roots = (x - place.real).roots()
            t = roots[np.abs(roots.imag) < 1e-9].real
            worst = max(worst, float(np.abs(y(t[(t > -1e-9) & (t < 3 + 1e-9)]) - place.imag).min()))
    return Measured(worst, 0.0, _ROUNDING)


def _wavy(design: kirisurf.Design) -> Measured:
    below = side_tips(design, 0)
    wave = CubicSpline(np.linspace(-1, 1, 11), 0.1 * np.array([0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0]))
    found, expected = -1 - below[:, 1], wave(below[:, 0])
    return Measured(float((found @ expected) / (expected @ expected)) * 0.1, 0.1, _ROUNDING)


def _rect(design: kirisurf.Design) -> Measured:
    width, height = np.ptp(tips(design), axis=0)
    return Measured(float(height / width), 1.5, _ROUNDING)


def _disc(design: kirisurf.Design) -> Measured:
    away = np.linalg.norm(tips(design), axis=1)
    return Measured(float(away[np.abs(away - 1).argmax()]), 1.0, _ROUNDING)


def _ellipse(design: kirisurf.Design) -> Measured:
    strings = sum(np.linalg.norm(tips(design) - (focus, 0), axis=1) for focus in (-0.8, 0.8))
    return Measured(float(strings[np.abs(strings - 2).argmax()]), 2.0, _ROUNDING)


def _heart(design: kirisurf.Design) -> Measured:
    found = tips(design)
    return Measured(polygon_area(found), 2 + np.pi / 2, chord_loss(found, np.sqrt(2)))


def _letter_s(design: kirisurf.Design) -> Measured:
    found = tips(design)
    upper = found[found[:, 1] > 0.2]
    away = np.linalg.norm(upper - (0, 0.5), axis=1)
    round_end = (np.abs(away - 0.7) < 0.01) | (np.abs(away - 0.3) < 0.01)
    outer = away > 0.5
    width = float(away[round_end & outer].mean() - away[round_end & ~outer].mean())
    return Measured(width, 0.4, _ROUNDING)


_ROUND = (
    "The polygon through the tips loses at most curvature × chord³/12 a gap, with the largest curvature of the outline."
)
_EXACT = "The outer tips lie on the outline to 1e-9 of a tile edge."
_SQUARE = {"contracted": "rectangle:1"}

OUTLINES: tuple[Example, ...] = (
    Example(
        "circle",
        {"cells": (4, 4), **_SQUARE, "prefer": "smoothest"},
        "area of the polygon through the outer tips",
        "",
        "a square of area 2 and four parabolas on its sides: 2 + 4 · ⅔ √2 (1 − √½)",
        _ROUND,
        _circle,
    ),
    Example(
        "egg",
        {"cells": (4, 4), **_SQUARE},
        "area of the polygon through the outer tips",
        "",
        "a trapezium and four parabolas, by Archimedes",
        _ROUND,
        _egg,
    ),
    Example(
        "rainbow",
        {"tessellation": "islamic-quad", "cells": (3, 3)},
        "rise of the upper arch, by a parabola through its tips",
        "",
        "from 1 at its ends to 1.5 in its middle",
        _EXACT,
        _rainbow,
    ),
    Example(
        "anvil",
        {"tessellation": "hexagon", "cells": (4, 2)},
        "width above over width below, by lines through the tips",
        "",
        "3.5 over 2",
        _EXACT,
        _anvil,
    ),
    Example(
        "shear",
        {"tessellation": "kagome", "cells": (3, 4), "contracted": "rectangle"},
        "angle of the slanted sides, by lines through the tips",
        "°",
        "arctan 2",
        _EXACT,
        _shear,
    ),
    Example(
        "wedge",
        {"tessellation": "kagome", "cells": (3, 4), "contracted": "rectangle"},
        "width of the waist, by parabolas through the tips of the hollow sides",
        "",
        "twice 0.75",
        _EXACT,
        _wedge,
    ),
    Example(
        "star",
        {"cells": (5, 5), "contracted": "rectangle"},
        "largest distance of a tip to one cubic, with the four sides turned onto one another",
        "",
        "a quarter turn moves each side onto the next",
        _EXACT,
        _star,
    ),
    Example(
        "wavy",
        {"cells": (6, 6), "contracted": "rectangle"},
        "amplitude of the waves below, by least squares over the tips",
        "",
        "0.1 in the outline",
        _EXACT,
        _wavy,
    ),
    Example(
        "rect",
        {"tessellation": "islamic-quad", "cells": (3, 3)},
        "height over width of the box round the tips",
        "",
        "3 over 2",
        _EXACT,
        _rect,
    ),
    Example(
        "disc",
        {"tiles": 200},
        "distance of the tip to the center that is farthest from 1",
        "",
        "a circle of radius 1",
        _EXACT,
        _disc,
    ),
    Example(
        "ellipse",
        {"tessellation": "hexagon", "tiles": 100},
        "length of the gardener's string from focus to tip to focus, the worst of all",
        "",
        "2a with a = 1, foci at ±√(1 − 0.6²)",
        _EXACT,
        _ellipse,
    ),
    Example(
        "heart",
        {"tiles": 200},
        "area of the polygon through the outer tips",
        "",
        "a square of 2 on its corner and two half circles: 2 + π/2",
        _ROUND,
        _heart,
    ),
    Example(
        "letter-s",
        {"tessellation": "kagome", "tiles": 300},
        "width of the band round the upper bow",
        "",
        "0.7 − 0.3",
        _EXACT,
        _letter_s,
    ),
)
"""Every planar outline."""
