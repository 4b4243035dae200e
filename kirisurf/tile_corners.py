"""What the corners of tiles are in the regular contracted pattern: convex, straight or reflex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from kirisurf.arrays import frozen, group_means
from kirisurf.contours import contours
from kirisurf.tessellation import Tessellation

_STRAIGHT = 1e-6
"""Difference from pi (radians) of a straight corner."""


_NARROW = np.radians(170.0)
"""Gaps wider than this are no corners of an opening, but sides of the rim."""


@dataclass(frozen=True, eq=False)
class TileCorners:
    """Kinds of all corners, in the order of `tessellation.corners`; those that are neither are reflex.

    Attributes
    ----------
    convex, straight : (a,) bool
    """

    convex: Bool[np.ndarray, " a"]
    straight: Bool[np.ndarray, " a"]

    @classmethod
    def of(cls, tessellation: Tessellation) -> TileCorners:
        """Tell the corners of a tessellation apart."""
        before, here, after = tessellation.contracted[tessellation.corners].transpose(1, 0, 2)
        u, v = after - here, before - here
        angle = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)) % (2 * np.pi)
        straight = np.abs(angle - np.pi) < _STRAIGHT
        return cls(frozen((angle < np.pi) & ~straight, np.bool_), frozen(straight, np.bool_))


def open_gaps(tessellation: Tessellation) -> Int[np.ndarray, "g 3"]:
    """Return the corners that the contracted sheet leaves open, (next, vertex, previous) in welded vertices.

    They are those of designed openings, and the reentrant ones of the rim; the angle from the third to the first,
    outside the tiles, must not close, or the tiles along it overlap.
    """
    outline, openings = contours(tessellation)
    points = group_means(tessellation.contracted, tessellation.weld, tessellation.n_welded)
    gaps = np.concatenate([np.stack([np.roll(c, 1), c, np.roll(c, -1)], axis=1) for c in (outline, *openings)])
    # the sheet lies on the left: the gap is the angle from the edge before to the edge after, counter-clockwise
    before, here, after = points[gaps].transpose(1, 0, 2)
    u, v = before - here, after - here
    angle = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)) % (2 * np.pi)
    return gaps[(angle > _STRAIGHT) & (angle < _NARROW)][:, ::-1]
