"""Contours of the contracted sheet: its outer outline, and the designed openings that stay open when it is flat."""

from __future__ import annotations

import numpy as np

from kirisurf.arrays import group_means
from kirisurf.tessellation import Tessellation


def welded_points(tessellation: Tessellation, contracted: np.ndarray) -> np.ndarray:
    """Mean (w, 2) of the copies of every welded vertex."""
    return group_means(contracted, tessellation.weld, tessellation.n_welded)


def contours(tessellation: Tessellation) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Return the welded vertices of the contours of the flat sheet, which lies on their left.

    Returns
    -------
    outline : (o,) int
        Of the outer contour, counter-clockwise.
    openings : tuple of (k,) int
        Of every designed opening, clockwise.
    """
    weld = tessellation.weld
    outline = weld[tessellation.outline]
    # the two ends of a notch are one vertex in the flat sheet
    outline = outline[outline != np.roll(outline, 1)]
    # sides come in the hole's order, with the hole on the left
    openings = (weld[tessellation.tiles.indices[sides]][::-1] for sides in tessellation.openings if len(sides))
    return outline, tuple(openings)


def signed_area(polygon: np.ndarray) -> float:
    """Area of a polygon (k, 2), positive where it runs counter-clockwise."""
    p = polygon - polygon[0]
    x, y = p.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
