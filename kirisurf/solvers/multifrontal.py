"""Cholesky factorization of sparse symmetric positive definite matrices of 3×3 blocks, on dense fronts."""

from __future__ import annotations

import numpy as np
from scipy.linalg.blas import dgemm, dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf

from kirisurf.solvers.elimination_tree import find_fronts

_WIDTH = 3  # unknowns of a vertex
_STRIP = 48  # columns that dtrsm takes at a time

# One addition of a child's update: columns and rows of the target, columns and rows of the source, as (begin, end).
_Addition = tuple[int, int, int, int, int, int, int, int]


class Symbolic:
    """What the pattern alone decides: order, fronts, and where every number goes. Made once per pattern.

    It lends its workspace to the factorizations, one at a time: not for threads that factor at once.

    Parameters
    ----------
    n : int
        Number of vertices; the matrix is (3n, 3n), and vertex v has the unknowns 3v, 3v + 1, 3v + 2.
    rows, columns : (nb,) int
        Vertex pair of every block, each pair once, both halves of the symmetric pattern.

    Attributes
    ----------
    n_fronts : int
    n_nonzeros : int
        Entries of the lower factor, with the zeros that the fronts store.
    n_flops : float
        Multiplications and additions of a factorization.
    factor_bytes : int
        What a `Cholesky` holds.
    stack_bytes : int
        Most that the update matrices take at a time during a factorization.
    """

    def __init__(self, n: int, rows: np.ndarray, columns: np.ndarray) -> None:
        rows, columns = np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64)
        fronts = find_fronts(n, rows, columns)
        self.n, self.n_blocks = n, len(rows)
        self.order = (_WIDTH * fronts.order[:, None] + np.arange(_WIDTH)).ravel()
        self.starts = (_WIDTH * fronts.starts).tolist()
        self.rows = [(_WIDTH * r[:, None] + np.arange(_WIDTH)).ravel() for r in fronts.rows]
        self.n_fronts = len(self.rows)
        self.pivot_sizes: list[int] = np.diff(self.starts).tolist()
        self.row_sizes = [len(r) for r in self.rows]
        k, m = np.asarray(self.pivot_sizes, dtype=np.int64), np.asarray(self.row_sizes, dtype=np.int64)
        self.offsets: list[int] = np.concatenate([[0], np.cumsum(k * (k + m))]).tolist()
        self.children: list[list[int]] = [[] for _ in range(self.n_fronts)]
        self.additions: list[tuple[list[_Addition], list[_Addition], list[_Addition]]] = []
        for i, parent in enumerate(fronts.parents.tolist()):
            self.additions.append(([], [], []))
            if parent >= 0:
                self.children[parent].append(i)
                first, last = fronts.starts[parent : parent + 2].tolist()
                self.additions[i] = _additions(fronts.rows[i], first, last, fronts.rows[parent])
        self._place_entries(fronts.order, fronts.starts, fronts.rows, rows, columns)
        self.n_nonzeros = int((k * (k + 1) // 2 + k * m).sum())
        self.n_flops = float((k**3 / 3.0 + k * k * m + k * m * m).sum())
        self.factor_bytes = 8 * self.offsets[-1]
        self.update_offsets = _first_fit([size**2 for size in self.row_sizes], self.children)
        ends = [offset + size**2 for offset, size in zip(self.update_offsets, self.row_sizes, strict=True)]
        # Kept from one factorization to the next: fresh memory would be cleared by the system page by page.
        self.workspace = np.empty(max(ends, default=0))
        self.stack_bytes = self.workspace.nbytes

    def _place_entries(
        self, order: np.ndarray, starts: np.ndarray, below: list[np.ndarray], rows: np.ndarray, columns: np.ndarray
    ) -> None:
        """Find the place in the factor's storage of every entry of the lower half of the permuted matrix."""
        position = np.argsort(order)
        row, column = position[rows], position[columns]
        front = np.searchsorted(starts, column, side="right") - 1
        inside = row < starts[front + 1]
        self._chosen = np.flatnonzero(row >= column)
        row, column, front, inside = (a[self._chosen] for a in (row, column, front, inside))
        # One sorted key over all fronts finds the place of a row in the list of its front.
        n = len(order)
        lengths = np.array([len(r) for r in below])
        keys = np.concatenate([i * n + r for i, r in enumerate(below)] or [np.zeros(0, dtype=np.int64)])
        place = np.searchsorted(keys, front * n + row) - (np.cumsum(lengths) - lengths)[front]
        k, m = np.asarray(self.pivot_sizes)[front], np.asarray(self.row_sizes)[front]
        first = np.asarray(self.offsets)[front]
        local = _WIDTH * (column - starts[front])
        height = np.where(inside, k, m)
        start = first + np.where(inside, _WIDTH * (row - starts[front]), k * k + _WIDTH * place) + local * height
        # (row, column) of a block at [..., row, column], as the data of the blocks has it.
        step = np.arange(_WIDTH)
        self._targets = (start[:, None, None] + step[:, None] + step * height[:, None, None]).ravel()

        front = np.repeat(np.arange(self.n_fronts), self.pivot_sizes)
        local = np.arange(_WIDTH * n) - np.asarray(self.starts)[front]
        self.diagonal = np.asarray(self.offsets)[front] + local * (np.asarray(self.pivot_sizes)[front] + 1)

    def scatter(self, blocks: np.ndarray) -> np.ndarray:
        """Return storage of the factor that holds the matrix of the blocks (nb, 3, 3)."""
        storage = np.zeros(self.offsets[-1])
        storage[self._targets] = blocks[self._chosen].ravel()
        return storage


def _first_fit(sizes: list[int], children: list[list[int]]) -> list[int]:
    """Return an offset for each update matrix, such that those that live at the same time are apart."""
    offsets: list[int] = []
    live: list[tuple[int, int, int]] = []  # sorted (start, end, front)
    for i, size in enumerate(sizes):
        start = 0
        for begin, end, _ in live:
            if begin - start >= size:
                break
            start = max(start, end)
        offsets.append(start)
        live = sorted([entry for entry in live if entry[2] not in children[i]] + [(start, start + size, i)])
    return offsets


def _additions(
    rows: np.ndarray, first: int, last: int, above: np.ndarray
) -> tuple[list[_Addition], list[_Addition], list[_Addition]]:
    """Split the lower half of an update into rectangles that are contiguous in the front above.

    Returns
    -------
    tuple of list
        Additions into the pivot block, the block below it, and the update matrix of the front above.
    """
    n_inside = int(np.searchsorted(rows, last))
    place = np.concatenate([rows[:n_inside] - first, np.searchsorted(above, rows[n_inside:])])
    breaks = np.diff(place, prepend=-2) != 1
    if n_inside < len(rows):
        breaks[n_inside] = True
    begins = np.flatnonzero(breaks)
    ends = np.append(begins[1:], len(rows))
    runs = [
        (_WIDTH * int(place[b]), _WIDTH * int(place[b] + e - b), _WIDTH * int(b), _WIDTH * int(e))
        for b, e in zip(begins, ends, strict=True)
    ]
    pivot: list[_Addition] = []
    lower: list[_Addition] = []
    update: list[_Addition] = []
    for j, (c0, c1, d0, d1) in enumerate(runs):
        for r0, r1, s0, s1 in runs[j:]:
            target = pivot if s0 < _WIDTH * n_inside else lower if d0 < _WIDTH * n_inside else update
            target.append((c0, c1, r0, r1, d0, d1, s0, s1))
    return pivot, lower, update


def _divide(pivot: np.ndarray, lower: np.ndarray) -> None:
    """Replace lower (m, k) by lower times the transposed inverse of the triangle pivot (k, k).

    In strips, because dtrsm reaches half the rate of dgemm on matrices of these sizes.
    """
    k = len(pivot)
    if k < 2 * _STRIP:
        dtrsm(1.0, pivot, lower, side=1, lower=1, trans_a=1, overwrite_b=1)
        return
    for start in range(0, k, _STRIP):
        end = min(k, start + _STRIP)
        strip = lower[:, start:end]
        if start:
            dgemm(-1.0, lower[:, :start], pivot[start:end, :start], beta=1.0, c=strip, trans_b=1, overwrite_c=1)
        dtrsm(1.0, pivot[start:end, start:end], strip, side=1, lower=1, trans_a=1, overwrite_b=1)


class Cholesky:
    """A = L L' of a symmetric positive definite matrix.

    Parameters
    ----------
    symbolic : Symbolic
    blocks : (nb, 3, 3) float
        A[3r + i, 3c + j] is blocks[b, i, j] where block b is the pair (r, c) of the pattern.

    Attributes
    ----------
    log_determinant : float
        Logarithm of the determinant of A.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the matrix is not positive definite.
    """

    def __init__(self, symbolic: Symbolic, blocks: np.ndarray) -> None:
        self._symbolic = symbolic
        storage = symbolic.scatter(blocks)
        self._pivots: list[np.ndarray] = []
        self._lowers: list[np.ndarray] = []
        workspace = symbolic.workspace
        updates: dict[int, np.ndarray] = {}
        for i in range(symbolic.n_fronts):
            k, m, offset = symbolic.pivot_sizes[i], symbolic.row_sizes[i], symbolic.offsets[i]
            # Transposed views: their last axis is contiguous, as the columns of LAPACK's matrices are.
            pivot = storage[offset : offset + k * k].reshape(k, k)
            lower = storage[offset + k * k : offset + k * (k + m)].reshape(k, m)
            offset = symbolic.update_offsets[i]
            update = workspace[offset : offset + m * m].reshape(m, m)
            update.fill(0.0)
            for child in symbolic.children[i]:
                source = updates.pop(child)
                for target, additions in zip((pivot, lower, update), symbolic.additions[child], strict=True):
                    for c0, c1, r0, r1, d0, d1, s0, s1 in additions:
                        view = target[c0:c1, r0:r1]
                        np.add(view, source[d0:d1, s0:s1], view)
            _, info = dpotrf(pivot.T, lower=1, clean=0, overwrite_a=1)
            if info:
                raise np.linalg.LinAlgError("the matrix is not positive definite")
            if m:
                _divide(pivot.T, lower.T)
                dsyrk(-1.0, lower.T, beta=1.0, c=update.T, lower=1, overwrite_c=1)
                updates[i] = update
            self._pivots.append(pivot.T)
            self._lowers.append(lower.T)
        diagonal = storage[symbolic.diagonal]
        if not np.isfinite(diagonal).all():  # dpotrf takes a NaN for a pivot
            raise np.linalg.LinAlgError("the matrix is not positive definite: it holds numbers that are not finite")
        self.log_determinant = 2.0 * float(np.log(diagonal).sum())

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x with A x = right, for (3n,) and for (3n, k)."""
        symbolic = self._symbolic
        x = right.reshape(len(right), -1)[symbolic.order]
        fronts = list(
            zip(symbolic.starts, symbolic.starts[1:], symbolic.rows, self._pivots, self._lowers, strict=False)
        )
        for start, end, rows, pivot, lower in fronts:
            x[start:end] = dtrsm(1.0, pivot, x[start:end], lower=1)
            if len(rows):
                x[rows] -= dgemm(1.0, lower, x[start:end])
        for start, end, rows, pivot, lower in reversed(fronts):
            part = x[start:end]
            if len(rows):
                part = part - dgemm(1.0, lower, x[rows], trans_a=1)
            x[start:end] = dtrsm(1.0, pivot, part, lower=1, trans_a=1)
        result = np.empty_like(x)
        result[symbolic.order] = x
        return result.reshape(right.shape)
