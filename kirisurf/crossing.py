"""Do tiles cross in space? Edges of tiles against the triangles of others.

The certificate asks the same in its own way (`analysis.intersections`); this is for the solver, which must know
whether a sheet is worth keeping.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_matrix
from scipy.spatial import cKDTree

from kirisurf.tessellation import Tessellation

DEPTH = 1e-6
"""Part of an edge and of a triangle at their ends that is taken for a touch."""


def tiles_cross(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> bool:
    """Does an edge of a tile pierce another tile with which it has no vertex in common?"""
    first, second = _near_pairs(tessellation, points)
    loops = tessellation.tiles
    for k, (which, tiles) in loops.by_size().items():
        number = np.full(len(loops), -1)
        number[which] = np.arange(len(which))
        for j in range(1, k - 1):
            triangles = points[tiles[:, [0, j, j + 1]]]
            for owner, pierced in ((first, second), (second, first)):
                chosen = number[pierced] >= 0
                edge, count = _edges_of(tessellation, owner[chosen])
                triangle = triangles[np.repeat(number[pierced[chosen]], count)]
                if _pierces(points[edge[:, 0]], points[edge[:, 1]], triangle).any():
                    return True
    return False


def _near_pairs(tessellation: Tessellation, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of tiles whose bounding balls meet and that share no vertex."""
    loops = tessellation.tiles
    corner, owner = points[loops.indices], loops.owners
    center = np.add.reduceat(corner, loops.offsets[:-1], axis=0) / loops.sizes[:, None]
    radius = np.maximum.reduceat(np.linalg.norm(corner - center[owner], axis=1), loops.offsets[:-1])
    pairs = cKDTree(center).query_pairs(2 * float(radius.max()), output_type="ndarray")
    apart = np.linalg.norm(center[pairs[:, 0]] - center[pairs[:, 1]], axis=1)
    pairs = pairs[apart < radius[pairs].sum(axis=1)]
    if not len(pairs):  # sparse matrices answer differently when they are asked for nothing
        return pairs[:, 0], pairs[:, 1]
    shape = len(loops), tessellation.n_vertices
    incidence = coo_matrix((np.ones(len(owner)), (owner, loops.indices)), shape=shape).tocsr()
    sharing = np.asarray((incidence @ incidence.T)[pairs[:, 0], pairs[:, 1]]).ravel() > 0
    return pairs[~sharing, 0], pairs[~sharing, 1]


def _edges_of(tessellation: Tessellation, tiles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All edges (e, 2) of tiles one after the other, and their number for each tile."""
    loops = tessellation.tiles
    count = loops.sizes[tiles]
    before = np.cumsum(count) - count
    place = np.repeat(loops.offsets[tiles] - before, count) + np.arange(count.sum())
    return loops.edges[place], count


def _pierces(begin: np.ndarray, end: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Does the segment go through the inside of the triangle? (m,) bool; Moeller and Trumbore's test."""
    direction = end - begin
    u, v = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    normal = np.cross(u, v)
    away = begin - triangle[:, 0]
    slope = np.einsum("mi,mi->m", direction, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -np.einsum("mi,mi->m", away, normal) / slope
        turned = np.cross(away, direction)
        a = -np.einsum("mi,mi->m", turned, v) / slope
        b = np.einsum("mi,mi->m", turned, u) / slope
    return (t > DEPTH) & (t < 1 - DEPTH) & (a > DEPTH) & (b > DEPTH) & (a + b < 1 - DEPTH)
