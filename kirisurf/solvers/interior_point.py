"""A primal-dual interior-point method with a filter line search, on a sparse KKT system.

Slacks s of the inequalities g(x) - s = 0 carry a logarithmic barrier and are eliminated, so that one
step solves

    [H + J_I' Z/S J_I + delta   J_E'] [dx]     [grad f - J_I' (mu/s - Z/S (g - s))]
    [J_E                           0] [y+]  = -[c                                  ]

H is the Gauss-Newton matrix far from the constraints and the exact Hessian of the Lagrangian near them;
delta grows until the inertia is that of a minimum. The globalization follows Waechter and Biegler (2006).

The target enters through a second-order model that is renewed at every step while steps are long, and
frozen then: closest points that are re-evaluated inside a line search are not smooth on a mesh.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np
from threadpoolctl import threadpool_limits

from kirisurf.problem import Problem
from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.direction import NewtonSystem
from kirisurf.solvers.filter import Filter
from kirisurf.solvers.line_search import LineSearch, step_fraction
from kirisurf.solvers.linearization import Linearization, stencils
from kirisurf.solvers.multifrontal import Symbolic
from kirisurf.solvers.outcome import (
    HONEST,
    MOST_RENEWALS,
    Limits,
    Outcome,
    Progress,
    Refresh,
    ShouldStop,
    agree,
    longest_displacement,
)
from kirisurf.solvers.restoration import restore
from kirisurf.states import Step
from kirisurf.status import Status


@dataclass(frozen=True, eq=False)
class Iterate:
    """Primal and dual point; every step makes a new one.

    Attributes
    ----------
    points : (n, 3)
    slacks, z : (k,)
        Slacks and multipliers of the inequalities.
    y : (m,)
        Multipliers of the equalities.
    barrier, shift, moved : float
        Barrier parameter, last shift of the Hessian, largest displacement of the last step.
    """

    points: np.ndarray
    slacks: np.ndarray
    y: np.ndarray
    z: np.ndarray
    barrier: float
    shift: float = 0.0
    moved: float = np.inf


@dataclass(frozen=True)
class InteriorPoint:
    """Configuration of the method; the state is in :class:`Iterate`.

    Attributes
    ----------
    limits : Limits
    first_barrier, last_barrier : float
        Barrier parameter at the start and at the end. Why they are equal: a bound need not be met to many
        digits (it is a margin on openings and edges), and lowering the barrier costs steps: 17 instead of 12
        on peaks at 16x16 tiles, 65 instead of 22 on the side of a boot.
    gauss_newton_above : float
        Largest violation above which the Gauss-Newton matrix is used.
    freeze_below : float
        Largest displacement (tile edges) below which the model of the target is frozen.
    max_refreezes : int
        How often a converged solve is continued with a renewed model.
    honest_model : float
        Relative difference of the objective, with the model of the target renewed, that ends the solve.
    reach : float
        Longest displacement in one step (tile edges): beyond it neither model of the target nor of the
        constraints says much, and undamped steps can cycle.
    """

    limits: Limits = field(default_factory=Limits)
    first_barrier: float = 1e-4
    last_barrier: float = 1e-4
    gauss_newton_above: float = 0.1
    freeze_below: float = 0.05
    max_refreezes: int = MOST_RENEWALS
    honest_model: float = HONEST
    reach: float = 0.5

    def solve(
        self,
        problem: Problem,
        start: np.ndarray,
        refresh: Refresh | None = None,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> Outcome:
        """Solve from `start` (n, 3), in units of the tile edge.

        BLAS runs on one thread meanwhile: on fronts of this size more threads cost time, and sums would
        depend on their number.

        Parameters
        ----------
        problem : Problem
        start : (n, 3)
        refresh : callable, optional
            Renews the model of the target at given points.
        progress, should_stop : callables, optional

        Returns
        -------
        Outcome
            Where it did not converge: the least violated point.
        """
        with threadpool_limits(1):
            return self._solve(problem, start, refresh, progress, should_stop)

    def _solve(
        self,
        problem: Problem,
        start: np.ndarray,
        refresh: Refresh | None,
        progress: Progress | None,
        should_stop: ShouldStop | None,
    ) -> Outcome:
        began = time.perf_counter()
        assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
        symbolic = Symbolic(problem.n_vertices, assembly.pattern.rows, assembly.pattern.columns)
        at = Linearization.at(problem, start)
        slacks = np.maximum(at.inequality, 1e-2)
        here = Iterate(start, slacks, np.zeros(assembly.n_rows), self.first_barrier / slacks, self.first_barrier)
        filter_ = Filter(1e4 * max(1.0, LineSearch(at, slacks, 0.0, Filter(np.inf)).violation))
        history: list[Step] = []
        frozen, refreezes = refresh is None, 0
        best, least = start, np.inf

        def ended(status: Status) -> Outcome:
            return Outcome(here.points if status is Status.CONVERGED else best, status, tuple(history))

        while True:
            if not frozen and refresh is not None:
                at = at.renewed(refresh(here.points))
                frozen = here.moved < self.freeze_below or self._in_circles(history, here)
            if not at.is_finite:
                return ended(Status.NOT_FINITE)
            step = self._record(at, here, time.perf_counter() - began)
            history.append(step)
            if progress is not None:
                progress(step)
            worst = max(step.residuals.values(), default=0.0)
            if worst <= max(least, self.limits.tolerance):
                best, least = here.points, worst
            if frozen and self._is_done(step, here, worst):
                renewed = None if refresh is None else at.renewed(refresh(here.points))
                if renewed is None or self._is_honest(renewed, at):
                    return ended(Status.CONVERGED)
                if refreezes >= self.max_refreezes:
                    # a constraint that the renewed model breaks is broken, whatever the frozen one said
                    return ended(Status.CONVERGED if self._holds(renewed) else Status.STALLED)
                at, refreezes = renewed, refreezes + 1
                filter_.clear()
            if should_stop is not None and should_stop():
                return ended(Status.INTERRUPTED)
            if step.seconds > self.limits.max_seconds:
                return ended(Status.TIME_LIMIT)
            if len(history) > self.limits.max_steps:
                return ended(Status.STEP_LIMIT)
            here = self._with_lower_barrier(here, step, worst, filter_)
            try:
                advanced = self._advance(here, at, assembly, symbolic, filter_, worst)
            except FloatingPointError:
                return ended(Status.NOT_FINITE)
            if isinstance(advanced, Status):
                return ended(advanced)
            here = replace(advanced, moved=longest_displacement(advanced.points - here.points))
            at = Linearization.at(at.problem, here.points)

    def _in_circles(self, history: list[Step], here: Iterate) -> bool:
        """Do steps near the constraints not get shorter? Between two sides of a crease renewed models may cycle."""
        if not history:
            return False
        last = history[-1]
        near = max(last.residuals.values(), default=0.0) <= self.gauss_newton_above**2
        return near and here.moved > 0.7 * last.step_length

    def _record(self, at: Linearization, here: Iterate, seconds: float) -> Step:
        lagrangian = at.gradient + at.equality_transpose(here.y) - at.inequality_transpose(here.z)
        return Step(
            residuals=at.violations,
            objective=at.objective,
            optimality=float(np.abs(lagrangian).max()),
            step_length=here.moved if np.isfinite(here.moved) else 0.0,
            seconds=seconds,
        )

    def _is_done(self, step: Step, here: Iterate, worst: float) -> bool:
        return (
            worst <= self.limits.tolerance
            and step.optimality <= self.limits.optimality
            and here.barrier <= self.last_barrier
        )

    def _is_honest(self, renewed: Linearization, at: Linearization) -> bool:
        """Does the renewed model of the target agree with the frozen one at the solution?"""
        return agree(renewed.objective, at.objective, self.honest_model) and self._holds(renewed)

    def _holds(self, at: Linearization) -> bool:
        """Do the equalities hold?"""
        return float(np.abs(at.equality).max(initial=0.0)) <= self.limits.tolerance

    def _with_lower_barrier(self, here: Iterate, step: Step, worst: float, filter_: Filter) -> Iterate:
        barrier = here.barrier
        while barrier > self.last_barrier:
            complementarity = np.abs(here.slacks * here.z - barrier).max(initial=0.0)
            if max(step.optimality, worst, complementarity) > 10 * barrier:
                break
            barrier = max(self.last_barrier, min(0.2 * barrier, barrier**1.5))
            filter_.clear()
        return replace(here, barrier=barrier)

    def _advance(
        self,
        here: Iterate,
        at: Linearization,
        assembly: Assembly,
        symbolic: Symbolic,
        filter_: Filter,
        worst: float,
    ) -> Iterate | Status:
        """One step: direction, line search, and restoration where the search fails."""
        exact = worst <= self.gauss_newton_above
        system = NewtonSystem(at, assembly, symbolic, here.slacks, here.y, here.z, here.barrier, exact, here.shift)
        direction = system.direction(at.equality, at.inequality - here.slacks)
        if not direction.is_finite:
            return Status.NOT_FINITE
        found = LineSearch(at, here.slacks, here.barrier, filter_, self.reach).search(system, direction)
        if found is None:
            trial = restore(at, here.slacks, here.barrier, filter_, assembly, symbolic)
            if isinstance(trial, Status):
                return trial
            z = _near_center(here.z, trial.slacks, here.barrier, 1e3)
            return replace(here, points=trial.points, slacks=trial.slacks, y=np.zeros_like(here.y), z=z, shift=0.0)
        trial, alpha = found
        dz = (here.barrier - here.slacks * here.z - here.z * direction.ds) / here.slacks
        z = here.z + step_fraction(here.z, dz, here.barrier) * dz
        return replace(
            here,
            points=trial.points,
            slacks=trial.slacks,
            y=here.y + alpha * (direction.y - here.y),
            z=_near_center(z, trial.slacks, here.barrier, 1e10),
            shift=system.shift,
        )


def _near_center(z: np.ndarray, slacks: np.ndarray, barrier: float, factor: float) -> np.ndarray:
    """Keep multipliers within a factor of the central path, as the convergence theory asks."""
    return np.clip(z, barrier / (factor * slacks), factor * barrier / slacks)
