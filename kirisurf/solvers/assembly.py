"""Assembly of the matrices of a step on a sparsity pattern that is found once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix

from kirisurf.block import Block


class BlockPattern:
    """Sums dense blocks of vertex groups into unique (row node, vertex) pairs, ordered by row and vertex.

    Parameters
    ----------
    rows, columns : sequences of (k_i,) int
        Node pair of every block of every source.
    width : int
        Bound of the column nodes.
    shape : tuple of int
        Shape of one block.
    """

    def __init__(self, rows: Sequence[np.ndarray], columns: Sequence[np.ndarray], width: int, shape: tuple) -> None:
        keys = [r.ravel() * width + c.ravel() for r, c in zip(rows, columns, strict=True)]
        unique, inverse = np.unique(np.concatenate(keys) if keys else np.zeros(0, np.int64), return_inverse=True)
        self.rows, self.columns = unique // width, unique % width
        self._size = int(np.prod(shape))
        self._shape = shape
        ends = np.cumsum([len(k) for k in keys])
        flat = inverse.ravel()[:, None] * self._size + np.arange(self._size)
        self._targets = [f.ravel() for f in np.split(flat, ends[:-1])] if keys else []

    def sum(self, sources: Sequence[np.ndarray], first: int = 0) -> np.ndarray:
        """Add up blocks of successive sources, from number `first` on, (unique pairs, *shape)."""
        n = len(self.rows) * self._size
        total = np.zeros(n)
        for target, values in zip(self._targets[first:], sources, strict=False):
            total += np.bincount(target, values.ravel(), n)
        return total.reshape(-1, *self._shape)

    def pointers(self, n_rows: int) -> np.ndarray:
        """Start of every row in the sorted pairs, (n_rows + 1,)."""
        return np.searchsorted(self.rows, np.arange(n_rows + 1))


def vertex_blocks(values: np.ndarray) -> np.ndarray:
    """Reshape second derivatives (c, 3q, 3q) to vertex pairs (c, q, q, 3, 3)."""
    c, q = len(values), values.shape[1] // 3
    return values.reshape(c, q, 3, q, 3).transpose(0, 1, 3, 2, 4)


class Assembly:
    """Hessians H and products J'J (both by 3x3 blocks on one pattern), and the Jacobian J of the equalities.

    Parameters
    ----------
    n_vertices : int
    equalities : sequence of Block
        Blocks whose rows enter J.
    stencils : sequence of (c, q) int
        Stencils of everything that adds to H.
    """

    def __init__(self, n_vertices: int, equalities: Sequence[Block], stencils: Sequence[np.ndarray]) -> None:
        self.n, self.n_dofs = n_vertices, 3 * n_vertices
        sizes = [len(b.stencil) * b.n_rows for b in equalities]
        self.n_rows = int(sum(sizes))
        every = [*stencils, *(b.stencil for b in equalities)]
        pairs = [np.broadcast_arrays(s[:, :, None], s[:, None, :]) for s in every]
        vertices = np.arange(n_vertices)
        self.pattern = BlockPattern(
            [*(p[0] for p in pairs), vertices], [*(p[1] for p in pairs), vertices], n_vertices, (3, 3)
        )
        self._n_stencils = len(stencils)
        self._pointers = self.pattern.pointers(n_vertices)
        self._diagonal = np.flatnonzero(self.pattern.rows == self.pattern.columns)
        rows, columns = [], []
        for block, start in zip(equalities, np.cumsum([0, *sizes]), strict=False):
            g = len(block.stencil)
            number = start + np.arange(g * block.n_rows).reshape(g, block.n_rows, 1)
            r, c = np.broadcast_arrays(number, block.stencil[:, None, :])
            rows.append(r)
            columns.append(c)
        self._jacobian = BlockPattern(rows, columns, n_vertices, (3,))
        self._jacobian_pointers = 3 * self._jacobian.pointers(self.n_rows)
        self._jacobian_columns = (3 * self._jacobian.columns[:, None] + np.arange(3)).ravel()

    def hessian(self, sources: Sequence[np.ndarray]) -> np.ndarray:
        """Add up vertex blocks in the order of the stencils, (pairs, 3, 3)."""
        return self.pattern.sum(sources)

    def normal(self, jacobians: Sequence[np.ndarray]) -> np.ndarray:
        """Add up J'J from the blocks' Jacobians (g, r, 3 p), (pairs, 3, 3)."""
        products = [vertex_blocks(np.swapaxes(j, 1, 2) @ j) for j in jacobians]
        return self.pattern.sum(products, self._n_stencils)

    def shifted(self, blocks: np.ndarray, shift: float) -> np.ndarray:
        """Return blocks with a multiple of the identity added to the matrix."""
        if shift == 0:
            return blocks
        result = blocks.copy()
        result[self._diagonal] += shift * np.eye(3)
        return result

    def matrix(self, blocks: np.ndarray) -> bsr_matrix:
        """Return blocks as a sparse matrix (3 n, 3 n)."""
        return bsr_matrix((blocks, self.pattern.columns, self._pointers), shape=(self.n_dofs, self.n_dofs))

    def jacobian(self, jacobians: Sequence[np.ndarray]) -> csr_matrix:
        """Return J (rows, 3 n)."""
        data = self._jacobian.sum(jacobians).ravel()
        shape = (self.n_rows, self.n_dofs)
        return csr_matrix((data, self._jacobian_columns, self._jacobian_pointers), shape=shape)
