"""Sizes of a sheet that are asked for: tile edges and openings."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.slit_ends import SlitEnds
from kirisurf.tessellation import Tessellation


def tile_edges(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " s"]:
    """Return the lengths of all tile edges (s,), in the order of `tessellation.tiles.indices`."""
    ends = points[tessellation.tiles.edges]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


def slit_openings(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " k"]:
    """Return the signed angle (k,) between the two sides of every slit end, in radians.

    It is seen along the mean of the two tiles' normals, and negative where the tiles overlap.
    """
    ends = SlitEnds.of(tessellation)
    corner = points[ends.stencil]
    u, v, d, e = (corner[:, k] - corner[:, 0] for k in range(1, 5))
    normals = [
        sign[:, None] * cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-300)
        for sign, cross in zip(ends.signs, (np.cross(v, d), np.cross(e, u)), strict=True)
    ]
    axis = normals[0] + normals[1]
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-300)
    along = (u * axis).sum(axis=1) * (v * axis).sum(axis=1)
    return np.arctan2((axis * np.cross(u, v)).sum(axis=1), (u * v).sum(axis=1) - along)
