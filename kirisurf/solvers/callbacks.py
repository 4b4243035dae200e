"""A Problem as the flat functions that general sparse solvers call: values, gradient, Jacobian, Hessian.

    minimize f(x)  subject to  lower <= c(x) <= upper,    c: the equalities, then the inequalities

The patterns of the Jacobian and of the lower triangle of the Hessian are found once; every function fills
their values. Solvers ask for one derivative at a time: what the last point gave is kept.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from kirisurf.problem import Problem
from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.linearization import Linearization, stencils

INFINITY = 1e20


class SparseProgram:
    """Flat functions of a problem.

    Parameters
    ----------
    problem : Problem
    x : (3 n,)
        Any point: where the patterns are read off.

    Attributes
    ----------
    n, m : int
        Numbers of variables and of rows.
    lower, upper : (m,)
        Bounds of the rows; upper bounds of inequalities are `INFINITY`.
    jacobian_rows, jacobian_columns : (j,) int
    hessian_rows, hessian_columns : (h,) int
        Of the lower triangle.
    """

    def __init__(self, problem: Problem, x: np.ndarray) -> None:
        self._problem = problem
        self._blocks = (*problem.equalities, *problem.inequalities)
        self._assembly = Assembly(problem.n_vertices, self._blocks, stencils(problem))
        self._last = Linearization.at(problem, x.reshape(-1, 3))
        self._equalities = len(problem.equality_rows(self._last.points))
        self._inequalities = len(problem.inequality_rows(self._last.points))
        self.n, self.m = x.size, self._equalities + self._inequalities
        self.lower = np.zeros(self.m)
        self.upper = np.concatenate([np.zeros(self._equalities), np.full(self._inequalities, INFINITY)])
        jacobian = self._jacobian(self._last.points).tocoo()
        self.jacobian_rows, self.jacobian_columns = (part.astype(np.int64) for part in (jacobian.row, jacobian.col))
        hessian = self._assembly.matrix(self._second(np.zeros(self.m))).tocoo()
        self._is_lower = hessian.row >= hessian.col
        self.hessian_rows = hessian.row[self._is_lower].astype(np.int64)
        self.hessian_columns = hessian.col[self._is_lower].astype(np.int64)

    def objective(self, x: np.ndarray) -> float:
        """f(x); infinite where it cannot be evaluated."""
        with np.errstate(all="ignore"):
            return self._problem.objective(x.reshape(-1, 3))

    def rows(self, x: np.ndarray) -> np.ndarray:
        """c(x), (m,)."""
        with np.errstate(all="ignore"):
            points = x.reshape(-1, 3)
            return np.concatenate([self._problem.equality_rows(points), self._problem.inequality_rows(points)])

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """Gradient of f, (3 n,)."""
        return self._at(x).gradient

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Values of the Jacobian of c, (j,)."""
        return self._jacobian(x.reshape(-1, 3)).tocoo().data

    def hessian(self, x: np.ndarray, factor: float, multipliers: np.ndarray) -> np.ndarray:
        """Values of the lower triangle of factor grad^2 f + grad^2 (multipliers . c), (h,)."""
        self._at(x)
        if factor > 0:
            blocks = factor * self._second(multipliers / factor)
        else:
            # a restoration of feasibility leaves the objective out: what it adds goes away again
            blocks = self._second(multipliers) - self._second(np.zeros(self.m))
        return self._assembly.matrix(blocks).tocoo().data[self._is_lower]

    def _at(self, x: np.ndarray) -> Linearization:
        points = x.reshape(-1, 3)
        if not np.array_equal(self._last.points, points):
            # a copy: solvers lend the same memory for every point
            self._last = Linearization.at(self._problem, points.copy())
        return self._last

    def _jacobian(self, points: np.ndarray) -> csr_matrix:
        with np.errstate(all="ignore"):
            return self._assembly.jacobian(tuple(block.jacobian(points) for block in self._blocks))

    def _second(self, multipliers: np.ndarray) -> np.ndarray:
        """Vertex blocks of grad^2 (f + multipliers . c) at the last point."""
        y, z = multipliers[: self._equalities], -multipliers[self._equalities :]
        with np.errstate(all="ignore"):
            return self._last.hessian(self._assembly, y, z, np.zeros(self._inequalities), exact=True)
