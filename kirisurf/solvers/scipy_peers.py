"""SciPy's SLSQP and trust-constr on the same Problem, as cross-checks at paper size."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, OptimizeResult, minimize
from scipy.sparse import csr_matrix, vstack

from kirisurf.block import Block
from kirisurf.errors import ParameterError
from kirisurf.problem import Problem
from kirisurf.solvers.outcome import Limits
from kirisurf.solvers.rounds import Recorder
from kirisurf.status import Status

MAX_VARIABLES = {"slsqp": 700, "trust-constr": 3000}
"""Beyond these, SLSQP (dense) needs minutes for one step and trust-constr wanders."""


_CONVERGED = {"slsqp": (0,), "trust-constr": (1, 2)}
_STEP_LIMIT = {"slsqp": 9, "trust-constr": 0}
"""SciPy's own numbers, which mean different things for its two methods."""


class _Stopped(Exception):
    """Raised in a callback to leave SciPy's loop."""


@dataclass(frozen=True)
class ScipyMethod:
    """One of SciPy's general solvers; `name` is slsqp or trust-constr."""

    name: str

    def require(self, n: int) -> None:
        """Raise a ParameterError where the problem is larger than the method can treat."""
        most = MAX_VARIABLES[self.name]
        if n > most:
            raise ParameterError(
                f"--solver {self.name}: expected at most {most} unknowns, got {n}; use --solver auto, or fewer tiles"
            )

    def minimize(
        self, problem: Problem, x: np.ndarray, limits: Limits, recorder: Recorder
    ) -> tuple[np.ndarray, Status]:
        """Solve once, with the model of the target as it is."""
        last = x.copy()

        def report(v: np.ndarray, *_: object) -> None:
            # SciPy lends the same memory for every point
            np.copyto(last, v)
            if not recorder.record(v):
                raise _Stopped

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = self._minimize(problem, x, limits.max_steps, report)
        except _Stopped:
            return last, Status.INTERRUPTED
        if result.status in _CONVERGED[self.name]:
            return result.x, Status.CONVERGED
        return result.x, Status.STEP_LIMIT if result.status == _STEP_LIMIT[self.name] else Status.STALLED

    def _minimize(self, problem: Problem, x: np.ndarray, max_steps: int, record: Callable[..., None]) -> OptimizeResult:
        def objective(v: np.ndarray) -> float:
            return problem.objective(v.reshape(-1, 3))

        def gradient(v: np.ndarray) -> np.ndarray:
            return problem.gradient(v.reshape(-1, 3))

        def rows(v: np.ndarray) -> np.ndarray:
            return problem.equality_rows(v.reshape(-1, 3))

        def slopes(v: np.ndarray) -> csr_matrix:
            return jacobian_of(problem.equalities, v.reshape(-1, 3))

        def open_rows(v: np.ndarray) -> np.ndarray:
            return problem.inequality_rows(v.reshape(-1, 3))

        def open_slopes(v: np.ndarray) -> csr_matrix:
            return jacobian_of(problem.inequalities, v.reshape(-1, 3))

        if self.name == "slsqp":
            constraints = [
                {"type": "eq", "fun": rows, "jac": lambda v: slopes(v).toarray()},
                {"type": "ineq", "fun": open_rows, "jac": lambda v: open_slopes(v).toarray()},
            ]
            return minimize(
                objective,
                x,
                jac=gradient,
                method="SLSQP",
                constraints=constraints,
                callback=record,
                options={"ftol": 1e-14, "maxiter": max_steps},
            )
        return minimize(
            objective,
            x,
            jac=gradient,
            method="trust-constr",
            callback=record,
            bounds=Bounds(-np.inf, np.inf),
            constraints=[
                NonlinearConstraint(rows, 0.0, 0.0, jac=slopes),
                NonlinearConstraint(open_rows, 0.0, np.inf, jac=open_slopes),
            ],
            options={"gtol": 1e-8, "xtol": 1e-12, "maxiter": max_steps},
        )


def jacobian_of(blocks: tuple[Block, ...], points: np.ndarray) -> csr_matrix:
    """Sparse Jacobian (rows, 3 n) of blocks at points (n, 3)."""
    parts = []
    for block in blocks:
        values = block.jacobian(points)
        g, r, k = values.shape
        columns = (3 * block.stencil[:, None, :, None] + np.arange(3)).reshape(g, 1, k)
        columns = np.broadcast_to(columns, values.shape)
        row = np.broadcast_to(np.arange(g * r).reshape(g, r, 1), values.shape)
        parts.append(csr_matrix((values.ravel(), (row.ravel(), columns.ravel())), shape=(g * r, points.size)))
    return vstack(parts, format="csr") if parts else csr_matrix((0, points.size))
