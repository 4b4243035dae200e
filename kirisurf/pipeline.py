"""The main line: a surface and a spec in, a deployed and a contracted sheet out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.continuation import Continuation
from kirisurf.contract import contract
from kirisurf.fit import Contracted, Fit, Step
from kirisurf.formulation import Formulation, Weights
from kirisurf.problem import Problem
from kirisurf.scaling import unit_scale
from kirisurf.solvers.choice import make_solver
from kirisurf.solvers.outcome import Limits
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation
from kirisurf.topology import require_disk

EDGE_MARGIN = 1.05
"""The smallest edge is asked over the start's median edge; the finished sheet's may be a little larger."""


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

    def formulate(reference: np.ndarray, weights: Weights) -> Callable[[np.ndarray], Problem]:
        return Formulation(
            start.tessellation,
            reference,
            scaled,
            weights,
            exact=spec.closeness == "exact",
            margin=float(np.sin(np.radians(spec.min_angle))),
            smallest_edge=EDGE_MARGIN * spec.min_edge,
        ).problem_at

    continuation = Continuation(partial(make_solver, spec.solver), limits, in_stages=spec.max_steps is None)
    outcome, note = continuation.solve(formulate, frame.into(start.points), progress, should_stop)
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
