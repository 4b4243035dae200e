"""Soundness of a sheet: what its equations do not see, since they know angles without signs and only neighbors."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.crossing import tiles_cross
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
    ends = points[tessellation.hinges[tessellation.slit_ends]]
    b, c, d, e = (ends[:, k] - ends[:, 1] for k in (0, 2, 3, 4))
    return bool((np.einsum("ki,ki->k", np.cross(e, b), np.cross(c, d)) > 0).all())


def are_sound(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> bool:
    """Are all tiles convex, do neighbors face the same way, and does none cross another?"""
    whole = are_convex(tessellation, points) and are_facing(tessellation, points)
    return whole and not tiles_cross(tessellation, points)
