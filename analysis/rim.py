"""The rim of a sheet, contracted and deployed, as walks along the tiles' sides."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from analysis import polygons
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation


def contracted_rim(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation
) -> tuple[list[Int[np.ndarray, " _"]], Float[np.ndarray, " s"]]:
    """Return the closed boundary curves of the contracted sheet, and how far tiles fill the angles between their sides.

    Tiles are followed from side to side round the point between two sides, so that parts that touch in a point and
    share no side there stay apart. A curve has the tiles on its left: it turns by 2 pi round the sheet and by -2 pi
    round an opening, with pi minus the filled angle at every point.

    Parameters
    ----------
    points : (n, 3), units
        Whose tile angles are summed: of the deployed state, or of the contracted one.
    tessellation : Tessellation

    Returns
    -------
    curves : list of (m,) int
        Sides of the boundary as positions in `tiles.indices`, in order.
    filled : (s,), radians
        Sum of the tile angles at the end of every side of the boundary; 0 for the other sides.
    """
    tiles = tessellation.tiles
    partner, after = partners(tessellation), _next_in_tile(tiles)
    angles = polygons.corner_angles(points, tiles)
    rim = np.flatnonzero(partner < 0)
    following, filled = np.full(len(partner), -1), np.zeros(len(partner))
    here, moving = after[rim], np.arange(len(rim))
    filled[rim] = angles[here]
    while len(moving := moving[partner[here[moving]] >= 0]):
        here[moving] = after[partner[here[moving]]]
        filled[rim[moving]] += angles[here[moving]]
    following[rim] = here
    return _cycles(following), filled


def deployed_rim(tessellation: Tessellation) -> Loops:
    """Return the pieces of the deployed rim between neighboring vertices of the outline, as paths of vertices.

    A piece is one side that has no partner on contraction, or a notch: the sides of slits that open to the outside,
    from the mouth through the inner vertices to the other end of the mouth. The sheet lies on the left.
    """
    tiles, n = tessellation.tiles, tessellation.n_vertices
    start, end = tiles.indices, tiles.successors
    following = _next_in_tile(tiles)
    first, middle, second = tessellation.hinges[:, :3].T
    key = start * n + end
    order = np.argsort(key)
    entering, leaving = (order[np.searchsorted(key[order], k)] for k in (first * n + middle, middle * n + second))
    following[entering] = leaving
    holes = tessellation.holes
    following[np.isin(end * n + start, holes.indices * n + holes.successors)] = -1
    slit = partners(tessellation) >= 0
    pieces = []
    for curve in _cycles(following):
        inner = slit[curve]
        begins = np.flatnonzero(~(inner & np.roll(inner, 1)))
        if not len(begins):
            continue
        curve = np.roll(curve, -begins[0])
        ends = np.r_[begins[1:] - begins[0], len(curve)]
        for low, high in zip(begins - begins[0], ends, strict=True):
            pieces.append(np.r_[start[curve[low:high]], end[curve[high - 1]]])
    return Loops.from_lists(pieces)


def partners(tessellation: Tessellation) -> Int[np.ndarray, " s"]:
    """Return the position of the other copy of every tile side on contraction, -1 where it has none."""
    weld, tiles, n = tessellation.weld, tessellation.tiles, tessellation.n_welded
    start, end = weld[tiles.indices], weld[tiles.successors]
    key, wanted = start * n + end, end * n + start
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key[order], wanted), len(key) - 1)
    return np.where(key[order][place] == wanted, order[place], -1)


def _next_in_tile(tiles: Loops) -> np.ndarray:
    after = np.arange(len(tiles.indices)) + 1
    after[tiles.offsets[1:] - 1] = tiles.offsets[:-1]
    return after


def _cycles(following: np.ndarray) -> list[np.ndarray]:
    """Closed curves of a permutation; entries of -1 belong to none."""
    succ = following.tolist()
    curves = []
    for first in np.flatnonzero(following >= 0).tolist():
        path, here = [], first
        while succ[here] >= 0:
            path.append(here)
            succ[here], here = -1, succ[here]
        if path:
            curves.append(np.array(path))
    return curves
