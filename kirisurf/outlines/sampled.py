"""Outlines given by points alone: which of them are corners, and what runs between these.

Points say nothing of what lies between them. A place where the polygon turns by more than `CORNER_ANGLE` is a
corner, also where two close vertices share the turn because the corner itself was no sample. Between corners,
points that follow one another in small turns are samples of a smooth curve: a cubic spline over the chord length
goes through them. Segments much longer than their neighbors stay straight, and so do runs of few points.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.outlines.corners import CORNER_ANGLE, check_corner_count
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.shapes import spline, straight

_FEWEST = 6
"""Points of a run that are taken as samples of a smooth curve."""

_LONG = 4.0
"""Times its shorter neighbor from which on a segment is straight."""


def sides_through(
    points: Float[np.ndarray, "n 2"], marks: Bool[np.ndarray, " n"] | None = None, name: str = "outline"
) -> tuple[tuple[Curve, ...], bool, str]:
    """Return sides through the vertices of a closed polygon, whether they are one smooth curve, and a sentence.

    Parameters
    ----------
    points : (n, 2)
        Consecutive ones differ, the last and the first too.
    marks : (n,) bool, optional
        The corners; by default they are found.
    name : str
        For messages.

    Raises
    ------
    UnusableError
        Where there are too many corners.
    """
    corner = _corners(points) if marks is None else marks
    long = _long_segments(points)
    check_corner_count(int(corner.sum()), name)
    # A closed run without corners begins with a straight segment, where it needs no condition.
    first = int(np.argmax(corner if corner.any() else long))
    x = np.roll(points, -first, axis=0)
    x, corner, long = np.concatenate([x, x[:1]]), np.roll(corner, -first), np.roll(long, -first)
    if not corner.any() and not long.any() and len(points) >= _FEWEST:
        return (spline(x, _chord_lengths(x), "periodic"),), True, _sentence(0, 1, 0)
    ends = [*np.flatnonzero(corner).tolist(), len(points)] if corner.any() else [0, len(points)]
    runs = [_run(x[a : b + 1], long[a:b]) for a, b in pairwise(ends)]
    curved = sum(is_curved for _, is_curved in runs)
    sides = tuple(side for side, _ in runs)
    return sides, not corner.any(), _sentence(int(corner.sum()), curved, len(sides) - curved)


def _corners(points: np.ndarray) -> np.ndarray:
    step = np.roll(points, -1, axis=0) - points
    length = np.linalg.norm(step, axis=1)
    before = np.roll(step, 1, axis=0)
    turn = np.arctan2(before[:, 0] * step[:, 1] - before[:, 1] * step[:, 0], (before * step).sum(axis=1))
    # Slack, so that rounding does not choose among equal vertices.
    corner = np.abs(turn) > CORNER_ANGLE + 1e-6
    if len(points) < 8:
        return corner
    # The two ends of segment i share a turn that their neighbors have no part in.
    following = np.roll(turn, -1)
    shared = turn + following
    beside = np.maximum(np.abs(np.roll(turn, 1)), np.abs(np.roll(turn, -2)))
    short = length <= 1.5 * np.maximum(np.roll(length, 1), np.roll(length, -1))
    pair = (np.abs(shared) > CORNER_ANGLE + 1e-6) & (beside < 0.125 * np.abs(shared)) & short
    pair &= ~corner & ~np.roll(corner, -1) & (turn * following > 0)
    for i in np.flatnonzero(pair):
        corner[i if abs(turn[i]) >= abs(following[i]) else (i + 1) % len(points)] = True
    return corner


def _long_segments(points: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    return length > _LONG * np.minimum(np.roll(length, 1), np.roll(length, -1))


def _run(x: np.ndarray, long: np.ndarray) -> tuple[Curve, bool]:
    # From corner to corner: straight segments, and splines that go on from them in their direction.
    breaks = np.flatnonzero(np.diff(np.r_[True, long, True].astype(int)) != 0)
    parts, is_curved = [], False
    marks = sorted({0, len(long), *breaks.tolist()})
    for a, b in pairwise(marks):
        part = x[a : b + 1]
        if long[a] or len(part) < _FEWEST:
            parts.append(straight(part))
            continue
        before = _direction(x[a - 1 : a + 1]) if a > 0 else None
        after = _direction(x[b : b + 2]) if b < len(long) else None
        conditions = tuple("not-a-knot" if end is None else (1, end) for end in (before, after))
        parts.append(spline(part, _chord_lengths(part), conditions))
        is_curved = True
    return joined(parts), is_curved


def _direction(ends: np.ndarray) -> np.ndarray:
    return (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])


def _chord_lengths(x: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])


def _sentence(corners: int, curved: int, straights: int) -> str:
    angle = math.degrees(CORNER_ANGLE)
    if not corners:
        kind = "a smooth spline goes through all points" if curved else "its segments are straight"
        return f"The points turn by less than {angle:.0f} degrees everywhere: {kind}, without corners."
    return (
        f"{corners} of the points are corners; of the sides between them {straights} "
        f"{'is' if straights == 1 else 'are'} straight segments and {curved} smooth "
        f"{'spline' if curved == 1 else 'splines'} through the points."
    )
