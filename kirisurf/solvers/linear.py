"""Factorization of symmetric quasi-definite KKT matrices, with inertia."""

from __future__ import annotations

import numpy as np
import pymetis
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu

from kirisurf.solvers.assembly import Assembly, node_coo


class Ordering:
    """A fill-reducing elimination order of a KKT matrix, found once per pattern.

    Nested dissection (METIS) of the graph of vertices and rows; a vertex keeps its three coordinates
    together. Pivoting is off in the factorization, so that the order is the one that was chosen and the
    signs of the pivots are the inertia.
    """

    def __init__(self, assembly: Assembly) -> None:
        graph = node_coo(*assembly.node_graph())
        adjacency = pymetis.CSRAdjacency(graph.indptr.tolist(), graph.indices.tolist())
        order = np.asarray(pymetis.nested_dissection(adjacency)[0], dtype=np.int64)
        width = np.where(order < assembly.n, 3, 1)
        first = np.where(order < assembly.n, 3 * order, assembly.n_dofs + order - assembly.n)
        ends = np.cumsum(width)
        self.permutation = np.repeat(first - (ends - width), width) + np.arange(ends[-1])
        self.inverse = np.argsort(self.permutation)
        self._gather: np.ndarray | None = None

    def permuted(self, matrix: csc_matrix) -> csc_matrix:
        """Return P K P'; the gather of its entries is kept, as the pattern does not change."""
        if self._gather is None:
            numbered = csc_matrix(
                (np.arange(1, matrix.nnz + 1, dtype=np.float64), matrix.indices, matrix.indptr), shape=matrix.shape
            )
            moved = numbered[self.permutation][:, self.permutation].tocsc()
            moved.sort_indices()
            self._gather = moved.data.astype(np.int64) - 1
            self._indices, self._indptr = moved.indices, moved.indptr
        return csc_matrix((matrix.data[self._gather], self._indices, self._indptr), shape=matrix.shape)


class Factorization:
    """L D L' in effect: LU without pivoting of a symmetric matrix in nested-dissection order.

    Raises
    ------
    RuntimeError
        Where a pivot vanishes (SuperLU's own).
    """

    def __init__(self, matrix: csc_matrix, ordering: Ordering) -> None:
        self._ordering = ordering
        self._lu: SuperLU = splu(
            ordering.permuted(matrix),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True, "Equil": False},
        )

    @property
    def n_negative(self) -> int:
        """Number of negative pivots: of negative eigenvalues, by Sylvester's law."""
        return int((self._lu.U.diagonal() < 0).sum())

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solve with the factored matrix."""
        return self._lu.solve(right[self._ordering.permutation])[self._ordering.inverse]
