"""Factors of symmetric matrices that may be indefinite: a solve, and how many eigenvalues are negative."""

from __future__ import annotations

import numpy as np
import qdldl
from jaxtyping import Float
from scipy.sparse import csc_matrix


class Factors:
    """Factors of matrices on one sparsity pattern, whose order is found once; each replaces the one before.

    Behind it stands QDLDL, L D L' without row exchanges. Unlike a Cholesky factorization it passes indefinite
    matrices, which occur wherever a sheet is held at the top of a barrier, and by Sylvester's law of inertia D has as
    many negative numbers as the matrix has negative eigenvalues. SuperLU computes the same in two to four times the
    time, since it knows nothing of the symmetry.
    """

    def __init__(self) -> None:
        self._solver: qdldl.Solver | None = None
        self._count = 0

    def of(self, upper: csc_matrix) -> Factor:
        """Factor a matrix that is given by its upper half, diagonal included, always on the same pattern."""
        self._count += 1
        n_negative = -1
        try:
            if self._solver is None:
                self._solver = qdldl.Solver(upper, upper=True)
            else:
                self._solver.update(upper, upper=True)
            pivots = self._solver.factors()[1]
            # an update that met a pivot of exactly 0 leaves it there, and says nothing
            if np.isfinite(pivots).all() and (pivots != 0).all():
                n_negative = int((pivots < 0).sum())
        except RuntimeError:  # a pivot of exactly 0
            self._solver = None
        return Factor(self, self._count, n_negative)

    def _solved(self, count: int, right: np.ndarray) -> np.ndarray:
        if count != self._count or self._solver is None:
            raise RuntimeError("factor: expected the last one that was made, got one that was replaced or failed")
        return np.asarray(self._solver.solve(right))


class Factor:
    """One factor, of use until the next one of the same `Factors` is made.

    Attributes
    ----------
    n_negative : int
        Negative eigenvalues; -1 where the factorization failed.
    """

    def __init__(self, factors: Factors, count: int, n_negative: int) -> None:
        self._factors, self._count, self.n_negative = factors, count, n_negative

    def solve(self, right: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
        """Return x with A x = right, for one right side (m,) or several (m, k)."""
        if right.ndim == 1:
            return self._factors._solved(self._count, right)
        return np.stack([self._factors._solved(self._count, column) for column in right.T], axis=1)
