"""The main line: a surface and a spec in, a deployed and a contracted sheet out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.closest import ClosestPoints
from kirisurf.contract import contract
from kirisurf.fit import Contracted, Fit, Step
from kirisurf.formulation import Formulation, Weights
from kirisurf.scaling import Scaled, unit_scale
from kirisurf.solvers.choice import make_solver
from kirisurf.solvers.outcome import Limits, Outcome
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from kirisurf.status import Status
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation
from kirisurf.topology import require_disk


@dataclass(frozen=True, eq=False)
class FitResult:
    """A fit with everything that led to it.

    Attributes
    ----------
    surface : Surface
        The target, consistently oriented.
    initial : (n, 3)
        Initial guess, in the target's units.
    fit : Fit
    contracted : Contracted
    notes, warnings : tuple of str
        The automatic choices with their reasons, and what needs to be read.
    seconds : mapping
        start, solve, contract.
    """

    surface: Surface
    initial: Float[np.ndarray, "n 3"]
    fit: Fit
    contracted: Contracted
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: Mapping[str, float]

    @property
    def tessellation(self) -> Tessellation:
        """The pattern's topology."""
        return self.fit.tessellation


def fit_surface(
    surface: Surface,
    spec: FitSpec,
    progress: Callable[[Step], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> FitResult:
    """Fit a kirigami sheet to a surface.

    Parameters
    ----------
    surface : Surface
        A disk; it is oriented consistently first.
    spec : FitSpec
    progress : callable, optional
        Called with every accepted step of the solver.
    should_stop : callable, optional
        Asked after every step; where it says True, the best point so far is the result.

    Returns
    -------
    FitResult
        Its `fit.status` says how the solve ended; a solve that did not converge still gives its best point.

    Raises
    ------
    UnusableError
        Where the surface is not a disk, cannot be flattened, or is too narrow for the tiles asked for.
    ParameterError
        Where the solver does not suit the size of the problem.
    """
    clock = time.perf_counter
    began = clock()
    surface = require_disk(surface)
    start = make_start(surface, spec)
    started = clock()
    frame, scaled = unit_scale(surface, start.tessellation, start.points)
    limits = Limits(
        tolerance=min(spec.tolerance, 1e-11),
        max_steps=spec.max_steps if spec.max_steps is not None else Limits.max_steps,
        max_seconds=spec.max_seconds if spec.max_seconds is not None else Limits.max_seconds,
    )
    outcome, note = _solve(start.tessellation, frame.into(start.points), scaled, spec, limits, progress, should_stop)
    solved = clock()
    points = frozen(frame.back(outcome.points))
    fit = Fit(start.tessellation, points, frame.length, outcome.status, outcome.history)
    contracted = contract(start.tessellation, points)
    return FitResult(
        surface=surface,
        initial=frozen(start.points),
        fit=fit,
        contracted=contracted,
        notes=start.notes + note,
        warnings=start.warnings,
        seconds={"start": started - began, "solve": solved - started, "contract": clock() - solved},
    )


def _solve(
    tessellation: Tessellation,
    start: np.ndarray,
    target: Surface | Scaled,
    spec: FitSpec,
    limits: Limits,
    progress: Callable[[Step], None] | None,
    should_stop: Callable[[], bool] | None,
) -> tuple[Outcome, tuple[str, ...]]:
    """Solve, with stiffer weights where the first try does not converge; keep the best outcome."""
    closest = target if isinstance(target, Scaled) else ClosestPoints(target)
    exact = spec.closeness == "exact"
    solver = make_solver(spec.solver, limits)
    best: Outcome | None = None
    began = time.perf_counter()
    for attempt, weights in enumerate((Weights(), Weights(fairness=1e-1, proximity=1e-1), Weights(closeness=0.1))):
        formulation = Formulation(
            tessellation,
            start,
            closest,
            weights,
            exact=exact,
            margin=float(np.sin(np.radians(spec.min_angle))),
            smallest_edge=1.05 * spec.min_edge,
        )
        problem = formulation.problem_at(start)
        outcome = solver.solve(problem, start, formulation.problem_at, progress, should_stop)
        if best is None or _worst(outcome) < _worst(best):
            best = outcome
        if outcome.status in (Status.CONVERGED, Status.INTERRUPTED, Status.TIME_LIMIT) or spec.max_steps is not None:
            if attempt and outcome.status is Status.CONVERGED:
                return outcome, (f"Solve: converged at try {attempt + 1}, with a stiffer sheet (weights {weights}).",)
            return outcome, ()
        left = limits.max_seconds - (time.perf_counter() - began)
        solver = make_solver(spec.solver, replace(limits, max_seconds=left))
    assert best is not None
    return best, ()


def _worst(outcome: Outcome) -> float:
    """Smallest largest violation along the history: that of the point that was kept."""
    return min((max(step.residuals.values(), default=0.0) for step in outcome.history), default=np.inf)
