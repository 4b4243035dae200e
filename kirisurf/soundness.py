"""Soundness of a sheet: what its equations do not see, since they know angles without signs and only neighbors."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Float

from kirisurf.crossing import tiles_cross
from kirisurf.slit_ends import SlitEnds
from kirisurf.tessellation import Tessellation


def are_convex(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> bool:
    """Do all tiles turn the same way at all of their corners?"""
    for _, tiles in tessellation.tiles.by_size().values():
        corner = points[tiles]
        side = np.roll(corner, -1, axis=1) - corner
        turn = np.cross(np.roll(side, 1, axis=1), side)
        if (np.einsum("tki,tki->tk", turn, np.roll(turn, -1, axis=1)) <= 0).any():
            return False
    return True


def are_facing(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> bool:
    """Are all tiles that hinge on each other folded by less than a right angle?"""
    ends = SlitEnds.of(tessellation)
    corner = points[ends.stencil]
    b, c, d, e = (corner[:, k] - corner[:, 0] for k in range(1, 5))
    return bool((ends.signs.prod(axis=0) * np.einsum("ki,ki->k", np.cross(e, b), np.cross(c, d)) > 0).all())


def are_sound(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> bool:
    """Are all tiles convex, do neighbors face the same way, and does none cross another?"""
    whole = are_convex(tessellation, points) and are_facing(tessellation, points)
    return whole and not tiles_cross(tessellation, points)


def are_apart(tessellation: Tessellation, flat: Float[np.ndarray, "n 2"]) -> bool:
    """Do the tiles of a flat sheet, contracted or deployed, lie side by side?

    Neighbors cannot overlap where the rows hold, but tiles on both sides of a hole or a bay of the rim can.
    """
    polygons = np.array([shapely.Polygon(flat[tile]) for tile in tessellation.tiles])
    # common sides are equal up to rounding only: tiles a little smaller than they are do not touch
    edges = flat[tessellation.tiles.edges]
    size = float(np.median(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)))
    smaller = shapely.buffer(polygons, -1e-5 * size)
    first, second = shapely.STRtree(smaller).query(smaller, predicate="intersects")
    return bool((first == second).all())
