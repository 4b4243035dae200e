"""SciPy's SLSQP and trust-constr on the same Problem, as cross-checks at paper size."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, OptimizeResult, minimize
from scipy.sparse import csr_matrix, vstack

from kirisurf.block import Block
from kirisurf.errors import ParameterError
from kirisurf.problem import Problem
from kirisurf.solvers.outcome import Limits, Outcome, Progress, Refresh, ShouldStop
from kirisurf.states import Step
from kirisurf.status import Status

MAX_VARIABLES = {"slsqp": 700, "trust-constr": 3000}
"""Beyond these, SLSQP (dense) needs minutes for one step and trust-constr wanders."""


_CONVERGED = {"slsqp": (0,), "trust-constr": (1, 2)}
_STEP_LIMIT = {"slsqp": 9, "trust-constr": 0}
"""SciPy's own numbers, which mean different things for its two methods."""


class _Stopped(Exception):
    """Raised in a callback to leave SciPy's loop."""


@dataclass(frozen=True)
class ScipyPeer:
    """One of SciPy's general solvers; `method` is slsqp or trust-constr."""

    method: str
    limits: Limits

    def solve(
        self,
        problem: Problem,
        start: np.ndarray,
        refresh: Refresh | None = None,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> Outcome:
        """Solve with the model of the target frozen at the start, then once more with it renewed.

        Raises
        ------
        ParameterError
            Where the problem is larger than the method can treat.
        """
        if start.size > MAX_VARIABLES[self.method]:
            raise ParameterError(
                f"--solver {self.method}: expected at most {MAX_VARIABLES[self.method]} unknowns, got {start.size}; "
                "use --solver auto, or fewer tiles"
            )
        began = time.perf_counter()
        history: list[Step] = []
        points, status = start, Status.STEP_LIMIT
        rounds = 1 if refresh is None else 3
        for _ in range(rounds):
            points, status = self._once(problem, points, history, began, progress, should_stop)
            if status is not Status.CONVERGED or refresh is None:
                break
            problem = refresh(points)
        worst = max(problem.violations(points).values(), default=0.0)
        if status is Status.CONVERGED and worst > max(self.limits.tolerance, 1e-9):
            status = Status.STALLED
        return Outcome(points, status, tuple(history))

    def _once(
        self,
        problem: Problem,
        start: np.ndarray,
        history: list[Step],
        began: float,
        progress: Progress | None,
        should_stop: ShouldStop | None,
    ) -> tuple[np.ndarray, Status]:
        last = start.ravel()

        def record(x: np.ndarray, *_: object) -> None:
            nonlocal last
            points = x.reshape(-1, 3)
            moved = float(np.abs(x - last).max())
            last = x.copy()
            step = Step(
                problem.violations(points), problem.objective(points), float("nan"), moved, time.perf_counter() - began
            )
            history.append(step)
            if progress is not None:
                progress(step)
            if (should_stop is not None and should_stop()) or step.seconds > self.limits.max_seconds:
                raise _Stopped

        record(start.ravel())
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = self._minimize(problem, start.ravel(), record)
        except _Stopped:
            over = time.perf_counter() - began > self.limits.max_seconds
            return last.reshape(-1, 3), Status.TIME_LIMIT if over else Status.INTERRUPTED
        points = result.x.reshape(-1, 3)
        if not np.isfinite(points).all():
            return start, Status.NOT_FINITE
        if result.status in _CONVERGED[self.method]:
            return points, Status.CONVERGED
        return points, Status.STEP_LIMIT if result.status == _STEP_LIMIT[self.method] else Status.STALLED

    def _minimize(self, problem: Problem, x: np.ndarray, record: Callable[..., None]) -> OptimizeResult:
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

        if self.method == "slsqp":
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
                options={"ftol": 1e-14, "maxiter": self.limits.max_steps},
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
            options={"gtol": 1e-8, "xtol": 1e-12, "maxiter": self.limits.max_steps},
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
