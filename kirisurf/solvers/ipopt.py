"""IPOPT on the same Problem, through ipyopt, as a cross-check and for comparison (Waechter and Biegler 2006)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirisurf.problem import Problem
from kirisurf.solvers.callbacks import INFINITY, SparseProgram
from kirisurf.solvers.optional import library
from kirisurf.solvers.outcome import Limits
from kirisurf.solvers.rounds import Recorder
from kirisurf.status import Status

OPTIONS: dict[str, int | float | str] = {
    "print_level": 0,
    "sb": "yes",
    "acceptable_iter": 0,
    # rows are dimensionless already, and bounds are meant as they are
    "nlp_scaling_method": "none",
    "bound_relax_factor": 0.0,
}
_STATUS = {
    0: Status.CONVERGED,
    2: Status.INFEASIBLE,
    -1: Status.STEP_LIMIT,
    -4: Status.TIME_LIMIT,
    -13: Status.NOT_FINITE,
}
"""IPOPT's own numbers; all others are ways of making no progress."""
_OUT_OF_MEMORY = -102


@dataclass(frozen=True)
class Ipopt:
    """IPOPT with exact sparse derivatives and the linear solver that comes with the library (MUMPS)."""

    def require(self, n: int) -> None:
        """Raise a ParameterError where ipyopt is not installed."""
        library("ipopt")

    def minimize(
        self, problem: Problem, x: np.ndarray, limits: Limits, recorder: Recorder
    ) -> tuple[np.ndarray, Status]:
        """Solve once, with the model of the target as it is."""
        program = SparseProgram(problem, x)
        accepted = x.copy()

        def gradient(v: np.ndarray, out: np.ndarray) -> None:
            # IPOPT asks for the gradient at accepted points only, before it reports the step
            np.copyto(accepted, v)
            np.copyto(out, program.gradient(v))

        def report(mode: int, step: int, _f: float, _primal: float, dual: float, *_rest: float | int) -> bool:
            return step == 0 or recorder.record_safely(accepted, dual)

        unbounded = np.full(program.n, INFINITY)
        nlp = library("ipopt").Problem(
            program.n,
            -unbounded,
            unbounded,
            program.m,
            program.lower,
            program.upper,
            (program.jacobian_rows, program.jacobian_columns),
            (program.hessian_rows, program.hessian_columns),
            program.objective,
            gradient,
            lambda v, out: np.copyto(out, program.rows(v)),
            lambda v, out: np.copyto(out, program.jacobian(v)),
            lambda v, multipliers, factor, out: np.copyto(out, program.hessian(v, factor, multipliers)),
            intermediate_callback=report,
            ipopt_options={
                **OPTIONS,
                "tol": limits.optimality,
                "dual_inf_tol": limits.optimality,
                "compl_inf_tol": limits.optimality,
                "constr_viol_tol": limits.tolerance,
                "max_iter": limits.max_steps,
            },
        )
        found, _, code = nlp.solve(x.copy())
        if code == _OUT_OF_MEMORY:
            raise MemoryError
        return found, _STATUS.get(code, Status.STALLED)
