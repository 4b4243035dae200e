"""How a general solver, which knows no renewal of the target's model, is led through a fit.

It solves with the model frozen, then again from there with the model renewed, until the two agree: the same
ending as that of the project's own method.
"""

from __future__ import annotations

import time
from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from threadpoolctl import threadpool_limits

from kirisurf.problem import Problem
from kirisurf.solvers.outcome import (
    MOST_RENEWALS,
    Limits,
    Outcome,
    Progress,
    Refresh,
    ShouldStop,
    agree,
    longest_displacement,
)
from kirisurf.states import Step
from kirisurf.status import Status

RIGID = 1e-9
"""What a general solver is let off with, where the tolerance is smaller: it measures its rows in its own way."""


class Recorder:
    """Turns a solver's iterates into steps of the history, and says when it has to stop.

    Parameters
    ----------
    limits : Limits
    progress, should_stop : callables or None

    Attributes
    ----------
    problem : Problem
        The one with the present model of the target.
    history : list of Step
    points : (n, 3)
        Last recorded point.
    stopped : Status or None
        Why to stop.
    failure : BaseException or None
        What a callback raised, kept while foreign code is on the stack that would swallow it.
    """

    def __init__(self, problem: Problem, limits: Limits, progress: Progress | None, should_stop: ShouldStop | None):
        self.problem = problem
        self.history: list[Step] = []
        self.points: np.ndarray | None = None
        self.stopped: Status | None = None
        self.failure: BaseException | None = None
        self._limits, self._progress, self._should_stop = limits, progress, should_stop
        self._began = time.perf_counter()

    def record(self, x: np.ndarray, optimality: float = float("nan")) -> bool:
        """Record a point (3 n,); return whether to go on."""
        points = np.array(x, dtype=float).reshape(-1, 3)
        before, self.points = (points if self.points is None else self.points), points
        step = Step(
            self.problem.violations(points),
            self.problem.objective(points),
            float(optimality),
            longest_displacement(points - before),
            time.perf_counter() - self._began,
        )
        self.history.append(step)
        if self._progress is not None:
            self._progress(step)
        if self._should_stop is not None and self._should_stop():
            self.stopped = Status.INTERRUPTED
        elif step.seconds > self._limits.max_seconds:
            self.stopped = Status.TIME_LIMIT
        return self.stopped is None

    def record_safely(self, x: np.ndarray, optimality: float = float("nan")) -> bool:
        """Record as `record` does, under foreign code: what is raised is kept, and the answer is to stop."""
        try:
            return self.record(x, optimality)
        except BaseException as problem:
            self.failure = problem
            return False


@runtime_checkable
class Method(Protocol):
    """A general solver of problems whose model of the target stays as it is; configuration only."""

    @abstractmethod
    def require(self, n: int) -> None:
        """Raise a ParameterError where the method cannot treat n unknowns, or is not installed."""

    @abstractmethod
    def minimize(
        self, problem: Problem, x: np.ndarray, limits: Limits, recorder: Recorder
    ) -> tuple[np.ndarray, Status]:
        """Return the last point (3 n,) and how it was reached, from a start x (3 n,)."""


@dataclass(frozen=True)
class Peer:
    """A general solver for a fit, beside the project's own.

    Attributes
    ----------
    method : Method
    limits : Limits
    """

    method: Method
    limits: Limits

    def solve(
        self,
        problem: Problem,
        start: np.ndarray,
        refresh: Refresh | None = None,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> Outcome:
        """Solve until the model of the target, renewed at the solution, agrees with the one that was solved with.

        BLAS runs on one thread meanwhile, as for the project's own method.

        Raises
        ------
        ParameterError
            Where the method cannot treat the problem, or is not installed.
        """
        self.method.require(start.size)
        recorder = Recorder(problem, self.limits, progress, should_stop)
        points, status = start, Status.STEP_LIMIT
        going = recorder.record(start.ravel())
        for _ in range(MOST_RENEWALS if going else 0):
            left = self.limits.max_steps - len(recorder.history) + 1
            if left < 1:
                status = Status.STEP_LIMIT
                break
            with threadpool_limits(1):
                limits = replace(self.limits, max_steps=left)
                x, status = self.method.minimize(recorder.problem, points.ravel(), limits, recorder)
            if recorder.failure is not None:
                # no longer held here: the solver's own objects, which no garbage collector sees, would keep it for ever
                failure, recorder.failure = recorder.failure, None
                raise failure
            if not np.isfinite(x).all():
                status = Status.NOT_FINITE
                break
            points = x.reshape(-1, 3)
            if status is not Status.CONVERGED or refresh is None:
                break
            renewed = refresh(points)
            same = agree(renewed.objective(points), recorder.problem.objective(points))
            recorder.problem = renewed
            if same and _worst(renewed, points) <= max(self.limits.tolerance, RIGID):
                break
        if recorder.stopped is not None:
            status = recorder.stopped
        if status is Status.CONVERGED and _worst(recorder.problem, points) > max(self.limits.tolerance, RIGID):
            status = Status.STALLED
        return Outcome(points, status, tuple(recorder.history))


def _worst(problem: Problem, points: np.ndarray) -> float:
    return max(problem.violations(points).values(), default=0.0)
