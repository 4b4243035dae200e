"""The step direction of the interior-point method: one regularized KKT system, factored once per step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix

from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.linear import Factorization, Ordering
from kirisurf.solvers.linearization import Linearization

REGULARIZATION = 1e-8
"""Lower right diagonal of the factored matrix; removed again by refinement."""


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


class NewtonSystem:
    """The linear system of one interior-point step.

    Parameters
    ----------
    at : Linearization
    assembly, ordering : Assembly, Ordering
    slacks, y, z : arrays
        Slacks and multipliers.
    barrier : float
    exact : bool
        Exact Hessian of the Lagrangian, or Gauss-Newton.
    last_shift : float
        Shift of the Hessian that the last step needed.

    Attributes
    ----------
    shift : float
        Multiple of the identity that was added to the Hessian for the right inertia.

    Raises
    ------
    FloatingPointError
        Where no shift gives a usable factorization.
    """

    def __init__(
        self,
        at: Linearization,
        assembly: Assembly,
        ordering: Ordering,
        slacks: np.ndarray,
        y: np.ndarray,
        z: np.ndarray,
        barrier: float,
        exact: bool,
        last_shift: float,
    ) -> None:
        self._at, self._assembly = at, assembly
        self._sigma = z / slacks
        self._pull = barrier / slacks
        hessian = at.hessian(assembly, y, z, self._sigma, exact=exact)
        jacobian = at.jacobian(assembly)
        self._factor, self.shift = factor_with_inertia(assembly, ordering, hessian, jacobian, last_shift)
        self._matrix = assembly.matrix(hessian, jacobian, self.shift, 0.0)

    def direction(self, equality: np.ndarray, slack_residual: np.ndarray) -> Direction:
        """Solve for residuals of the equalities (m,) and of the slacks (k,)."""
        pulled = self._at.inequality_transpose(self._pull - self._sigma * slack_residual)
        right = -np.concatenate([self._at.gradient - pulled, equality])
        solution = refined(self._factor, self._matrix, right)
        dx = solution[: self._assembly.n_dofs]
        return Direction(dx, solution[self._assembly.n_dofs :], self._at.inequality_apply(dx) + slack_residual)


def factor_with_inertia(
    assembly: Assembly, ordering: Ordering, hessian: np.ndarray, jacobian: np.ndarray, last: float
) -> tuple[Factorization, float]:
    """Factor with the smallest tried shift of the Hessian that leaves as many negative pivots as rows.

    Then the Hessian is positive definite where the constraints hold to first order, and the step descends.

    Raises
    ------
    FloatingPointError
        Where no shift up to 1e10 does it.
    """
    shift, growth = 0.0, 4.0 if last > 0 else 8.0
    while shift <= 1e10:
        try:
            factor = Factorization(assembly.matrix(hessian, jacobian, shift, REGULARIZATION), ordering)
            if factor.n_negative == assembly.n_rows:
                return factor, shift
        except RuntimeError:
            # SuperLU met a pivot of exactly zero: a larger shift moves it
            pass
        shift = growth * shift if shift > 0 else max(1e-4, last / 3)
    raise FloatingPointError("the KKT matrix could not be factored")


def refined(factor: Factorization, matrix: csc_matrix, right: np.ndarray) -> np.ndarray:
    """Solve and refine against the matrix without regularization, as long as the remainder halves."""
    solution = factor.solve(right)
    scale, size = np.abs(right).max(initial=0.0), np.inf
    for _ in range(6):
        remainder = right - matrix @ solution
        new = np.abs(remainder).max(initial=0.0)
        if not new > 1e-14 * scale or new > 0.5 * size:
            break
        size = new
        solution = solution + factor.solve(remainder)
    return solution
