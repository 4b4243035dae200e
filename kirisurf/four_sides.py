"""Outlines with four sides: those between a rectangle and a given one, and the patch over them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.outlines import Outline, spline

_KNOTS = 65
"""Points of a side on the way, which is a spline."""


def between(low: np.ndarray, high: np.ndarray, outline: Outline, t: float) -> Outline:
    """Return the outline between a rectangle (t = 0) and a given one with four sides (t = 1)."""
    if t >= 1:
        return outline
    corner = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    sides = []
    for k, side in enumerate(outline.sides):
        u = np.linspace(0, 1, _KNOTS)
        straight = corner[k] + u[:, None] * (corner[(k + 1) % 4] - corner[k])
        sides.append(spline((1 - t) * straight + t * side.points(u * side.n_pieces)))
    return Outline(outline.name, tuple(sides))


def patch(outline: Outline, place: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
    """Return the points of the bilinearly blended patch over four sides at places in the unit square (Coons 1967)."""
    u, v = place[:, :1], place[:, 1:]
    bottom, right, top, left = (
        side.points(w * side.n_pieces)
        for side, w in zip(outline.sides, (u[:, 0], v[:, 0], 1 - u[:, 0], 1 - v[:, 0]), strict=True)
    )
    a, b, c, d = outline.corners
    corners = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    return (1 - v) * bottom + v * top + (1 - u) * left + u * right - corners
