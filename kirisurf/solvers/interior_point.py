"""A primal-dual interior-point method with a filter line search, on a sparse KKT system.

Slacks s of the inequalities g(x) - s = 0 carry a logarithmic barrier and are eliminated, so that one
step solves

    [H + J_I' Z/S J_I + delta   J_E'] [dx]     [grad f - J_I' (mu/s - Z/S (g - s))]
    [J_E                        -eps] [y+]  = -[c                                  ]

H is the Gauss-Newton matrix far from the constraints and the exact Hessian of the Lagrangian near them;
delta grows until the inertia is that of a minimum. The method follows Waechter and Biegler (2006).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np

from kirisurf.fit import Step
from kirisurf.problem import Problem
from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.filter import Filter
from kirisurf.solvers.linear import Factorization, Ordering
from kirisurf.solvers.linearization import Linearization, stencils
from kirisurf.solvers.outcome import Limits, Outcome, Progress, Refresh, ShouldStop
from kirisurf.status import Status

REGULARIZATION = 1e-8


@dataclass(frozen=True, eq=False)
class Iterate:
    """Primal and dual point of one step; every step makes a new one."""

    points: np.ndarray
    slacks: np.ndarray
    y: np.ndarray
    z: np.ndarray
    barrier: float
    shift: float = 0.0


@dataclass(frozen=True)
class InteriorPoint:
    """Configuration of the method; the state is in :class:`Iterate`.

    Attributes
    ----------
    limits : Limits
    first_barrier, last_barrier : float
        Barrier parameter at the start and at the end.
    gauss_newton_above : float
        Equality violation above which the Gauss-Newton matrix is used.
    freeze_below : float
        Largest displacement (tile edges) below which the model of the target is frozen.
    max_refreezes : int
        How often a converged solve is continued with a renewed model.
    """

    limits: Limits = field(default_factory=Limits)
    first_barrier: float = 1e-5
    last_barrier: float = 1e-8
    gauss_newton_above: float = 1e-2
    freeze_below: float = 0.05
    max_refreezes: int = 3

    def solve(
        self,
        problem: Problem,
        start: np.ndarray,
        refresh: Refresh | None = None,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> Outcome:
        """Solve from `start` (n, 3); see the class for how.

        Parameters
        ----------
        problem : Problem
        start : (n, 3)
            In units of the tile edge.
        refresh : callable, optional
            Renews the model of the target at given points.
        progress, should_stop : callables, optional
        """
        began = time.perf_counter()
        assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
        ordering = Ordering(assembly)
        gap = problem.inequality_rows(start)
        slacks = np.maximum(gap, 1e-2)
        here = Iterate(start, slacks, np.zeros(assembly.n_rows), self.first_barrier / slacks, self.first_barrier)
        at = Linearization.at(problem, start)
        filter_ = Filter(1e4 * max(1.0, _violation(at, slacks)))
        history: list[Step] = []
        frozen, refreezes, moved = refresh is None, 0, np.inf
        best = (np.inf, start)
        for _ in range(self.limits.max_steps + 1):
            if not frozen and refresh is not None:
                problem = refresh(here.points)
                at = Linearization.at(problem, here.points)
                filter_.clear()
                frozen = moved < self.freeze_below
            optimality = np.abs(
                at.gradient + at.equality_transpose(here.y) - at.inequality_transpose(here.z)
            ).max()
            step = Step(
                residuals=problem.violations(here.points),
                objective=at.objective,
                optimality=float(optimality),
                step_length=float(moved) if np.isfinite(moved) else 0.0,
                seconds=time.perf_counter() - began,
            )
            history.append(step)
            if progress is not None:
                progress(step)
            worst = max(step.residuals.values(), default=0.0)
            if worst < best[0] or worst < self.limits.tolerance:
                best = (worst, here.points)
            error = max(optimality, worst, np.abs(here.slacks * here.z - here.barrier).max(initial=0.0))
            done = (
                worst <= self.limits.tolerance
                and optimality <= self.limits.optimality
                and here.barrier <= self.last_barrier
            )
            if done and frozen:
                if refresh is None or refreezes >= self.max_refreezes:
                    return Outcome(here.points, Status.CONVERGED, tuple(history))
                renewed = refresh(here.points)
                change = np.abs(renewed.gradient(here.points) - at.gradient).max()
                surface = max(renewed.violations(here.points).values(), default=0.0)
                if change <= 10 * self.limits.optimality and surface <= self.limits.tolerance:
                    return Outcome(here.points, Status.CONVERGED, tuple(history))
                refreezes += 1
                problem = renewed
                at = Linearization.at(problem, here.points)
                filter_.clear()
            if should_stop is not None and should_stop():
                return Outcome(best[1], Status.INTERRUPTED, tuple(history))
            if step.seconds > self.limits.max_seconds:
                return Outcome(best[1], Status.TIME_LIMIT, tuple(history))
            while here.barrier > self.last_barrier and error <= 10 * here.barrier:
                barrier = max(self.last_barrier, min(0.2 * here.barrier, here.barrier**1.5))
                here = replace(here, barrier=barrier)
                filter_.clear()
                error = max(optimality, worst, np.abs(here.slacks * here.z - barrier).max(initial=0.0))
            advanced = self._advance(here, at, assembly, ordering, filter_, worst)
            if isinstance(advanced, Status):
                return Outcome(best[1], advanced, tuple(history))
            moved = np.abs(advanced.points - here.points).max()
            here = advanced
            at = Linearization.at(problem, here.points)
        return Outcome(best[1], Status.STEP_LIMIT, tuple(history))

    def _advance(
        self,
        here: Iterate,
        at: Linearization,
        assembly: Assembly,
        ordering: Ordering,
        filter_: Filter,
        worst: float,
    ) -> Iterate | Status:
        """One step: direction, step lengths, line search."""
        s, z, mu = here.slacks, here.z, here.barrier
        sigma = z / s
        hessian = at.hessian(assembly, here.y, z, sigma, exact=worst <= self.gauss_newton_above)
        jacobian = at.jacobian(assembly)
        factor, shift = _with_right_inertia(assembly, ordering, hessian, jacobian, here.shift)
        if factor is None:
            return Status.NOT_FINITE
        exact = assembly.matrix(hessian, jacobian, shift, 0.0)
        slack_residual = at.inequality - s
        top = at.gradient - at.inequality_transpose(mu / s - sigma * slack_residual)

        def direction(equality: np.ndarray, slack: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            right = -np.concatenate(
                [at.gradient - at.inequality_transpose(mu / s - sigma * slack), equality]
            )
            solution = _refined(factor, exact, right)
            dx = solution[: assembly.n_dofs]
            return dx, solution[assembly.n_dofs :], at.inequality_apply(dx) + slack

        del top
        dx, y_new, ds = direction(at.equality, slack_residual)
        if not np.isfinite(dx).all():
            return Status.NOT_FINITE
        dz = (mu - s * z - z * ds) / s
        tau = max(0.99, 1 - mu)
        limit = min(1.0, _fraction(s, ds, tau))
        limit_z = min(1.0, _fraction(z, dz, tau))

        violation = _violation(at, s)
        merit = at.objective - mu * np.log(s).sum()
        slope = float(at.gradient @ dx) - mu * float((ds / s).sum())
        alpha, first = limit, True
        for _ in range(30):
            trial = self._trial(here, at.problem, dx, ds, alpha)
            if trial is not None and self._acceptable(filter_, trial, violation, merit, slope, alpha):
                return self._accept(here, trial, y_new, dz, alpha, limit_z, shift)
            if first and trial is not None and trial[2] >= violation:
                corrected = self._corrected(here, at, direction, dx, ds, alpha, violation, merit, slope, filter_, tau)
                if corrected is not None:
                    return self._accept(here, corrected, y_new, dz, alpha, limit_z, shift)
            first = False
            alpha *= 0.5
        return self._restore(here, at, assembly, ordering, violation, filter_, merit, shift)

    def _trial(self, here, problem, dx, ds, alpha):  # noqa: ANN001, ANN202
        points = here.points + alpha * dx.reshape(-1, 3)
        with np.errstate(all="ignore"):
            objective, c, g = problem.objective(points), problem.equality_rows(points), problem.inequality_rows(points)
        if not (np.isfinite(objective) and np.isfinite(c).all() and np.isfinite(g).all()):
            return None
        # a larger slack is closer to its row and has a smaller barrier
        slacks = np.maximum(here.slacks + alpha * ds, g)
        violation = np.abs(c).sum() + np.abs(g - slacks).sum()
        return points, slacks, violation, objective - here.barrier * np.log(slacks).sum(), c, g

    def _acceptable(self, filter_, trial, violation, merit, slope, alpha):  # noqa: ANN001, ANN202
        _, _, new_violation, new_merit, *_ = trial
        if not filter_.accepts(new_violation, new_merit):
            return False
        if slope < 0 and alpha * (-slope) ** 2.3 > max(violation, 1e-300) ** 1.1 and violation <= 1e-4:
            return new_merit <= merit + 1e-8 * alpha * slope + 1e-14 * abs(merit)
        if filter_.improves(new_violation, new_merit, violation, merit) or new_violation <= 1e-10:
            filter_.add(violation, merit)
            return True
        return False

    def _corrected(self, here, at, direction, dx, ds, alpha, violation, merit, slope, filter_, tau):  # noqa: ANN001, ANN202
        """Second-order corrections: up to three steps that also remove the violation of the full step."""
        equality, slack = at.equality.copy(), at.inequality - here.slacks
        old = violation
        for _ in range(3):
            trial = self._trial(here, at.problem, dx, ds, alpha)
            if trial is None:
                return None
            equality = alpha * equality + trial[4]
            slack = alpha * slack + trial[5] - (here.slacks + alpha * ds)
            dx, _, ds = direction(equality, slack)
            alpha = min(1.0, _fraction(here.slacks, ds, tau))
            trial = self._trial(here, at.problem, dx, ds, alpha)
            if trial is None:
                return None
            if self._acceptable(filter_, trial, violation, merit, slope, alpha):
                return trial
            if trial[2] > 0.99 * old:
                return None
            old = trial[2]
        return None

    def _accept(self, here, trial, y_new, dz, alpha, limit_z, shift):  # noqa: ANN001, ANN202
        z = here.z + limit_z * dz
        # keep z near mu / s, as the convergence theory asks
        z = np.clip(z, here.barrier / (1e10 * trial[1]), 1e10 * here.barrier / trial[1])
        y = here.y + alpha * (y_new - here.y)
        return replace(here, points=trial[0], slacks=trial[1], y=y, z=z, shift=shift)

    def _restore(self, here, at, assembly, ordering, violation, filter_, merit, shift):  # noqa: ANN001, ANN202
        """Feasibility steps alone: Levenberg steps on the violated rows until the filter accepts."""
        filter_.add(violation, merit)
        problem, points, damping = at.problem, here.points, 1e-2
        current, size = at, violation
        for _ in range(20):
            low = np.where(current.inequality < here.slacks * 0.5, current.inequality - 0.5 * here.slacks, 0.0)
            weights = (low < 0).astype(float) / 1e-2
            hessian = current.hessian(assembly, 0 * here.y, 0 * here.z, weights, exact=False) * 1e-4
            factor, _ = _with_right_inertia(assembly, ordering, hessian, current.jacobian(assembly), damping)
            if factor is None:
                return Status.NOT_FINITE
            right = np.concatenate([-1e-4 * current.inequality_transpose(weights * low), -current.equality])
            dx = factor.solve(right)[: assembly.n_dofs].reshape(-1, 3)
            alpha = 1.0
            while alpha > 1e-4:
                trial_points = points + alpha * dx
                c, g = problem.equality_rows(trial_points), problem.inequality_rows(trial_points)
                slacks = np.maximum(g, np.minimum(here.slacks, 1e-4))
                new = np.abs(c).sum() + np.abs(g - slacks).sum()
                if np.isfinite(new) and new < (1 - 1e-4 * alpha) * size:
                    break
                alpha *= 0.5
            else:
                return Status.INFEASIBLE if size > 1e-6 else Status.STALLED
            points, size = trial_points, new
            current = Linearization.at(problem, points)
            new_merit = current.objective - here.barrier * np.log(slacks).sum()
            if size < 0.9 * violation and filter_.accepts(size, new_merit):
                z = np.clip(here.z, here.barrier / (1e3 * slacks), 1e3 * here.barrier / slacks)
                return replace(here, points=points, slacks=slacks, y=np.zeros_like(here.y), z=z, shift=0.0)
        return Status.STALLED


def _violation(at: Linearization, slacks: np.ndarray) -> float:
    return float(np.abs(at.equality).sum() + np.abs(at.inequality - slacks).sum())


def _fraction(values: np.ndarray, change: np.ndarray, tau: float) -> float:
    """Largest step that keeps (1 - tau) of every positive value."""
    shrinking = change < 0
    return float((-tau * values[shrinking] / change[shrinking]).min(initial=np.inf))


def _with_right_inertia(assembly, ordering, hessian, jacobian, last):  # noqa: ANN001, ANN202
    """Factor with the smallest tried shift of the Hessian that gives as many negative pivots as rows."""
    shift = 0.0
    for _ in range(40):
        try:
            factor = Factorization(assembly.matrix(hessian, jacobian, shift, REGULARIZATION), ordering)
            if factor.n_negative == assembly.n_rows:
                return factor, shift
        except RuntimeError:
            pass
        shift = max(1e-4, last / 3) if shift == 0.0 else 8.0 * shift if last == 0.0 else 4.0 * shift
        if shift > 1e10:
            break
    return None, 0.0


def _refined(factor: Factorization, exact, right: np.ndarray) -> np.ndarray:  # noqa: ANN001
    """Solve and refine against the matrix without regularization."""
    solution = factor.solve(right)
    scale = np.abs(right).max()
    size = np.inf
    for _ in range(6):
        remainder = right - exact @ solution
        new = np.abs(remainder).max()
        if new <= 1e-14 * scale or new > 0.5 * size:
            break
        size = new
        solution = solution + factor.solve(remainder)
    return solution
