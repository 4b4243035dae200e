"""A descent: Newton's method from one set of points down to where nothing pulls, or to where it gives up."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.deployment.loading import Loading
from kirisurf.deployment.newton import FIRST_SHIFT, RAISED, Operator, Problem, State

NOTHING = 1e-20
"""Energy below which a state is a minimum whatever its second derivatives: energies are sums of squares."""

LONGEST = 0.5
"""Largest displacement of a coordinate in one step, in tile edges."""

DECREASE = 0.01
"""Part of the decrease that the model foresees which a step must bring."""

CUT, CUTS = 0.25, 2
"""A step that fails is cut to this part of its length, so often, before the shift grows: a cut needs no new factor."""

WIDENED = 2.0
"""Factor by which the length of steps grows again after one that was taken."""

LOWERED, LITTLE_LOWERED = 8.0, 2.0
"""Parts to which a shift is lowered after a step: the latter where less had just been too little."""

REUSED = 0.1
"""A factor serves again after a step that brought the residual below this part of the one before."""

ROUNDING = 1e-13
"""Part of an energy that rounding may change."""


class Descent:
    """A descent under way: what changes from step to step.

    Each step solves with H + shift, the shift so large that the energy is convex where the sheet is free to move. It
    is taken if the energy falls about as the model says; else it is cut, and if that does not help the shift grows
    (Levenberg, Marquardt).

    Parameters
    ----------
    problem : Problem
    points : (n, d)
        Where it begins.
    loading : Loading

    Attributes
    ----------
    points : (n, d)
    state : State
        At the points.
    shift : float
    steps : int
    """

    def __init__(self, problem: Problem, points: Float[np.ndarray, "n d"], loading: Loading) -> None:
        self._problem, self._loading = problem, loading
        self.points, self.state = points, problem.state(points, loading)
        self.shift, self.steps = problem.least_shift, 0
        self._operator: Operator | None = None
        self._is_fresh, self._is_convex, self._was_raised = True, not problem.curved, False
        self._reach, self._cuts = LONGEST, 0

    @property
    def is_balanced(self) -> bool:
        """Nothing pulls."""
        return self.state.residual <= self._problem.tolerance

    @property
    def is_stable(self) -> bool:
        """No direction was left in which the energy falls, to second order, where this was last looked at."""
        return bool(self._is_convex or (self.is_balanced and self.state.total <= NOTHING))

    def run(self, max_steps: int, enough: float) -> None:
        """Go on until a minimum or saddle is reached, the energy is low enough, or steps are used up."""
        while not self._is_over(max_steps, enough):
            operator = self._operator or self._factored()
            # where nothing pulls, all that was left to know is whether this is a minimum
            if operator is None or self.is_balanced:
                break
            self._step(operator)

    def _is_over(self, max_steps: int, enough: float) -> bool:
        if self.is_balanced:
            return self.is_stable
        return bool(not np.isfinite(self.state.residual) or self.steps >= max_steps or self.state.total <= enough)

    def _factored(self) -> Operator | None:
        """Factor at the points, with a larger shift where the energy falls in some direction; None if none serves."""
        least = self._problem.least_shift
        asked = least if self.is_balanced else self.shift
        self._operator, self.shift = self._problem.convex(self.state, asked)
        self._is_fresh, self._was_raised = True, self.shift > asked
        self._is_convex = self._operator is not None and (self.shift <= least or not self._problem.curved)
        return self._operator

    def _step(self, operator: Operator) -> None:
        """Try one step, and take it or make the next one shorter."""
        self.steps += 1
        move = -operator.solve(self.state.gradient)
        size = float(np.abs(move).max(initial=0.0))
        move *= min(1.0, self._reach / max(size, 1e-300))
        trial = self._problem.moved(self.points, move)
        there = self._problem.state(trial, self._loading)
        if self._falls(there, -0.5 * self._problem.work(self.state, move)) or self._is_nearer(there):
            self._take(trial, there, size)
        else:
            self._shorten(size)

    def _falls(self, there: State, expected: float) -> bool:
        return bool(there.total <= self.state.total - DECREASE * expected)

    def _is_nearer(self, there: State) -> bool:
        """Is a state nearer to equilibrium, where energies differ by no more than rounding?"""
        rounding = ROUNDING * (abs(self.state.total) + ROUNDING)
        return bool(there.residual < 0.5 * self.state.residual and there.total <= self.state.total + rounding)

    def _take(self, trial: Float[np.ndarray, "n d"], there: State, size: float) -> None:
        if not self._serves_again(there):
            self._operator = None
        self.points, self.state, self._is_fresh = trial, there, False
        self.shift = self._lowered_shift()
        self._reach = min(LONGEST, WIDENED * (min(self._reach, size) if self._cuts else self._reach))
        self._cuts = 0

    def _serves_again(self, there: State) -> bool:
        """Is the factor good enough for the next step too?"""
        # without curvature an old factor knows nothing of the motions that were free then
        is_plain = self._problem.curved and self.shift <= self._problem.least_shift
        return bool(is_plain and there.residual <= REUSED * self.state.residual)

    def _lowered_shift(self) -> float:
        if self.shift <= 0.1 * FIRST_SHIFT:
            return self._problem.least_shift
        return self.shift / (LITTLE_LOWERED if self._was_raised else LOWERED)

    def _shorten(self, size: float) -> None:
        """Cut the next step, or have it found with a new factor: at the points if it was an old one, else shifted."""
        if self._is_fresh and self._problem.curved and self._cuts < CUTS:
            self._reach, self._cuts = CUT * min(self._reach, size), self._cuts + 1
            return
        if self._is_fresh:
            self.shift = max(RAISED * self.shift, self._problem.first_shift)
            self._reach, self._cuts = LONGEST, 0
        self._operator = None
