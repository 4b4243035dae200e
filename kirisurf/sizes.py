"""Sizes of a sheet that are asked for: tile edges and openings."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

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
