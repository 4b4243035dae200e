"""The line search of the interior-point method: trial points judged by a filter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirisurf.problem import Problem
from kirisurf.solvers.direction import Direction, NewtonSystem
from kirisurf.solvers.filter import Filter
from kirisurf.solvers.linearization import Linearization
from kirisurf.solvers.outcome import longest_displacement

ARMIJO = 1e-8
SMALLEST_PART = 0.01
"""Part of a slack that a step leaves at least.

Why every slack is cut by itself, where interior-point methods shorten the whole step: a few openings that close too
fast would hold up a sheet of thousands of tiles. What a cut slack misses counts as violation, and its small slack
makes the row stiff in the next step.
"""
MOST_HALVINGS = 30
MOST_CORRECTIONS = 3


@dataclass(frozen=True, eq=False)
class Trial:
    """A point of the line search.

    Attributes
    ----------
    points : (n, 3)
    slacks : (k,)
    equality, inequality : residual vectors
    violation : float
        Euclidean norm of (c, g - s). Why not the usual sum: the second-order errors of a full step spread over all
        rows, and their sum would reject it where a few large rows are what it mends.
    merit : float
        Objective minus barrier times the sum of log s.
    """

    points: np.ndarray
    slacks: np.ndarray
    equality: np.ndarray
    inequality: np.ndarray
    violation: float
    merit: float


def violation_of(equality: np.ndarray, slack_residual: np.ndarray) -> float:
    """Euclidean norm of the residuals of equalities and slacks."""
    return float(np.sqrt(equality @ equality + slack_residual @ slack_residual))


def evaluate_trial(problem: Problem, points: np.ndarray, slacks: np.ndarray, barrier: float) -> Trial | None:
    """Evaluate a point; None where a value is not finite.

    A slack below its row is raised to it: that is closer to feasible and has the smaller barrier.
    """
    with np.errstate(all="ignore"):
        objective = problem.objective(points)
        equality, inequality = problem.equality_rows(points), problem.inequality_rows(points)
    if not (np.isfinite(objective) and np.isfinite(equality).all() and np.isfinite(inequality).all()):
        return None
    slacks = np.maximum(slacks, inequality)
    violation = violation_of(equality, inequality - slacks)
    return Trial(points, slacks, equality, inequality, violation, objective - barrier * float(np.log(slacks).sum()))


def step_fraction(values: np.ndarray, change: np.ndarray, barrier: float) -> float:
    """Largest step up to 1 that keeps a part 1 - max(0.99, 1 - barrier) of every positive value."""
    shrinking = change < 0
    keep = max(0.99, 1 - barrier)
    return float(min(1.0, (-keep * values[shrinking] / change[shrinking]).min(initial=np.inf)))


class LineSearch:
    """Searches along one direction from one point.

    Parameters
    ----------
    at : Linearization
    slacks : (k,)
    barrier : float
    filter_ : Filter
        Takes in the starting point when a step is accepted for its violation.
    reach : float
        Longest displacement of a vertex.
    """

    def __init__(
        self, at: Linearization, slacks: np.ndarray, barrier: float, filter_: Filter, reach: float = np.inf
    ) -> None:
        self._at, self._slacks, self._barrier, self._filter, self._reach = at, slacks, barrier, filter_, reach
        self.violation = violation_of(at.equality, at.inequality - slacks)
        self.merit = at.objective - barrier * float(np.log(slacks).sum())

    def search(self, system: NewtonSystem, direction: Direction) -> tuple[Trial, float] | None:
        """Return an acceptable point and its step length, or None after the last halving."""
        slope = float(self._at.gradient @ direction.dx) - self._barrier * float((direction.ds / self._slacks).sum())
        longest = longest_displacement(direction.dx)
        alpha = min(1.0, self._reach / max(longest, 1e-300))
        for halving in range(MOST_HALVINGS):
            trial = self._along(direction, alpha)
            if trial is not None and self._accepts(trial, slope, alpha):
                return trial, alpha
            if halving == 0 and trial is not None and trial.violation >= self.violation:
                corrected = self._corrected(system, trial, alpha, slope)
                if corrected is not None:
                    return corrected, alpha
            alpha *= 0.5
        return None

    def _along(self, direction: Direction, alpha: float) -> Trial | None:
        points = self._at.points + alpha * direction.dx.reshape(-1, 3)
        slacks = np.maximum(self._slacks + alpha * direction.ds, SMALLEST_PART * self._slacks)
        return evaluate_trial(self._at.problem, points, slacks, self._barrier)

    def _accepts(self, trial: Trial, slope: float, alpha: float) -> bool:
        if not self._filter.accepts(trial.violation, trial.merit):
            return False
        descends = slope < 0 and alpha * (-slope) ** 2.3 > max(self.violation, 1e-300) ** 1.1
        if descends and self.violation <= 1e-4:
            return trial.merit <= self.merit + ARMIJO * alpha * slope + 1e-14 * abs(self.merit)
        better = self._filter.improves(trial.violation, trial.merit, self.violation, self.merit)
        # at rounding level of the constraints the violation says nothing any more
        if better or trial.violation <= 1e-10:
            self._filter.add(self.violation, self.merit)
            return True
        return False

    def _corrected(self, system: NewtonSystem, trial: Trial, alpha: float, slope: float) -> Trial | None:
        """Second-order corrections: the constraints' curvature along the full step is taken back."""
        equality, slack = self._at.equality, self._at.inequality - self._slacks
        violation = self.violation
        for _ in range(MOST_CORRECTIONS):
            equality = alpha * equality + trial.equality
            slack = alpha * slack + trial.inequality - trial.slacks
            alpha = 1.0
            following = self._along(system.direction(equality, slack), 1.0)
            if following is None:
                return None
            if self._accepts(following, slope, alpha):
                return following
            if following.violation > 0.99 * violation:
                return None
            trial, violation = following, following.violation
        return None
