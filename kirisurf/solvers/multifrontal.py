"""Cholesky factorization of sparse symmetric positive definite matrices of 3×3 blocks, on dense fronts."""

from __future__ import annotations

import weakref
from collections import deque
from functools import partial

import numpy as np

from kirisurf.solvers.blas import solve_triangle
from kirisurf.solvers.dense_front import elimination, tiles_in
from kirisurf.solvers.symbolic import Addition, Symbolic
from kirisurf.solvers.team import Team

__all__ = ["Cholesky", "Symbolic"]


class Cholesky:
    """A = L L' of a symmetric positive definite matrix.

    Subtrees of fronts that know nothing of each other are shared by the cores, and so are the pieces of the
    large fronts above them. With BLAS on one thread, as the solvers have it, the sums are the same, to the bit,
    whatever the number of cores.

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
        storage = symbolic.lend()
        give_back = weakref.finalize(self, symbolic.take_back, storage)
        give_back.atexit = False
        self._panels = symbolic.panels(storage)
        try:
            self._factor(blocks)
        except np.linalg.LinAlgError:
            give_back()  # not before the exception is forgotten, otherwise
            raise
        self.log_determinant = 2.0 * float(np.log(self._diagonal()).sum())

    def _diagonal(self) -> np.ndarray:
        return np.concatenate([panel.diagonal() for panel in self._panels])

    def _factor(self, blocks: np.ndarray) -> None:
        symbolic, lanes = self._symbolic, deque(self._symbolic.lanes)
        self._updates: list[list[np.ndarray]] = [[]] * symbolic.n_fronts

        def eliminate_subtree(first: int, last: int) -> None:
            lane = lanes.pop()
            try:
                with Team(1) as alone:
                    for i in range(first, last):
                        self._eliminate(i, blocks, lane, alone)
                    self._eliminate(last, blocks, symbolic.stack, alone)
            finally:
                lanes.append(lane)

        with Team(symbolic.n_workers) as team:
            team.run([partial(eliminate_subtree, *subtree) for subtree in symbolic.subtrees])
            for i in symbolic.top:
                self._eliminate(i, blocks, symbolic.stack, team)
        del self._updates
        if not np.isfinite(self._diagonal()).all():  # dpotrf takes a NaN for a pivot
            raise np.linalg.LinAlgError("the matrix is not positive definite: it holds numbers that are not finite")

    def _eliminate(self, i: int, blocks: np.ndarray, workspace: np.ndarray, team: Team) -> None:
        """Add up front i from the matrix and the updates of its children, and eliminate its pivots."""
        symbolic, panel = self._symbolic, self._panels[i]
        symbolic.fill(i, panel, blocks)
        offset = symbolic.update_offsets[i]
        tiles = tiles_in(workspace[offset:], symbolic.marks[i])
        sources = [(self._updates[child], child) for child in symbolic.children[i]]
        for source, child in sources:
            _add([panel], source, symbolic.panel_additions[child])
        for tasks in elimination(panel, tiles):
            team.run(tasks)
        # The children's part comes last: the update need not be cleared before.
        for source, child in sources:
            _add(tiles, source, symbolic.update_additions[child])
        self._updates[i] = tiles

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x with A x = right, for (3n,) and for (3n, k)."""
        if right.ndim == 2:
            columns = [self.solve(column) for column in right.T]
            return np.array(columns).reshape(right.T.shape).T
        symbolic = self._symbolic
        x = right[symbolic.order]
        with Team(symbolic.n_workers) as team:
            sums = [np.zeros(0)] * len(symbolic.subtrees)
            team.run([partial(self._forward_subtree, x, sums, j) for j in range(len(sums))])
            for (_, last), above in zip(symbolic.subtrees, sums, strict=True):
                x[symbolic.rows[last]] += above
            for i in symbolic.top:
                self._forward(x, i)
            for i in reversed(symbolic.top):
                self._backward(x, i)
            team.run([partial(self._backward_subtree, x, *subtree) for subtree in symbolic.subtrees])
        result = np.empty_like(x)
        result[symbolic.order] = x
        return result

    def _forward(self, x: np.ndarray, i: int) -> None:
        start, k, panel = self._symbolic.starts[i], self._symbolic.pivot_sizes[i], self._panels[i]
        part = x[start : start + k]
        solve_triangle(panel, part)
        if len(panel) > k:
            x[self._symbolic.rows[i]] -= panel[k:] @ part

    def _backward(self, x: np.ndarray, i: int) -> None:
        start, k, panel = self._symbolic.starts[i], self._symbolic.pivot_sizes[i], self._panels[i]
        part = x[start : start + k]
        if len(panel) > k:
            part -= x[self._symbolic.rows[i]] @ panel[k:]
        solve_triangle(panel, part, transposed=True)

    def _forward_subtree(self, x: np.ndarray, sums: list[np.ndarray], j: int) -> None:
        """Solve within a subtree, and give what it adds to the rows above it."""
        symbolic = self._symbolic
        first, last = symbolic.subtrees[j]
        inside = slice(symbolic.starts[first], symbolic.starts[last + 1])
        own = np.zeros(len(x))  # others write to the rows above at the same time
        own[inside] = x[inside]
        for i in range(first, last + 1):
            self._forward(own, i)
        x[inside] = own[inside]
        sums[j] = own[symbolic.rows[last]]

    def _backward_subtree(self, x: np.ndarray, first: int, last: int) -> None:
        for i in range(last, first - 1, -1):
            self._backward(x, i)


def _add(targets: list[np.ndarray], sources: list[np.ndarray], additions: list[Addition]) -> None:
    # numpy adds fastest where the last axis is contiguous
    targets, sources = [tile.T for tile in targets], [tile.T for tile in sources]
    # what overflows shows on the diagonal in the end
    with np.errstate(over="ignore", invalid="ignore"):
        for t, c0, c1, r0, r1, u, d0, d1, s0, s1 in additions:
            view = targets[t][c0:c1, r0:r1]
            np.add(view, sources[u][d0:d1, s0:s1], view)
