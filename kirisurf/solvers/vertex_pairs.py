"""Sums of dense blocks over groups of vertices into a symmetric sparse matrix of 3x3 blocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix

Stencil = np.ndarray | tuple[np.ndarray, np.ndarray]
"""Vertices (k, q) of symmetric blocks; or rows (k, p) and columns (k, q) of blocks that stand for B and B'."""

_STEP = np.arange(3)
_PLACES = np.arange(9).reshape(3, 3)  # of the entries of a block


class VertexPairs:
    """The pairs of vertices that occur together in a stencil, and every vertex with itself.

    Attributes
    ----------
    rows, columns : (pairs,) int
        Both halves of the symmetric pattern, ordered by row and column.
    pointers : (n + 1,) int
        Start of every row.
    n_half : int
        Number of pairs of which the row is not greater than the column.
    expansion : (pairs, 3, 3) int
        Where the entries of every block stand in the blocks (n_half, 3, 3) of the upper half.
    """

    def __init__(self, n: int, stencils: Sequence[Stencil]) -> None:
        every = [np.arange(n)], [np.arange(n)]
        for stencil in _distinct(stencils)[0]:
            first, second, _, _ = _slots(stencil)
            every[0].append(np.minimum(first, second).ravel())
            every[1].append(np.maximum(first, second).ravel())
        row, column = (np.concatenate(part) for part in every)
        # building a sparse matrix sorts by counting, many times faster than a sort of keys
        half = csr_matrix((np.ones(len(row), np.int8), (row, column)), shape=(n, n))
        half.sum_duplicates()
        self.n_half = half.nnz
        number = np.arange(self.n_half)
        self._numbers = csr_matrix((number, half.indices, half.indptr), shape=(n, n))
        row, column = np.repeat(np.arange(n), np.diff(half.indptr)), half.indices
        off = row != column
        # odd where the block is the transpose of the stored one; the lower half first, so that rows come out sorted
        data = np.concatenate([2 * number[off] + 1, 2 * number])
        rows, columns = np.concatenate([column[off], row]), np.concatenate([row[off], column])
        full = csr_matrix((data, (rows, columns)), shape=(n, n))
        self.pointers = full.indptr
        self.rows, self.columns = np.repeat(np.arange(n), np.diff(full.indptr)), full.indices.astype(np.int64)
        places = np.stack([_PLACES, _PLACES.T])[full.data % 2]
        self.expansion = 9 * (full.data // 2)[:, None, None] + places

    def find(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return the numbers of pairs with rows not greater than columns in the upper half."""
        if not rows.size:
            return np.zeros(rows.shape, np.int64)
        return np.asarray(self._numbers[rows.ravel(), columns.ravel()]).reshape(rows.shape)


class BlockSum:
    """Adds up dense blocks (k, 3 p, 3 q) of several sources.

    Of symmetric blocks only one triangle is read. It lends its workspace to the sums, one at a time: not for
    threads that sum at once.

    Parameters
    ----------
    pairs : VertexPairs
        Of these stencils, at least.
    stencils : sequence of Stencil
        One for every source.
    """

    def __init__(self, pairs: VertexPairs, stencils: Sequence[Stencil]) -> None:
        self._expansion = pairs.expansion
        distinct, self._owners = _distinct(stencils)
        shapes = [_shape(stencil) for stencil in distinct]
        ends = np.cumsum([0, *(int(np.prod(shape)) for shape in shapes)])
        self._workspace = np.zeros(ends[-1])
        self._parts = [self._workspace[s:e].reshape(v) for s, e, v in zip(ends, ends[1:], shapes, strict=False)]
        found = [_targets(pairs, stencil) for stencil in distinct]
        indices = np.concatenate([np.zeros(0, np.int32), *(target.ravel() for target, _, _ in found)])
        pointers, n_read = np.zeros(len(self._workspace) + 1, np.int32), 0
        for (target, read, _), start, end in zip(found, ends, ends[1:], strict=False):
            steps = np.int32(n_read) + np.int32(target.shape[1]) * np.arange(len(target), dtype=np.int32)
            np.add(steps[:, None], read, out=pointers[start + 1 : end + 1].reshape(len(target), len(read)))
            n_read += target.size
        size = 9 * pairs.n_half, len(self._workspace)
        selected = csc_matrix((np.ones(n_read), indices, pointers), shape=size)
        doubled = [np.add(double, [[start], [0]]) for (_, _, double), start in zip(found, ends, strict=False)]
        source, goal = np.concatenate([np.zeros((2, 0), np.int64), *doubled], axis=1)
        if len(source):
            selected = selected + csc_matrix((np.ones(len(source)), (goal, source)), shape=size)
        self._selection = selected

    def sum(self, sources: Iterable[np.ndarray | None]) -> np.ndarray:
        """Add up the blocks of all sources, None for zeros, to the pairs' (pairs, 3, 3).

        An iterator that makes one source after the other works in the same small piece of memory for all of
        them. Held together they are large enough that the system takes their memory back after every sum, and
        clears it page by page for the next one.
        """
        filled: set[int] = set()
        for owner, source in zip(self._owners, sources, strict=True):
            if source is None:
                continue
            if owner in filled:
                self._parts[owner] += source
            else:
                self._parts[owner][...] = source
                filled.add(owner)
        for owner, part in enumerate(self._parts):
            if owner not in filled:
                part[...] = 0.0
        return (self._selection @ self._workspace).take(self._expansion)


def _distinct(stencils: Sequence[Stencil]) -> tuple[list[Stencil], list[int]]:
    """Find the stencils that differ, and for each the number of its equal among them."""
    found: list[Stencil] = []
    owners = []
    for stencil in stencils:
        same = (i for i, other in enumerate(found) if _are_equal(stencil, other))
        owners.append(next(same, len(found)))
        if owners[-1] == len(found):
            found.append(stencil)
    return found, owners


def _are_equal(first: Stencil, second: Stencil) -> bool:
    if isinstance(first, tuple) != isinstance(second, tuple):
        return False
    return all(np.array_equal(a, b) for a, b in zip(_sides(first), _sides(second), strict=True))


def _sides(stencil: Stencil) -> tuple[np.ndarray, np.ndarray]:
    return stencil if isinstance(stencil, tuple) else (stencil, stencil)


def _shape(stencil: Stencil) -> tuple[int, int, int]:
    rows, columns = _sides(stencil)
    return len(rows), 3 * rows.shape[1], 3 * columns.shape[1]


def _slots(stencil: Stencil) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the vertices (k, s) of rows and columns of the blocks that are read, and their places (s,) in a group."""
    rows, columns = _sides(stencil)
    if isinstance(stencil, tuple):
        a, b = (part.ravel() for part in np.indices((rows.shape[1], columns.shape[1])))
    else:
        a, b = np.triu_indices(rows.shape[1])
    return rows[:, a], columns[:, b], a, b


def _targets(pairs: VertexPairs, stencil: Stencil) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Find where the entries of a source go in the upper half.

    Returns
    -------
    (k, e) int32
        Targets of the e entries of a group that are read.
    (9 p q,) int32
        How many entries of a group are read up to each one, and with it.
    (2, d) int
        Entries that have a second target, and that.
    """
    first, second, a, b = _slots(stencil)
    _, height, width = _shape(stencil)
    number = 9 * pairs.find(np.minimum(first, second), np.maximum(first, second)).astype(np.int32)
    entries = (3 * a[:, None, None] + _STEP[:, None]) * width + 3 * b[:, None, None] + _STEP
    order = np.argsort(entries.ravel())
    slot, place = np.divmod(order, 9)
    own, other = _PLACES.ravel().astype(np.int32), _PLACES.T.ravel().astype(np.int32)
    target = number[:, slot] + np.where((first > second)[:, slot], other[place], own[place])
    is_read = np.zeros(height * width, bool)
    is_read[entries] = True
    # a block off the diagonal of its source, but of one vertex with itself: its transpose belongs there too
    double = first == second
    if not isinstance(stencil, tuple):
        double &= a != b
    group, slot = np.nonzero(double)
    source = group[:, None, None] * (height * width) + entries[slot]
    return (
        target,
        np.cumsum(is_read, dtype=np.int32),
        np.stack([source.ravel(), (number[group, slot][:, None] + other).ravel()]),
    )
