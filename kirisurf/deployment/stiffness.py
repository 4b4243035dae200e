"""The sparse matrix of an energy: where the number of every element goes is found once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import csc_matrix, csr_matrix


class Gathering:
    """Vectors of elements from points, and forces on points from those of elements: a matrix of ones and its transpose.

    Parameters
    ----------
    n : int
        Number of vertices.
    stencils : sequence of (k, p + 1)
        Vertices of elements, the origin first.
    """

    def __init__(self, n: int, stencils: Sequence[Int[np.ndarray, "_ _"]]) -> None:
        ends = [stencil[:, 1:].T.ravel() for stencil in stencils]
        origins = [np.tile(stencil[:, 0], stencil.shape[1] - 1) for stencil in stencils]
        self._shapes = [(stencil.shape[1] - 1, len(stencil)) for stencil in stencils]
        self._ends, self._origins = np.concatenate(ends), np.concatenate(origins)
        rows = np.tile(np.arange(len(self._ends)), 2)
        signs = np.repeat([1.0, -1.0], len(self._ends))
        place = rows, np.concatenate([self._ends, self._origins])
        self._back = csr_matrix((signs, place), shape=(len(self._ends), n)).T.tocsr()

    def vectors(self, points: Float[np.ndarray, "n d"]) -> list[Float[np.ndarray, "_ _ _"]]:
        """Return the vectors of every kind of elements."""
        columns = np.ascontiguousarray(points.T)
        every = columns.take(self._ends, axis=1) - columns.take(self._origins, axis=1)
        result, start = [], 0
        for p, k in self._shapes:
            part = every[:, start : start + p * k].reshape(len(every), p, k)
            result.append(np.ascontiguousarray(part.transpose(1, 0, 2)))
            start += p * k
        return result

    def forces(self, parts: Sequence[Float[np.ndarray, "_ _ _"]]) -> Float[np.ndarray, "n d"]:
        """Add up derivatives by the vectors to those by the points."""
        every = [part.transpose(1, 0, 2).reshape(part.shape[1], -1) for part in parts]
        return np.asarray(self._back @ np.concatenate(every, axis=1).T)


class Stiffness:
    """Second derivatives by the free coordinates: the upper half of a symmetric matrix on one sparsity pattern.

    Parameters
    ----------
    stencils : sequence of (k, p + 1)
    numbers : (n, d) int
        Row and column of every coordinate, -1 where it is held.
    """

    def __init__(self, stencils: Sequence[Int[np.ndarray, "_ _"]], numbers: Int[np.ndarray, "n d"]) -> None:
        d, size = numbers.shape[1], int(numbers.max(initial=-1)) + 1
        rows, columns, sources, signs = [], [], [], []
        start = 0
        for stencil in stencils:
            k, p = len(stencil), stencil.shape[1] - 1
            for i in range(p):
                for j in range(i, p):
                    source = start + np.arange(d * d * k).reshape(d, d, k)
                    start += source.size
                    # a vector adds to its end and takes from its origin; a mixed pair stands for its transpose too
                    for a, b, sign in ((i + 1, j + 1, 1), (i + 1, 0, -1), (0, j + 1, -1), (0, 0, 1)):
                        for turned in (False, True) if i != j else (False,):
                            one, two = numbers[stencil[:, a]].T, numbers[stencil[:, b]].T
                            row, column = np.broadcast_arrays(one[:, None], two[None])
                            if turned:
                                row, column = column, row
                            keep = (row >= 0) & (row <= column)
                            rows.append(row[keep])
                            columns.append(column[keep])
                            sources.append(source[keep])
                            signs.append(np.full(int(keep.sum()), float(sign)))
        diagonal = np.arange(size)
        place = np.concatenate([diagonal, *rows]), np.concatenate([diagonal, *columns])
        pattern = csc_matrix((np.ones(len(place[0]), np.int8), place), shape=(size, size))
        pattern.sum_duplicates()
        pattern.sort_indices()
        order = csc_matrix((np.arange(1, pattern.nnz + 1), pattern.indices, pattern.indptr), shape=pattern.shape)
        found = np.asarray(order[place]).ravel() - 1
        self.size, self.diagonal = size, found[:size]
        self._indices, self._pointers = pattern.indices, pattern.indptr
        added = csr_matrix(
            (np.concatenate([np.zeros(0), *signs]), (found[size:], np.concatenate([np.zeros(0, np.int64), *sources]))),
            shape=(pattern.nnz, start),
        )
        self._added = added

    def numbers(self, parts: Sequence[dict[tuple[int, int], np.ndarray]]) -> Float[np.ndarray, " z"]:
        """Add up second derivatives of elements to the entries of the matrix."""
        return self._added @ np.concatenate([part[pair].ravel() for part in parts for pair in sorted(part)])

    def matrix(self, entries: Float[np.ndarray, " z"], shift: float = 0.0) -> csc_matrix:
        """Return the upper half of the matrix, diagonal included, with a multiple of the identity added."""
        if shift:
            entries = entries.copy()
            entries[self.diagonal] += shift
        return csc_matrix((entries, self._indices, self._pointers), shape=(self.size, self.size), copy=False)
