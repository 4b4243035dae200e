"""Coarsening: the placement of a sheet with cells of about twice the size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kirisurf.placement import CLOSE, Placement
from kirisurf.regular import Regular
from kirisurf.trimming import rectangle_mask, sound_tiles

MOST_LOST = 0.2
"""Part of the tiles, counted as a quarter each, that a trimmed sheet may lose when it is coarsened."""


def coarser_placement(placement: Placement, regular: Regular) -> Placement | None:
    """Return the placement with cells of about twice the size; None where too little of the pattern is left."""
    motion = regular.motion
    if placement.shape is None:
        coarse, first = _halved(placement.mask, regular)
        if coarse.sum() < (1 - MOST_LOST) * placement.n_tiles / 4:
            return None
        matrix = 2 * placement.matrix
        return replace(placement, matrix=matrix, origin=placement.origin + matrix @ first, mask=coarse)
    columns, rows = ((side + 1) // 2 for side in placement.shape)
    mask = rectangle_mask(motion.cell, motion.adjacency, columns, rows)
    first, extent = regular.box(placement.mask)
    new_first, new_extent = regular.box(mask)
    # the same rectangle in the plane
    upright = placement.matrix @ np.linalg.inv(regular.lattice.T)
    scale = upright * (extent / new_extent)
    origin = placement.origin + upright @ first - scale @ new_first
    return replace(placement, matrix=scale @ regular.lattice.T, origin=origin, mask=mask, shape=(columns, rows))


def _halved(mask: np.ndarray, regular: Regular) -> tuple[np.ndarray, np.ndarray]:
    """Tiles of a lattice of half the resolution, each where half of its place was covered, and its first cell."""
    columns, rows, per_cell = mask.shape
    # one cell more all round: tiles of a cell may lie outside its place
    votes = np.zeros((columns // 2 + 3, rows // 2 + 3, per_cell))
    for column, row, tile, (c, r, coarse) in regular.halves:
        fine = mask[column::2, row::2, tile]
        votes[1 + c : 1 + c + fine.shape[0], 1 + r : 1 + r + fine.shape[1], coarse] += fine * regular.shares[tile]
    kept = sound_tiles(votes >= 2 * regular.shares - CLOSE, regular.motion.adjacency)
    skipped = 1 - np.array([kept[0].any(), kept[:, 0].any()], int)
    return kept[skipped[0] :, skipped[1] :], skipped - 1
