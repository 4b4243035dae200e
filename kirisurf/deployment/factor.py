"""Factors of symmetric matrices that may be indefinite: a solve, and how many eigenvalues are negative."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from kirisurf.deployment.elements import Elements
from kirisurf.solvers.elimination_tree import find_fronts


class Factor:
    """A = L U of a symmetric matrix whose rows are in an order that fills little, without row exchanges.

    Without exchanges U = D L', and by Sylvester's law of inertia D has as many negative numbers as A has negative
    eigenvalues. SuperLU stands behind it: unlike a Cholesky factorization it passes indefinite matrices, which occur
    wherever a sheet is held at the top of a barrier.

    Attributes
    ----------
    n_negative : int
        Negative eigenvalues; -1 where the factorization failed.
    """

    def __init__(self, matrix: csc_matrix) -> None:
        self.n_negative = -1
        try:
            options = {"SymmetricMode": True}
            self._factor = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)
        except RuntimeError:  # exactly singular
            return
        pivots = self._factor.U.diagonal()
        if np.isfinite(pivots).all():
            self.n_negative = int((pivots < 0).sum())

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x with A x = right, for one right side (m,) or several (m, k)."""
        return self._factor.solve(right)


def numbered(elements: tuple[Elements, ...], free: np.ndarray, dimension: int) -> Int[np.ndarray, "n d"]:
    """Number the coordinates of free vertices such that a factorization fills little: by nested dissection.

    Parameters
    ----------
    elements : tuple of Elements
    free : (n,) bool
    dimension : int

    Returns
    -------
    (n, d)
        -1 for vertices that are not free.
    """
    place = np.full(len(free), -1)
    place[free] = np.arange(int(free.sum()))
    stencils = [kind.stencil[:, [i, j]] for kind in elements for i in range(kind.stencil.shape[1]) for j in range(i)]
    pairs = place[np.concatenate(stencils)]
    pairs = np.unique(np.sort(pairs[(pairs >= 0).all(axis=1)], axis=1), axis=0)
    count = int(free.sum())
    both = np.concatenate([pairs, pairs[:, ::-1]])
    order = find_fronts(count, both[:, 0], both[:, 1]).order if count else np.zeros(0, np.int64)
    result = np.full((len(free), dimension), -1)
    result[np.flatnonzero(free)[order]] = np.arange(count * dimension).reshape(count, dimension)
    return result
