"""Restoration: steps that reduce the violation alone, where the line search finds nothing acceptable."""

from __future__ import annotations

import numpy as np

from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.direction import KktFactor
from kirisurf.solvers.filter import Filter
from kirisurf.solvers.line_search import Trial, evaluate_trial, violation_of
from kirisurf.solvers.linearization import Linearization
from kirisurf.solvers.multifrontal import Symbolic
from kirisurf.status import Status

MOST_STEPS = 20
OBJECTIVE_WEIGHT = 1e-4
DAMPING = 1e-2


def restore(
    at: Linearization, slacks: np.ndarray, barrier: float, filter_: Filter, assembly: Assembly, symbolic: Symbolic
) -> Trial | Status:
    """Take damped Gauss-Newton steps to the constraints until the filter accepts a less violated point.

    Each step minimizes a small multiple of the objective's quadratic model plus damping, subject to the
    linearized equalities, with inequalities that are short of half their slack pulled up.

    Returns
    -------
    Trial or Status
        A new point, or INFEASIBLE where the violation cannot be reduced, or STALLED after the last step.
    """
    begin = violation_of(at.equality, at.inequality - slacks)
    filter_.add(begin, at.objective - barrier * float(np.log(slacks).sum()))
    least = np.minimum(slacks, 1e-4)
    size = begin
    for _ in range(MOST_STEPS):
        short = np.minimum(at.inequality - 0.5 * slacks, 0.0)
        weights = np.where(short < 0, 100.0, 0.0)
        none = np.zeros(assembly.n_rows), np.zeros(len(slacks))
        hessian = OBJECTIVE_WEIGHT * at.hessian(assembly, *none, weights, exact=False)
        normal, jacobian = assembly.normal(at.equality_jacobians), assembly.jacobian(at.equality_jacobians)
        factor = KktFactor(assembly, symbolic, assembly.shifted(hessian, DAMPING), normal, jacobian)
        pull = OBJECTIVE_WEIGHT * at.inequality_transpose(weights * short)
        dx = factor.solve(np.concatenate([-pull, -at.equality]))[: assembly.n_dofs].reshape(-1, 3)
        trial, alpha = None, 1.0
        while alpha > 1e-4:
            trial = evaluate_trial(at.problem, at.points + alpha * dx, least, barrier)
            if trial is not None and trial.violation < (1 - 1e-4 * alpha) * size:
                break
            trial, alpha = None, 0.5 * alpha
        if trial is None:
            return Status.INFEASIBLE if size > 1e-6 else Status.STALLED
        size = trial.violation
        if size < 0.9 * begin and filter_.accepts(size, trial.merit):
            return trial
        at = Linearization.at(at.problem, trial.points)
    return Status.STALLED
