"""Uno on the same Problem, through unopy, as a cross-check and for comparison (Vanaret and Leyffer 2024)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirisurf.problem import Problem
from kirisurf.solvers.callbacks import SparseProgram
from kirisurf.solvers.optional import library
from kirisurf.solvers.outcome import Limits
from kirisurf.solvers.rounds import Recorder
from kirisurf.status import Status

_ENDED = {"ITERATION_LIMIT": Status.STEP_LIMIT, "TIME_LIMIT": Status.TIME_LIMIT, "EVALUATION_ERROR": Status.NOT_FINITE}
_SOLVED = {"FEASIBLE_KKT_POINT": Status.CONVERGED, "INFEASIBLE_STATIONARY_POINT": Status.INFEASIBLE}
"""Uno's own names; all others are ways of making no progress."""


@dataclass(frozen=True)
class Uno:
    """Uno with exact sparse derivatives.

    Attributes
    ----------
    preset : str
        Uno's combination of building blocks: ipopt (interior point, MUMPS) or filtersqp (trust region, BQPD).
    """

    preset: str = "ipopt"

    def require(self, n: int) -> None:
        """Raise a ParameterError where unopy is not installed."""
        library("uno")

    def minimize(
        self, problem: Problem, x: np.ndarray, limits: Limits, recorder: Recorder
    ) -> tuple[np.ndarray, Status]:
        """Solve once, with the model of the target as it is."""
        unopy = library("uno")
        program = SparseProgram(problem, x)
        last = x.copy()

        def step_taken(v: np.ndarray, *rest: object) -> bool:
            # asked at the start too, and again where nothing moved; the method's own variables follow the problem's
            if np.array_equal(v[: program.n], last):
                return False
            np.copyto(last, v[: program.n])
            return not recorder.record_safely(last, float(rest[5]))  # type: ignore[arg-type]

        model = unopy.Model(unopy.PROBLEM_NONLINEAR, program.n, unopy.ZERO_BASED_INDEXING)
        model.set_objective(unopy.MINIMIZE, program.objective, lambda v, out: np.copyto(out, program.gradient(v)))
        model.set_constraints(
            program.m,
            lambda v, out: np.copyto(out, program.rows(v)),
            program.lower.tolist(),
            np.where(program.upper > 0, np.inf, 0.0).tolist(),
            len(program.jacobian_rows),
            program.jacobian_rows.tolist(),
            program.jacobian_columns.tolist(),
            lambda v, out: np.copyto(out, program.jacobian(v)),
        )
        model.set_lagrangian_hessian(
            len(program.hessian_rows),
            unopy.LOWER_TRIANGLE,
            program.hessian_rows.tolist(),
            program.hessian_columns.tolist(),
            lambda v, factor, multipliers, out: np.copyto(out, program.hessian(v, factor, multipliers)),
        )
        model.set_lagrangian_sign_convention(unopy.MULTIPLIER_POSITIVE)
        model.set_initial_primal_iterate(x.tolist())
        solver = unopy.UnoSolver()
        solver.set_preset(self.preset)
        options = {
            "logger": "SILENT",
            "primal_tolerance": limits.tolerance,
            "dual_tolerance": limits.optimality,
            "max_iterations": limits.max_steps,
        }
        for name, value in options.items():
            solver.set_option(name, value)
        solver.set_termination_callback(step_taken)
        result = solver.optimize(model)
        found = np.array(result.primal_solution, dtype=float)
        ended = result.optimization_status.name
        if ended != "SUCCESS":
            return found, _ENDED.get(ended, Status.STALLED)
        return found, _SOLVED.get(result.solution_status.name, Status.STALLED)
