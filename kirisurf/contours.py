"""Contours of the contracted sheet: its outer outline, and the designed openings that stay open when it is flat."""

from __future__ import annotations

import numpy as np

from kirisurf.tessellation import Tessellation


def welded_points(tessellation: Tessellation, contracted: np.ndarray) -> np.ndarray:
    """Mean (w, 2) of the copies of every welded vertex."""
    weld, n = tessellation.weld, tessellation.n_welded
    count = np.bincount(weld, minlength=n)[:, None]
    return np.stack([np.bincount(weld, contracted[:, axis], n) for axis in range(2)], axis=1) / count


def contours(tessellation: Tessellation, points: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Follow the tile sides that no other tile shares in the flat sheet.

    Parameters
    ----------
    tessellation : Tessellation
    points : (w, 2)
        Welded points.

    Returns
    -------
    outline : (o,) int
        Welded vertices of the outer contour, counter-clockwise.
    others : tuple of (k,) int
        Those of every other contour, the sheet on its left: clockwise for an opening, counter-clockwise for a
        part that hangs on the rest by a point.
    """
    weld, tiles = tessellation.weld, tessellation.tiles
    sides = weld[tiles.edges].tolist()
    number = {(a, b): k for k, (a, b) in enumerate(sides)}
    following = np.arange(len(sides)) + 1
    following[tiles.offsets[1:] - 1] = tiles.offsets[:-1]
    after = following.tolist()
    twin = [number.get((b, a), -1) for a, b in sides]

    loops, seen = [], set()
    for first in range(len(sides)):
        if twin[first] >= 0 or first in seen:
            continue
        loop, here = [], first
        while here not in seen:
            seen.add(here)
            loop.append(sides[here][0])
            here = after[here]
            while twin[here] >= 0:  # turn about the vertex, from tile to tile, to the next side without a neighbor
                here = after[twin[here]]
        loops.append(np.array(loop))
    outer = int(np.argmax([signed_area(points[loop]) for loop in loops]))
    return loops[outer], tuple(loop for k, loop in enumerate(loops) if k != outer)


def signed_area(polygon: np.ndarray) -> float:
    """Area of a polygon (k, 2), positive where it runs counter-clockwise."""
    p = polygon - polygon[0]
    x, y = p.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
