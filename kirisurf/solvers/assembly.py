"""Assembly of the KKT matrix on a sparsity pattern that is found once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix

from kirisurf.block import Block


class BlockPattern:
    """Sums dense blocks of vertex groups into unique (row node, vertex) pairs.

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

    def sum(self, sources: Sequence[np.ndarray]) -> np.ndarray:
        """Add up the sources' blocks, (unique pairs, *shape)."""
        n = len(self.rows) * self._size
        total = np.zeros(n)
        for target, values in zip(self._targets, sources, strict=True):
            total += np.bincount(target, values.ravel(), n)
        return total.reshape(-1, *self._shape)


def vertex_blocks(values: np.ndarray) -> np.ndarray:
    """Reshape second derivatives (c, 3q, 3q) to vertex pairs (c, q, q, 3, 3)."""
    c, q = len(values), values.shape[1] // 3
    return values.reshape(c, q, 3, q, 3).transpose(0, 1, 3, 2, 4)


class Assembly:
    """The matrix [[H, J'], [J, -D]] of a set of blocks.

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
        first = np.cumsum([0, *sizes])
        pairs = [np.broadcast_arrays(s[:, :, None], s[:, None, :]) for s in stencils]
        diagonal = np.arange(n_vertices)
        self.hessian = BlockPattern(
            [p[0] for p in pairs] + [diagonal], [p[1] for p in pairs] + [diagonal], n_vertices, (3, 3)
        )
        rows, columns = [], []
        for block, start in zip(equalities, first, strict=False):
            g = len(block.stencil)
            number = start + np.arange(g * block.n_rows).reshape(g, block.n_rows, 1)
            r, c = np.broadcast_arrays(number, block.stencil[:, None, :])
            rows.append(r)
            columns.append(c)
        self.jacobian_pattern = BlockPattern(rows, columns, n_vertices, (3,))
        self._build()

    def _build(self) -> None:
        k3 = np.arange(3)
        h, j = self.hessian, self.jacobian_pattern
        hr = np.broadcast_to((3 * h.rows)[:, None, None] + k3[:, None], (len(h.rows), 3, 3)).ravel()
        hc = np.broadcast_to((3 * h.columns)[:, None, None] + k3, (len(h.rows), 3, 3)).ravel()
        jr = np.repeat(j.rows, 3)
        jc = (3 * j.columns[:, None] + k3).ravel()
        size = self.n_dofs + self.n_rows
        diagonal = np.arange(size)
        self.rows = np.concatenate([hr, jr + self.n_dofs, jc, diagonal])
        self.columns = np.concatenate([hc, jc, jr + self.n_dofs, diagonal])
        self._gather, self._indices, self._indptr = _compressed(self.rows, self.columns, size)
        self._jgather, self._jindices, self._jindptr = _compressed(jc, jr, self.n_rows)

    def node_graph(self) -> tuple[np.ndarray, np.ndarray, int]:
        """Return the adjacency of vertices and rows (as nodes after the vertices): rows, columns, count."""
        h, j = self.hessian, self.jacobian_pattern
        rows = np.concatenate([h.rows, j.rows + self.n, j.columns])
        columns = np.concatenate([h.columns, j.columns, j.rows + self.n])
        return rows, columns, self.n + self.n_rows

    def matrix(self, hessian: np.ndarray, jacobian: np.ndarray, shift: float, regularization: float) -> csc_matrix:
        """Return [[H + shift I, J'], [J, -regularization I]] (k, k) in CSC form."""
        j = jacobian.ravel()
        diagonal = np.r_[np.full(self.n_dofs, shift), np.full(self.n_rows, -regularization)]
        values = np.concatenate([hessian.ravel(), j, j, diagonal])
        size = self.n_dofs + self.n_rows
        data = np.bincount(self._gather, values, len(self._indices))
        return csc_matrix((data, self._indices, self._indptr), shape=(size, size))

    def jacobian_matrix(self, jacobian: np.ndarray) -> csr_matrix:
        """Return J (rows, 3 n) in CSR form."""
        data = np.bincount(self._jgather, jacobian.ravel(), len(self._jindices))
        return csr_matrix((data, self._jindices, self._jindptr), shape=(self.n_rows, self.n_dofs))


def _compressed(rows: np.ndarray, columns: np.ndarray, n_columns: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place of every entry in a compressed-by-column form, its row indices and column pointers."""
    height = int(rows.max()) + 1 if len(rows) else 1
    unique, inverse = np.unique(columns * height + rows, return_inverse=True)
    pointers = np.searchsorted(unique, np.arange(n_columns + 1) * height)
    return inverse.ravel(), (unique % height).astype(np.int32), pointers.astype(np.int32)


def node_coo(rows: np.ndarray, columns: np.ndarray, size: int) -> csr_matrix:
    """Return the pattern of a node graph without its diagonal, (size, size)."""
    keep = rows != columns
    graph = coo_matrix((np.ones(keep.sum()), (rows[keep], columns[keep])), shape=(size, size)).tocsr()
    graph.sum_duplicates()
    return graph
