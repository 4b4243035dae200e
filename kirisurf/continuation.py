"""Continuation: what is done where one direct solve is not enough.

From a stiff sheet to a soft one, where the direct solve does not converge: each stage starts at the last
one's best point and is held near it, so that the sheet first becomes feasible far from a difficult target
and then approaches it. And recentering, where it converged far from the target: the sheet is held near its
solution instead of near its start, as long as that pays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from kirisurf.formulation import Weights
from kirisurf.problem import Problem
from kirisurf.solvers.choice import Solver
from kirisurf.solvers.outcome import Limits, Outcome, Progress, ShouldStop
from kirisurf.status import Status

STAGES = (
    Weights(closeness=0.1, fairness=0.1, proximity=0.1),
    Weights(fairness=0.03, proximity=0.03),
    Weights(),
    # held fast: what the softest stage reached becomes a minimum of its own
    Weights(fairness=0.03, proximity=1.0),
)
STEPS_EACH = 60
FAR = 0.04
"""Root mean square distance to the target (tile edges) above which a solution is recentered."""
MOST_RECENTERINGS = 8
ENOUGH = 1.03
"""Sufficiency that ends recentering."""
SOFT = Weights(fairness=1e-3, proximity=0.03)
"""Weights of a recentering towards the target: tiles may differ more from their neighbors."""
PAYS = 0.93
"""Factor by which the distance must fall for one more recentering."""

Formulate = Callable[[np.ndarray, Weights, bool], Callable[[np.ndarray], Problem]]
"""Gives the problem as a function of where the target is modeled, for a reference (n, 3), for weights, and with or
without rows that keep the tiles convex and neighbors facing the same way."""


@dataclass(frozen=True)
class Continuation:
    """Solves directly first, then in stages.

    Attributes
    ----------
    make_solver : callable
        Limits to Solver.
    left : callable
        Returns the limits of a solve, with the time that is left now: one limit of time holds for all solves.
    sufficiency : callable
        The smallest edge and opening of a solution (n, 3), by its own sizes, over what was asked for, whichever
        is less: 1 or more suffices.
    sound : callable
        Are all tiles of a solution (n, 3) convex, and do neighbors face the same way?
    in_stages : bool
        Whether a failed direct solve is followed by stages.
    guarded : bool
        Whether rows keep them so. They are added where a solution is not sound without.
    """

    make_solver: Callable[[Limits], Solver]
    left: Callable[[], Limits]
    sufficiency: Callable[[np.ndarray], float]
    sound: Callable[[np.ndarray], bool]
    in_stages: bool = True
    guarded: bool = False

    def solve(
        self,
        formulate: Formulate,
        start: np.ndarray,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> tuple[Outcome, tuple[str, ...]]:
        """Return the outcome and sentences on how it was reached, where that was not the direct way."""
        outcome, notes = self._solved(formulate, start, progress, should_stop)
        if self.in_stages and not self.guarded and self._is_unsound(outcome):
            again, notes = replace(self, guarded=True).solve(formulate, start, progress, should_stop)
            return replace(again, history=outcome.history + again.history), (_TURNED, *notes)
        if outcome.status is not Status.CONVERGED:
            return outcome, notes
        outcome, more = self.recentered(outcome, formulate, progress, should_stop)
        return outcome, notes + more

    def recentered(
        self,
        outcome: Outcome,
        formulate: Formulate,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> tuple[Outcome, tuple[str, ...]]:
        """Hold a converged sheet near itself instead of near its start, as often as that improves it."""
        count, best, best_enough = 0, outcome, -np.inf
        while self.in_stages and count < MOST_RECENTERINGS:
            at = formulate(outcome.points, Weights(), self.guarded)
            before, enough = _distance(at(outcome.points), outcome.points), self.sufficiency(outcome.points)
            # the last of those that suffice is the closest; of those that do not, the nearest to it counts
            if min(enough, ENOUGH) >= min(best_enough, ENOUGH):
                best, best_enough = outcome, enough
            if before <= FAR and enough >= ENOUGH:
                break
            weights = SOFT if before > FAR else Weights()
            found = self._held(formulate, outcome.points, weights, self.guarded, progress, should_stop)
            if not self.guarded and self._is_unsound(found):
                found = self._held(formulate, outcome.points, weights, True, progress, should_stop)
            after, more = _distance(at(found.points), found.points), self.sufficiency(found.points)
            better = after <= PAYS * before or (enough < ENOUGH and more > enough)
            if found.status is not Status.CONVERGED or not better or not self.sound(found.points):
                break
            outcome, count = replace(found, history=outcome.history + found.history), count + 1
        if min(self.sufficiency(outcome.points), ENOUGH) < min(best_enough, ENOUGH):
            outcome = replace(best, history=outcome.history)
        if not count:
            return outcome, ()
        times = f"{count} time{'s' * (count > 1)}"
        return outcome, (f"Solve: held near its solution instead of its start {times}, which improved it.",)

    def _held(
        self,
        formulate: Formulate,
        points: np.ndarray,
        weights: Weights,
        guarded: bool,
        progress: Progress | None,
        should_stop: ShouldStop | None,
    ) -> Outcome:
        """Solve with a sheet held near points."""
        at = formulate(points, weights, guarded)
        solver = self.make_solver(replace(self.left(), max_steps=STEPS_EACH))
        return solver.solve(at(points), points, at, progress, should_stop)

    def _is_unsound(self, outcome: Outcome) -> bool:
        return outcome.status is Status.CONVERGED and not self.sound(outcome.points)

    def _solved(
        self, formulate: Formulate, start: np.ndarray, progress: Progress | None, should_stop: ShouldStop | None
    ) -> tuple[Outcome, tuple[str, ...]]:
        at = formulate(start, Weights(), self.guarded)
        direct = self.make_solver(self.left()).solve(at(start), start, at, progress, should_stop)
        if direct.status in _FINAL or not self.in_stages:
            return direct, ()
        outcome, history, stages = direct, direct.history, 0
        points = start
        for weights in STAGES:
            at = formulate(points, weights, True)
            solver = self.make_solver(replace(self.left(), max_steps=STEPS_EACH))
            found = solver.solve(at(points), points, at, progress, should_stop)
            history, stages = history + found.history, stages + 1
            points = found.points
            if outcome.status is not Status.CONVERGED or found.status is Status.CONVERGED:
                outcome = found
            if found.status in (Status.INTERRUPTED, Status.TIME_LIMIT):
                break
        if outcome.status is not Status.CONVERGED and _worst(direct) < _worst(outcome):
            return replace(direct, history=history), ()
        note = (
            "Solve: the direct way did not converge; the sheet was first held stiff and then softened in "
            f"{stages} of {len(STAGES)} stages, each of which starts from the one before."
        )
        return replace(outcome, history=history), (note,)


_TURNED = (
    "Solve: some tiles turned inside out or folded back on their neighbors; it was solved again with rows "
    "that keep them from it."
)

_FINAL = (Status.CONVERGED, Status.INTERRUPTED, Status.TIME_LIMIT)


def _distance(problem: Problem, points: np.ndarray) -> float:
    """Root mean square signed distance to the target in the objective; 0 where it is a constraint."""
    rows = [term.block.residual(points) for term in problem.terms if term.block.name == "surface"]
    return float(np.sqrt(np.mean(np.concatenate(rows) ** 2))) if rows else 0.0


def _worst(outcome: Outcome) -> float:
    """Violation of the point that an outcome kept: the smallest along its history."""
    return min((max(step.residuals.values(), default=0.0) for step in outcome.history), default=np.inf)
