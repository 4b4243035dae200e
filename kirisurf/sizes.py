"""Sizes of a sheet that are asked for: tile edges and openings."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.crossing import tiles_cross
from kirisurf.tessellation import Tessellation


def tile_edges(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " s"]:
    """Return the lengths of all tile edges (s,), in the order of `tessellation.tiles.indices`."""
    ends = points[tessellation.tiles.edges]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


def slit_openings(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " k"]:
    """Return the unsigned angle (k,) between the two sides of every slit end, in radians."""
    ends = points[tessellation.hinges[tessellation.slit_ends, :3]]
    u, v = ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 1]
    return np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), np.einsum("ki,ki->k", u, v))


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
    ends = points[tessellation.hinges[tessellation.slit_ends]]
    b, c, d, e = (ends[:, k] - ends[:, 1] for k in (0, 2, 3, 4))
    return bool((np.einsum("ki,ki->k", np.cross(e, b), np.cross(c, d)) > 0).all())


def are_sound(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> bool:
    """Are all tiles convex, do neighbors face the same way, and does none cross another?"""
    whole = are_convex(tessellation, points) and are_facing(tessellation, points)
    return whole and not tiles_cross(tessellation, points)
