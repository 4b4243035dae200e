"""Corners of closed curves: where they turn, where they are cut, and four of them for a rectangular pattern."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely
from jaxtyping import Float
from numpy.typing import ArrayLike
from scipy.optimize import brentq, minimize_scalar

from kirisurf.errors import UnusableError
from kirisurf.outlines.curve import Curve, joined

if TYPE_CHECKING:
    from kirisurf.outlines.outline import Outline

CORNER_ANGLE = math.radians(20.0)
"""Turning at one place (radians) from which on it is a corner."""

MOST_CORNERS = 1000
"""Corners of an outline; one that has more is jagged, and no pattern follows it."""

_SNAP = 1e-9
"""Pieces from a joint within which a mark is the joint."""

_AS_SMALL = 1e-4
"""Relative difference of areas below which two rectangles are equal: that of a circle and its samples."""


def corner_parameters(curve: Curve, angle: float) -> Float[np.ndarray, " c"]:
    """Return the parameters (c,) of the joints where a closed curve turns by more than an angle (radians)."""
    every = np.arange(curve.n_pieces)
    before = curve.tangents(np.roll(every, 1), np.ones(len(every)))
    after = curve.tangents(every, np.zeros(len(every)))
    turns = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1))
    # Slack, so that rounding does not choose among equal corners.
    return np.flatnonzero(np.abs(turns) > angle + 1e-6).astype(np.float64)


def check_corner_count(count: int, name: str) -> None:
    """Raise UnusableError where an outline has more than `MOST_CORNERS` corners."""
    if count > MOST_CORNERS:
        raise UnusableError(
            f"{name}: expected at most {MOST_CORNERS} corners, got {count}: smooth the outline, it is jagged"
        )


def cut(curve: Curve, marks: Float[np.ndarray, " c"]) -> tuple[Curve, ...]:
    """Cut a closed curve at parameters (c,); the first part begins at the smallest of them.

    Raises
    ------
    UnusableError
        Where two of them coincide.
    """
    n = float(curve.n_pieces)
    u = np.mod(marks, n)
    u = np.where(np.abs(u - np.round(u)) <= _SNAP, np.round(u), u)
    u = np.sort(np.mod(u, n))
    if len(u) > 1 and np.diff(np.concatenate([u, u[:1] + n])).min() <= _SNAP:
        raise UnusableError(f"corners: expected {len(u)} different places, got parameters {u.tolist()} of {n:g}")
    parts = [curve.part(float(a), float(b)) for a, b in pairwise(u)]
    last = [curve.part(float(u[-1]), n)] + ([curve.part(0.0, float(u[0]))] if u[0] > 0 else [])
    return (*parts, joined(last))


def four_sided(outline: Outline, corners: ArrayLike | None = None) -> tuple[Outline, str]:
    """Return a copy with four sides, bottom, right, top, left, and a sentence on how its corners were chosen.

    Raises
    ------
    UnusableError
        Where the given corners are not four different places.
    """
    if corners is not None:
        marked = outline.with_corners(corners)
        if marked.n_corners != 4:
            raise UnusableError(f"{outline.name}: expected four corners, got {marked.n_corners}")
        return _first_at_lower_left(marked), "The four given corners are those of the pattern."
    if outline.n_corners == 4:
        return _first_at_lower_left(outline), "The four corners of the outline are those of the pattern."
    sharp = outline.find_corners()
    if len(sharp) == 4:
        chosen, note = outline.with_corners(sharp), "The four sharp corners of the outline are those of the pattern."
        return _first_at_lower_left(chosen), note
    chosen = _first_at_lower_left(outline.with_corners(_farthest(outline.curve)))
    places = ", ".join(f"({x:.4g}, {y:.4g})" for x, y in chosen.corners)
    return chosen, (
        f"The outline has {len(sharp)} sharp corners, not four: those of the pattern are the points that reach "
        f"farthest towards the corners of the smallest rectangle round it, {places}."
    )


def _first_at_lower_left(outline: Outline) -> Outline:
    # The corner with the least x + y; among equal ones the lower.
    height = outline.corners.sum(axis=1)
    equal = np.flatnonzero(height <= height.min() + 1e-6 * outline.diagonal)
    first = int(equal[np.argmin(outline.corners[equal, 1])])
    return outline.with_first_side(first)


def _farthest(curve: Curve) -> np.ndarray:
    # Parameters of the points farthest in the four diagonal directions of the smallest rectangle, its sides
    # scaled to one length.
    fine = np.linspace(0.0, 1.0, 8, endpoint=False)
    samples = curve.samples
    s = samples.low[:, None] + (samples.high - samples.low)[:, None] * fine
    points = curve.evaluated(np.repeat(samples.pieces, len(fine)), s.ravel())[0]
    hull = np.asarray(shapely.MultiPoint(points).convex_hull.exterior.coords)
    angle = _rectangle_angle(hull)
    frame = _frame(angle)
    half = 0.5 * np.ptp(hull @ frame, axis=0)
    return np.array([_extreme(curve, frame @ (np.array(d) / half)) for d in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def _rectangle_angle(hull: np.ndarray) -> float:
    # Direction within 45 degrees of the x axis; the axis itself where its rectangle is as small as any.
    def size(angle: float) -> float:
        return float(np.prod(np.ptp(hull @ _frame(angle), axis=0)))

    step = np.radians(0.5)
    angles = np.arange(-90, 90) * step
    best = float(angles[np.argmin([size(angle) for angle in angles])])
    found = minimize_scalar(size, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-12})
    return 0.0 if size(0.0) <= (1 + _AS_SMALL) * min(size(best), float(found.fun)) else float(found.x)


def _frame(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _extreme(curve: Curve, direction: np.ndarray) -> float:
    # Parameter of the first point that is farthest in a direction: a sample, then where the curve is across to it.
    samples = curve.samples
    m = len(samples.pieces)
    height = samples.points[:-1] @ direction
    k = int(np.flatnonzero(height >= height.max() - 1e-9 * np.ptp(height))[0])
    best, u = height[k], float(samples.pieces[k] + samples.low[k])
    for interval in ((k - 1) % m, k):
        piece = samples.pieces[interval : interval + 1]

        def slope(s: float, piece: np.ndarray = piece) -> float:
            return float((curve.evaluated(piece, np.array([s]))[1] @ direction)[0])

        low, high = float(samples.low[interval]), float(samples.high[interval])
        if slope(low) > 0 > slope(high):
            s = float(brentq(slope, low, high, xtol=1e-15))
            reached = float((curve.evaluated(piece, np.array([s]))[0] @ direction)[0])
            if reached > best:
                best, u = reached, float(piece[0]) + s
    return u
