"""Sums of dense blocks over groups of vertices into a symmetric sparse matrix of 3x3 blocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np
from scipy.sparse import csr_matrix

Stencil = np.ndarray | tuple[np.ndarray, np.ndarray]
"""Vertices (k, q) of symmetric blocks; or rows (k, p) and columns (k, q) of blocks that stand for B and B'."""


class VertexPairs:
    """The pairs of vertices that occur together in a stencil, and every vertex with itself.

    Attributes
    ----------
    n : int
        Number of vertices.
    rows, columns : (pairs,) int32
        Upper half of the symmetric pattern, rows not greater than columns; ordered by row and column.
    pointers : (n + 1,) int32
        Start of every row.
    """

    def __init__(self, n: int, stencils: Sequence[Stencil]) -> None:
        self.n = n
        every = [np.arange(n, dtype=np.int32)], [np.arange(n, dtype=np.int32)]
        for stencil in _distinct(stencils)[0]:
            first, second = _vertices(stencil)
            every[0].append(np.minimum(first, second).ravel())
            every[1].append(np.maximum(first, second).ravel())
        row, column = (np.concatenate(part) for part in every)
        # building a sparse matrix sorts by counting, many times faster than a sort of keys
        half = csr_matrix((np.ones(len(row), np.int8), (row, column)), shape=(n, n))
        half.sum_duplicates()
        self.pointers, self.columns = half.indptr, half.indices
        self.rows = np.repeat(np.arange(n, dtype=np.int32), np.diff(half.indptr))

    def __len__(self) -> int:
        return len(self.columns)

    @cached_property
    def numbers(self) -> csr_matrix:
        """Number of each pair at its place, (n, n)."""
        return csr_matrix((np.arange(len(self), dtype=np.int32), self.columns, self.pointers), shape=(self.n, self.n))

    @cached_property
    def both(self) -> csr_matrix:
        """Both halves, (n, n): twice the number of each pair, and one more where it stands for its transpose."""
        off = np.flatnonzero(self.rows != self.columns).astype(np.int32)
        number = 2 * np.arange(len(self), dtype=np.int32)
        # the lower half first, so that rows come out sorted
        rows = np.concatenate([self.columns[off], self.rows])
        columns = np.concatenate([self.rows[off], self.columns])
        return csr_matrix((np.concatenate([2 * off + 1, number]), (rows, columns)), shape=(self.n, self.n))

    def find(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return the numbers of pairs with rows not greater than columns."""
        if not rows.size:
            return np.zeros(rows.shape, np.int32)
        return np.asarray(self.numbers[rows.ravel(), columns.ravel()]).reshape(rows.shape)


@dataclass(frozen=True, eq=False)
class _Batch:
    """Successive sources that are added up together.

    Attributes
    ----------
    owners : list of int
        For each source the number of its stencil among those that differ.
    starts : dict
        Where the blocks of each of these stencils begin in the workspace.
    selection : (pairs, blocks) sparse
        Ones where a block of the workspace belongs to a pair.
    """

    owners: list[int]
    starts: dict[int, int]
    selection: csr_matrix


class BlockSum:
    """Adds up dense blocks (k, 3 p, 3 q) of several sources.

    Symmetric blocks have to be whole: which of their triangles is read depends on the numbers of the vertices.

    Sums are products with a matrix of ones, one number for a 3x3 block. A batch of sources is laid out for that
    in three planes, the first, second and third rows of all 3x3 blocks: the same matrix serves each of them.

    Parameters
    ----------
    pairs : VertexPairs
        Of these stencils, at least.
    stencils : sequence of Stencil
        One for every source.
    """

    def __init__(self, pairs: VertexPairs, stencils: Sequence[Stencil]) -> None:
        self._n_pairs = len(pairs)
        self._stencils, owners = _distinct(stencils)
        sizes = [_n_blocks(stencil) for stencil in self._stencils]
        # as much as the largest source: all of them at once take several times the memory of the sum
        self._most = max(sizes, default=0)
        self._batches: list[_Batch] = []
        for numbers in _batched(owners, sizes, self._most):
            starts, end = {}, 0
            for i in dict.fromkeys(numbers):
                starts[i], end = end, end + sizes[i]
            found = np.concatenate([_targets(pairs, self._stencils[i]) for i in starts])
            source = np.flatnonzero(found >= 0).astype(np.int32)
            marks = np.ones(len(source), np.int8), (found[source], source)
            self._batches.append(_Batch(numbers, starts, csr_matrix(marks, shape=(len(pairs), end))))
        ones = np.ones(max((batch.selection.nnz for batch in self._batches), default=0))
        for batch in self._batches:
            batch.selection.data = ones[: batch.selection.nnz]

    def sum(self, sources: Iterable[np.ndarray | None]) -> np.ndarray:
        """Add up the blocks of all sources, None for zeros, to the pairs' (pairs, 3, 3).

        An iterator that makes one source after the other needs the memory of one of them.
        """
        workspace = np.empty((3, self._most, 3))
        rows = [np.zeros((self._n_pairs, 3)) for _ in range(3)]
        remaining = iter(sources)
        for batch in self._batches:
            filled: set[int] = set()
            for owner, source in zip(batch.owners, islice(remaining, len(batch.owners)), strict=True):
                if source is not None:
                    self._lay_out(workspace, batch.starts[owner], source, owner, owner in filled)
                    filled.add(owner)
            if not filled:
                continue
            for owner, start in batch.starts.items():
                if owner not in filled:
                    workspace[:, start : start + _n_blocks(self._stencils[owner])] = 0.0
            for row, plane in zip(rows, workspace, strict=True):
                row += batch.selection @ plane[: batch.selection.shape[1]]
        return np.stack(rows, axis=1)

    def _lay_out(self, workspace: np.ndarray, start: int, source: np.ndarray, owner: int, more: bool) -> None:
        """Write a source into its place of the workspace (3, blocks, 3), or add it there."""
        both = (source, np.swapaxes(source, 1, 2))
        for (rows, columns), part in zip(_oriented(self._stencils[owner]), both, strict=False):
            (k, p), q = rows.shape, columns.shape[1]
            place = workspace[:, start : start + k * p * q].reshape(3, k, p, 3 * q)
            planes = part.reshape(k, p, 3, 3 * q).transpose(2, 0, 1, 3)
            if more:
                place += planes
            else:
                place[...] = planes
            start += k * p * q


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
    pairs = zip(_oriented(first)[0], _oriented(second)[0], strict=True)
    return all(np.array_equal(a, b) for a, b in pairs)


def _batched(owners: Sequence[int], sizes: Sequence[int], most: int) -> list[list[int]]:
    """Cut a list into pieces of which the different members are not larger together than the most."""
    pieces: list[list[int]] = []
    for owner in owners:
        if pieces and sum(sizes[i] for i in {*pieces[-1], owner}) <= most:
            pieces[-1].append(owner)
        else:
            pieces.append([owner])
    return pieces


def _oriented(stencil: Stencil) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return rows (k, p) and columns (k, q) of a source, and of its transpose where it stands for that too."""
    if isinstance(stencil, tuple):
        return [stencil, stencil[::-1]]
    return [(stencil, stencil)]


def _n_blocks(stencil: Stencil) -> int:
    return sum(rows.size * columns.shape[1] for rows, columns in _oriented(stencil))


def _vertices(stencil: Stencil) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices (k, s) of every 3x3 block of a source, of symmetric ones of the upper half."""
    rows, columns = _oriented(stencil)[0]
    if isinstance(stencil, tuple):
        a, b = (part.ravel() for part in np.indices((rows.shape[1], columns.shape[1])))
    else:
        a, b = np.triu_indices(rows.shape[1])
    return rows[:, a].astype(np.int32), columns[:, b].astype(np.int32)


def _targets(pairs: VertexPairs, stencil: Stencil) -> np.ndarray:
    """Find the pair of every 3x3 block of a source and of its transpose; -1 in the lower half, (blocks,) int32."""
    found = [np.zeros(0, np.int32)]
    for rows, columns in _oriented(stencil):
        row, column = (part.ravel() for part in np.broadcast_arrays(rows[:, :, None], columns[:, None, :]))
        target = np.full(row.size, -1, np.int32)
        # off the diagonal of a source a vertex with itself: its transpose lies there too, and is read as well
        upper = np.flatnonzero(row <= column)
        target[upper] = pairs.find(row[upper], column[upper])
        found.append(target)
    return np.concatenate(found)
