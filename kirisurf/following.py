"""Following a way: a family of problems from one whose solution is known to the one that is asked for."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol, runtime_checkable

import numpy as np

from kirisurf.formulation import Weights
from kirisurf.problem import Problem, Term
from kirisurf.solvers.choice import Solver
from kirisurf.solvers.outcome import Limits, Outcome, Progress, ShouldStop
from kirisurf.states import Step
from kirisurf.status import Status

FIRST, GROWTH, LEAST = 0.25, 1.5, 0.01
"""First part of the way, factor after a step that succeeded, and part below which it is given up."""
ROUGH = 1e-4, 1e-3
"""Largest equality row and optimality of a sheet on the way."""
STEPS_EACH = 40


@runtime_checkable
class Way(Protocol):
    """A family of problems at t from 0 to 1."""

    @property
    def words(self) -> str:
        """What happens along it, as a clause."""
        ...

    @abstractmethod
    def start(self) -> np.ndarray:
        """Return the solution (q, 3) at 0."""

    @abstractmethod
    def moved(self, points: np.ndarray, t: float, to: float) -> np.ndarray:
        """Return a guess of the solution at `to` from that at t."""

    @abstractmethod
    def at(
        self, start: np.ndarray, t: float, weights: Weights, wishes: tuple[Term, ...] = ()
    ) -> Callable[[np.ndarray], Problem]:
        """Return the problem at t, held near `start`, as a function of where its models are made."""


def followed(
    way: Way,
    make_solver: Callable[[Limits], Solver],
    left: Callable[[], Limits],
    max_steps: int | None = None,
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> tuple[Outcome, tuple[str, ...]]:
    """Follow a way to its end.

    Parts of the way are as long as the solver succeeds with.

    Parameters
    ----------
    way : Way
    make_solver, left : callables
    max_steps : int, optional
        Limit of the steps of all parts together; by default every part has its own.
    progress, should_stop : callables, optional

    Returns
    -------
    Outcome
        Where the way could not be followed to its end: the last sheet that fitted, moved to the outline, with the
        status of the last attempt; where that used up its own steps, it is that the parts became too small.
    tuple of str
        Sentences on how it was reached.
    """
    t, part, parts = 0.0, FIRST, 0
    points = way.start()
    history: tuple[Step, ...] = ()
    while True:
        to = min(1.0, t + part)
        start = way.moved(points, t, to)
        at = way.at(start, to, Weights())
        limits = left()
        if to < 1:
            tolerance, optimality = ROUGH
            limits = replace(limits, tolerance=tolerance, optimality=optimality)
        # the point that a solve starts from is in its history, and is no step
        rest = STEPS_EACH if max_steps is None else max(0, max_steps - (len(history) - parts))
        solver = make_solver(replace(limits, max_steps=min(STEPS_EACH, rest)))
        found = solver.solve(at(start), start, at, progress, should_stop)
        history += found.history
        parts += 1
        if found.status is Status.CONVERGED:
            t, points, part = to, found.points, GROWTH * part
            if t >= 1:
                note = f"Solve: {way.words} in {parts} parts."
                return replace(found, history=history), (note,)
            continue
        part /= 2
        used_up = found.status is Status.STEP_LIMIT and max_steps is not None and rest <= STEPS_EACH
        if used_up or part < LEAST or found.status in (Status.INTERRUPTED, Status.TIME_LIMIT):
            note = f"Solve: {way.words}, but only {100 * t:.0f} % of the way could be followed."
            status = Status.STALLED if found.status is Status.STEP_LIMIT and not used_up else found.status
            return Outcome(way.moved(points, t, 1.0), status, history), (note,)
