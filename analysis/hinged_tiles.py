"""Tiles that hinge: every two that share a vertex."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int
from scipy.sparse import coo_matrix

from kirisurf.loops import Loops


def hinged_tiles(tiles: Loops, n: int) -> Int[np.ndarray, "m 3"]:
    """Return every two tiles that share a vertex.

    Parameters
    ----------
    tiles : Loops
    n : int
        Number of vertices.

    Returns
    -------
    (m, 3) int
        Two tiles, the smaller first, and the vertex; of several common vertices the first. In ascending order.

    Examples
    --------
    >>> hinged_tiles(Loops.from_lists([[0, 1, 2], [2, 3, 4], [4, 5, 6]]), 7).tolist()
    [[0, 1, 2], [1, 2, 4]]
    """
    ones = np.ones(len(tiles.indices))
    incidence = coo_matrix((ones, (tiles.indices, tiles.owners)), shape=(n, len(tiles))).tocsr()
    rows = [np.zeros((0, 3), np.int64)]
    for vertex in np.flatnonzero(np.diff(incidence.indptr) > 1):
        around = np.sort(incidence.indices[incidence.indptr[vertex] : incidence.indptr[vertex + 1]])
        i, j = np.triu_indices(len(around), 1)
        rows.append(np.stack([around[i], around[j], np.full(len(i), vertex)], axis=1))
    found = np.concatenate(rows)
    found = found[np.lexsort(found.T[::-1])]
    is_new = np.r_[True, (np.diff(found[:, :2], axis=0) != 0).any(axis=1)]
    return found[is_new[: len(found)]]
