"""A finished sheet is pulled along its freedom towards a preference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kirisurf.closest import ClosestPointMap
from kirisurf.formulation import Weights
from kirisurf.outlines import Outline
from kirisurf.problem import Problem, Term
from kirisurf.solvers.choice import Solver
from kirisurf.solvers.outcome import Limits, Outcome, Progress, ShouldStop
from kirisurf.status import Status
from kirisurf.tessellation import Tessellation
from kirisurf.wishes import Preference, preference

ROUNDS = 8
STEPS_EACH = 60
FIRST_HOLD, STIFFEST = 0.1, 1.0
"""Weight of proximity in the first round, and that above which pulling is given up."""
SOFTER = 10.0
"""Factor of that weight from round to round: down after one that succeeded, up after one that failed."""
ROUNDING = 1e-10
"""Root mean square of the rows below which nothing is left to be wished for."""
PAYS = 0.98
"""Factor by which what is wished for must improve for one more round."""

Formulate = Callable[[np.ndarray, Weights, tuple[Term, ...]], Callable[[np.ndarray], Problem]]


def pulled(
    outcome: Outcome,
    name: str,
    tessellation: Tessellation,
    target: Outline | ClosestPointMap,
    formulate: Formulate,
    make_solver: Callable[[Limits], Solver],
    left: Callable[[], Limits],
    keeps: Callable[[np.ndarray], bool],
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> tuple[Outcome, tuple[str, ...]]:
    """Solve again with a preference, from a sheet that meets every row; one that does not is returned as it is.

    Each round holds the sheet near the last one's: fast at first, since a strong pull leads the solver away from
    the rows, where it may not find back. A round that fails is dropped.

    Parameters
    ----------
    outcome : Outcome
    name : str
        Of the preference.
    tessellation : Tessellation
    target : Outline or ClosestPointMap
        The outline of a planar target, or the closest points of a curved one; in tile edges.
    formulate : callable
        Problem near points (q, 3), for weights and wishes.
    make_solver, left : callables
    keeps : callable
        Whether points (q, 3) that meet every row are a sound sheet with edges and openings as asked for.
    progress, should_stop : callables, optional

    Returns
    -------
    Outcome
    tuple of str
        A sentence with what was gained: the root mean square of the rows that the preference is measured by.
    """
    if name == "balanced" or outcome.status is not Status.CONVERGED:
        return outcome, ()
    if name == "curvature" and isinstance(target, Outline):
        return outcome, ("Preference: curvature; a planar target has none: nothing was done.",)

    def wished(points: np.ndarray) -> tuple[Preference, float]:
        wish = preference(name, tessellation, points, target)
        return wish, _measured(formulate(points, wish.weights, wish.terms)(points), wish, points)

    wish, before = wished(outcome.points)
    if before <= ROUNDING:
        return outcome, (f"Preference: {name}; {wish.says}: there were none.",)
    # a sheet that was not sound before may stay so
    sound = keeps(outcome.points)
    now, hold, softest = before, FIRST_HOLD, wish.weights.proximity
    for _ in range(ROUNDS):
        limits = left()
        at = formulate(outcome.points, replace(wish.weights, proximity=hold), wish.terms)
        solver = make_solver(replace(limits, max_steps=min(STEPS_EACH, limits.max_steps)))
        found = solver.solve(at(outcome.points), outcome.points, at, progress, should_stop)
        outcome = replace(outcome, history=outcome.history + found.history)
        if found.status in (Status.INTERRUPTED, Status.TIME_LIMIT):
            break
        following, after = wished(found.points)
        if found.status is not Status.CONVERGED or after >= now or (sound and not keeps(found.points)):
            hold = softest = SOFTER * hold
            if hold > STIFFEST:
                break
            continue
        pays, now, wish = after <= PAYS * now, after, following
        outcome = replace(outcome, points=found.points)
        if not pays and hold <= softest:
            break
        hold = max(softest, hold / SOFTER)
    gained = "nothing was gained" if now >= before else f"from {before:.4g} to {now:.4g} (root mean square)"
    return outcome, (f"Preference: {name}; {wish.says}: {gained}.",)


def _measured(problem: Problem, wish: Preference, points: np.ndarray) -> float:
    """Root mean square of the rows that a preference is about."""
    rows = [term.block.residual(points).ravel() for term in problem.terms if term.block.name == wish.measured_by]
    return float(np.sqrt(np.mean(np.concatenate(rows) ** 2))) if rows else 0.0
