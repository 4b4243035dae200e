"""Patterns: a unit cell repeated over a mask of cells, the one constructor of tessellations."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kirisurf.arrays import group_means
from kirisurf.derive import derive_tessellation
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import UnitCell, quad_cell


def tile_pattern(cell: UnitCell, mask: np.ndarray) -> Tessellation:
    """Repeat a unit cell over a mask.

    Two corners become one vertex where they coincide in both states (a hinge); vertices weld where they
    coincide in the contracted state.

    Parameters
    ----------
    cell : UnitCell
    mask : (columns, rows) or (columns, rows, tiles per cell) bool
        Cells, or single tiles, that belong to the pattern.

    Raises
    ------
    ParameterError
        Where the mask is empty or has another shape.
    """
    mask = np.asarray(mask, dtype=bool)
    k = len(cell.tiles)
    if mask.ndim == 2:
        mask = np.repeat(mask[:, :, None], k, axis=2)
    if mask.ndim != 3 or mask.shape[2] != k or not mask.any():
        raise ParameterError(f"mask: expected (columns, rows, {k}) with at least one tile, got {mask.shape}")
    row, column, which = np.nonzero(mask.transpose(1, 0, 2))
    sizes = cell.tiles.sizes[which]
    offsets = np.r_[0, np.cumsum(sizes)]
    owner = np.repeat(np.arange(len(which)), sizes)
    local = cell.tiles.indices[cell.tiles.offsets[which][owner] + np.arange(offsets[-1]) - offsets[owner]]
    shift = np.stack([column, row], axis=1)[owner].astype(float)
    deployed = cell.deployed[local] + shift @ cell.deployed_shifts
    contracted = cell.contracted[local] + shift @ cell.contracted_shifts

    vertex = _coincident(np.hstack([deployed, contracted]))
    n = int(vertex.max()) + 1
    deployed, contracted = group_means(deployed, vertex, n), group_means(contracted, vertex, n)
    return derive_tessellation(
        deployed,
        contracted,
        Loops(offsets, vertex),
        _coincident(contracted),
        np.stack([column, row, which], axis=1),
        cell.name,
    )


def quad_pattern(columns: int, rows: int, rotation: float = np.pi / 4) -> Tessellation:
    """Return a rectangular quad pattern of columns x rows unit cells (2 columns x 2 rows tiles)."""
    if columns < 1 or rows < 1:
        raise ParameterError(f"cells: expected at least 1x1, got {columns}x{rows}")
    return tile_pattern(quad_cell(rotation), np.ones((columns, rows), bool))


def _coincident(points: np.ndarray, radius: float = 1e-6) -> np.ndarray:
    """Number the groups of coincident points in order of first appearance, (n,) int."""
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    _, labels = connected_components(graph, directed=False)
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[inverse.ravel()]
