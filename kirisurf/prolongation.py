"""Prolongation: what a coarse sheet needed, carried over to a finer one.

The regular pattern laid on a flattening misses the constraints by an amount that hardly depends on the tile
size where the target asks for more stretch than tiles of one size can give. Corners that play the same part
in their unit cells then need the same displacement, measured in tile edges: it is a smooth field for each
part, in the frame of the surface, and what a coarse sheet found is a start for a finer one.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kirisurf.flattening import Flattening
from kirisurf.layout import Layout
from kirisurf.tessellation import Tessellation

NEIGHBORS = 6
"""Coarse vertices that a fine one looks at: a linear fit in the plane needs three."""

STIFFNESS = 0.05
"""Resistance of the slopes of the fits, which tames extrapolation at the outline (per squared unit cell)."""


def prolonged(coarse: Layout, displacements: Float[np.ndarray, "m 3"], fine: Layout) -> Float[np.ndarray, "n 3"]:
    """Return displacements for the vertices of a finer layout.

    Parameters
    ----------
    coarse, fine : Layout
        On one flattening.
    displacements : (m, 3)
        Of the coarse vertices from `coarse.points`, in the target's units.
    """
    unit = coarse.spacing
    local = np.einsum("mij,mj->mi", _frames(coarse.flattening, coarse.flat), displacements) / unit
    roles, wanted = vertex_roles(coarse.tessellation), vertex_roles(fine.tessellation)
    result = np.zeros((len(fine.flat), 3))
    for role in np.unique(wanted):
        known = np.flatnonzero(roles == role)
        if len(known) < NEIGHBORS:
            known = np.arange(len(roles))
        asked = wanted == role
        result[asked] = _fitted(coarse.flat[known] / unit, local[known], fine.flat[asked] / unit)
    return fine.spacing * np.einsum("nji,nj->ni", _frames(fine.flattening, fine.flat), result)


def vertex_roles(tessellation: Tessellation) -> Int[np.ndarray, " n"]:
    """Number the part that every vertex plays in its unit cell, (n,).

    Corners of a cell's tiles that share a vertex anywhere play one part, so that a vertex at the outline, where
    one of its tiles is missing, has the part of those inside.
    """
    owners, offsets = tessellation.tiles.owners, tessellation.tiles.offsets
    corner = (
        tessellation.cells[owners, 2] * int(tessellation.tiles.sizes.max()) + np.arange(len(owners)) - offsets[owners]
    )
    vertex = tessellation.tiles.indices
    least = np.full(tessellation.n_vertices, np.iinfo(np.int64).max)
    np.minimum.at(least, vertex, corner)
    n = int(corner.max()) + 1
    graph = coo_matrix((np.ones(len(corner)), (corner, least[vertex])), shape=(n, n))
    return connected_components(graph, directed=False)[1][least]


def _fitted(known: np.ndarray, values: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Moving least squares of first order, (k, 3)."""
    distance, near = cKDTree(known).query(asked, k=min(NEIGHBORS, len(known)))
    distance, near = distance.reshape(len(asked), -1), near.reshape(len(asked), -1)
    weight = np.maximum(1 - (distance / (1.05 * distance[:, -1:] + 1e-12)) ** 2, 1e-3) ** 2
    terms = np.concatenate([np.ones((*near.shape, 1)), known[near] - asked[:, None]], axis=2)
    weighted = terms * weight[:, :, None]
    matrix = np.einsum("tki,tkj->tij", weighted, terms)
    matrix[:, [1, 2], [1, 2]] += STIFFNESS * weight.sum(axis=1)[:, None]
    right = np.einsum("tki,tkj->tij", weighted, values[near])
    found = np.linalg.solve(matrix, right)[:, 0]
    # no new extremes: at the outline a slope may lead anywhere
    return np.clip(found, values[near].min(axis=1), values[near].max(axis=1))


def _frames(flattening: Flattening, flat: np.ndarray) -> np.ndarray:
    """Orthonormal rows (n, 3, 3) on the surface at flat points: along the first flat axis, across, normal."""
    surface = flattening.surface
    face, weights, _ = flattening.locate(flat)
    corner = surface.faces[face]
    normal = np.einsum("nk,nki->ni", weights, surface.normals[corner])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    solid, uv = surface.vertices[corner], flattening.uv[corner]
    sides = np.stack([solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]], axis=2)
    flat_sides = np.stack([uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]], axis=2)
    # first column of sides @ inverse(flat_sides): the image of the first flat axis
    along = np.linalg.solve(np.swapaxes(flat_sides, 1, 2), np.swapaxes(sides, 1, 2))[:, 0]
    along -= np.einsum("ni,ni->n", along, normal)[:, None] * normal
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.stack([along, np.cross(normal, along), normal], axis=1)
