"""The step direction of the interior-point method: one KKT system, factored once per step.

The system [[H, J'], [J, 0]] is solved through the positive definite matrix A = H + J'J / eps: with the lower
right block -eps, eliminating the multipliers leaves A, and iterative refinement removes eps again. A is
positive definite exactly where the KKT matrix has the inertia of a minimum, so that a Cholesky factorization
is solver and test in one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.linearization import Linearization
from kirisurf.solvers.multifrontal import Cholesky, Symbolic

REGULARIZATION = 1e-6
"""The eps above: large enough that A keeps ten digits of H, small enough that a step needs no refinement, or one."""

MOST_REFINEMENTS = 8
INEXACT = 1e-6
"""What a step may leave of its right-hand side: steps are as many as with 1e-13, and mostly one solution is enough."""

LARGEST_SHIFT = 1e10


@dataclass(frozen=True, eq=False)
class Direction:
    """A step: displacements (3 n,), new multipliers of the equalities (m,), change of the slacks (k,)."""

    dx: np.ndarray
    y: np.ndarray
    ds: np.ndarray

    @property
    def is_finite(self) -> bool:
        """Are all displacements finite numbers?"""
        return bool(np.isfinite(self.dx).all())


class KktFactor:
    """A factored KKT system [[H + shift I, J'], [J, 0]].

    Parameters
    ----------
    assembly : Assembly
    symbolic : Symbolic
        Of the assembly's pattern.
    hessian : (pairs, 3, 3)
        Blocks of H.
    normal : (pairs, 3, 3)
        Blocks of J'J. Their memory is used for A: they are lost.
    jacobian : (m, 3 n) sparse
    last : float
        Shift that the last step needed.

    Attributes
    ----------
    shift : float
        The smallest tried multiple of the identity that makes H + shift I positive definite where the
        constraints hold to first order.

    Raises
    ------
    FloatingPointError
        Where no shift does.
    """

    def __init__(
        self,
        assembly: Assembly,
        symbolic: Symbolic,
        hessian: np.ndarray,
        normal: np.ndarray,
        jacobian: csr_matrix,
        last: float = 0.0,
    ) -> None:
        self._n, self._jacobian = assembly.n_dofs, jacobian
        self._assembly, self._hessian = assembly, hessian
        matrix = normal
        matrix /= REGULARIZATION
        matrix += hessian
        self.shift, growth = 0.0, 4.0 if last > 0 else 8.0
        while True:
            try:
                self._cholesky = Cholesky(symbolic, matrix)
                break
            except np.linalg.LinAlgError:
                before, self.shift = self.shift, growth * self.shift if self.shift > 0 else max(1e-4, last / 3)
                if self.shift > LARGEST_SHIFT:
                    raise FloatingPointError("the KKT matrix could not be factored") from None
                assembly.shift(matrix, self.shift - before)

    def solve(self, right: np.ndarray, remainder: float = 1e-13) -> np.ndarray:
        """Solve for a right-hand side (3 n + m,), refined while the remainder is above its share and halves."""
        solution = self._once(right)
        scale, size = np.abs(right).max(initial=0.0), np.inf
        for _ in range(MOST_REFINEMENTS):
            x, y = solution[: self._n], solution[self._n :]
            top = self._assembly.apply(self._hessian, x) + self.shift * x + self._jacobian.T @ y
            product = np.concatenate([top, self._jacobian @ x])
            rest = right - product
            new = np.abs(rest).max(initial=0.0)
            if not new > remainder * scale or new > 0.5 * size:
                break
            size = new
            solution = solution + self._once(rest)
        return solution

    def _once(self, right: np.ndarray) -> np.ndarray:
        top, bottom = right[: self._n], right[self._n :]
        x = self._cholesky.solve(top + self._jacobian.T @ (bottom / REGULARIZATION))
        return np.concatenate([x, (self._jacobian @ x - bottom) / REGULARIZATION])


class NewtonSystem:
    """The linear system of one interior-point step.

    Parameters
    ----------
    at : Linearization
    assembly, symbolic : Assembly, Symbolic
    slacks, y, z : arrays
        Slacks and multipliers.
    barrier : float
    exact : bool
        Exact Hessian of the Lagrangian, or Gauss-Newton.
    last_shift : float

    Attributes
    ----------
    shift : float

    Raises
    ------
    FloatingPointError
        Where no shift gives a usable factorization.
    """

    def __init__(
        self,
        at: Linearization,
        assembly: Assembly,
        symbolic: Symbolic,
        slacks: np.ndarray,
        y: np.ndarray,
        z: np.ndarray,
        barrier: float,
        exact: bool,
        last_shift: float,
    ) -> None:
        self._at, self._n, self._y = at, assembly.n_dofs, y
        self._sigma = z / slacks
        self._pull = barrier / slacks
        hessian = at.hessian(assembly, y, z, self._sigma, exact=exact)
        normal, jacobian = assembly.normal(at.equality_jacobians), assembly.jacobian(at.equality_jacobians)
        self._factor = KktFactor(assembly, symbolic, hessian, normal, jacobian, last_shift)
        self.shift = self._factor.shift

    def direction(self, equality: np.ndarray, slack_residual: np.ndarray) -> Direction:
        """Solve for residuals of the equalities (m,) and of the slacks (k,)."""
        pulled = self._at.inequality_transpose(self._pull - self._sigma * slack_residual)
        # Solved for the change of the multipliers: what the regularization leaves of the equalities is as small.
        gradient = self._at.gradient + self._at.equality_transpose(self._y) - pulled
        solution = self._factor.solve(-np.concatenate([gradient, equality]), INEXACT)
        dx = solution[: self._n]
        return Direction(dx, self._y + solution[self._n :], self._at.inequality_apply(dx) + slack_residual)
