"""Assembly of the matrices of a step on a sparsity pattern that is found once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix

from kirisurf.block import Block
from kirisurf.solvers.vertex_pairs import BlockSum, Stencil, VertexPairs


class Assembly:
    """Hessians H and products J'J, and the Jacobian J of the equalities.

    H and J'J are symmetric: of both the 3x3 blocks of the upper half are kept, on one pattern.

    Parameters
    ----------
    n_vertices : int
    equalities : sequence of Block
        Blocks whose rows enter J.
    stencils : sequence of Stencil
        Stencils of everything that adds to H.
    """

    def __init__(self, n_vertices: int, equalities: Sequence[Block], stencils: Sequence[Stencil]) -> None:
        self.n, self.n_dofs = n_vertices, 3 * n_vertices
        sizes = [len(b.stencil) * b.n_rows for b in equalities]
        self.n_rows = int(sum(sizes))
        own = [b.stencil for b in equalities]
        self.pattern = VertexPairs(n_vertices, [*stencils, *own])
        self._hessian, self._normal = BlockSum(self.pattern, stencils), BlockSum(self.pattern, own)
        self._diagonal = self.pattern.pointers[:-1]  # a row begins with it
        rows, columns = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
        for block, start in zip(equalities, np.cumsum([0, *sizes]), strict=False):
            shape = len(block.stencil), block.n_rows, 3 * block.stencil.shape[1]
            dofs = 3 * block.stencil[:, None, :, None] + np.arange(3)
            columns.append(np.broadcast_to(dofs.reshape(shape[0], 1, shape[2]), shape).ravel())
            rows.append(np.repeat(start + np.arange(shape[0] * shape[1]), shape[2]))
        place = np.concatenate(rows), np.concatenate(columns)
        pattern = csr_matrix((np.ones(len(place[0]), np.int8), place), shape=(self.n_rows, self.n_dofs))
        pattern.sum_duplicates()
        numbers = csr_matrix((np.arange(pattern.nnz), pattern.indices, pattern.indptr), shape=pattern.shape)
        self._jacobian, self._places = pattern, np.asarray(numbers[place]).ravel()

    def hessian(self, sources: Iterable[np.ndarray | None]) -> np.ndarray:
        """Add up blocks (k, 3 p, 3 q) in the order of the stencils, None for zeros; (pairs, 3, 3)."""
        return self._hessian.sum(sources)

    def normal(self, jacobians: Sequence[np.ndarray]) -> np.ndarray:
        """Add up J'J from the blocks' Jacobians (g, r, 3 p), (pairs, 3, 3)."""
        return self._normal.sum(product(j) for j in jacobians)

    def shifted(self, blocks: np.ndarray, shift: float) -> np.ndarray:
        """Return blocks with a multiple of the identity added to the matrix."""
        if shift == 0:
            return blocks
        result = blocks.copy()
        self.shift(result, shift)
        return result

    def shift(self, blocks: np.ndarray, amount: float) -> None:
        """Add a multiple of the identity to the matrix, in place."""
        blocks[self._diagonal] += amount * np.eye(3)

    def apply(self, blocks: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the product of a symmetric matrix with x (3 n,)."""
        shape = self.n_dofs, self.n_dofs
        upper = bsr_matrix((blocks, self.pattern.columns, self.pattern.pointers), shape=shape)
        diagonal = np.matmul(blocks[self._diagonal], x.reshape(-1, 3, 1)).ravel()
        return upper @ x + upper.T @ x - diagonal

    def matrix(self, blocks: np.ndarray) -> bsr_matrix:
        """Return both halves as a sparse matrix (3 n, 3 n), the blocks of each row in order."""
        both = self.pattern.both
        whole, turned = blocks[both.data // 2], both.data % 2 == 1
        whole[turned] = np.swapaxes(whole[turned], 1, 2)
        return bsr_matrix((whole, both.indices, both.indptr), shape=(self.n_dofs, self.n_dofs))

    def jacobian(self, jacobians: Sequence[np.ndarray]) -> csr_matrix:
        """Return J (rows, 3 n)."""
        values = np.concatenate([np.zeros(0), *(j.ravel() for j in jacobians)])
        data = np.bincount(self._places, values, self._jacobian.nnz)
        return csr_matrix((data, self._jacobian.indices, self._jacobian.indptr), shape=self._jacobian.shape)


def product(jacobian: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
    """Return J' diag(weights) J (g, 3 p, 3 p) of groups' Jacobians (g, r, 3 p) and weights (g, r)."""
    jacobian = np.ascontiguousarray(jacobian)
    left = jacobian if weights is None else jacobian * weights[:, :, None]
    if jacobian.shape[1] == 1:  # a product of vectors needs no BLAS
        return left[:, 0, :, None] * jacobian[:, 0, None, :]
    return np.swapaxes(left, 1, 2) @ jacobian
