"""A fit again: from a start that is at hand, or a sheet that is, and watched while it goes.

A window that follows its user cannot wait for what did not change. Flattening and placing the pattern are half of a
small fit, and of a sheet that is a solution already, the solver needs a few steps when a bound moves.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.asked import MARGIN, needs_both_states, sufficiency
from kirisurf.cascade import Level, layouts, solve_cascade
from kirisurf.continuation import Continuation, Formulate
from kirisurf.contract import contract
from kirisurf.fit_result import FitResult
from kirisurf.formulation import Formulation, Weights
from kirisurf.ground import Ground
from kirisurf.layout import Layout
from kirisurf.one_thread import on_one_thread
from kirisurf.problem import Problem
from kirisurf.scaling import Frame, Scaled, median_edge, unit_scale
from kirisurf.solvers.choice import make_solver
from kirisurf.solvers.outcome import Limits, Outcome, Progress, ShouldStop
from kirisurf.soundness import are_sound
from kirisurf.spec import FitSpec
from kirisurf.start import Start
from kirisurf.states import Fit
from kirisurf.status import Status
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation

Watch = Callable[[Tessellation, np.ndarray], None]
"""Receives a pattern and where its vertices are (n, 3), in the target's units, as the solver goes."""


@dataclass(frozen=True, eq=False)
class Begun:
    """What a fit needs before its first step, and what stays the same while only its bounds change.

    Attributes
    ----------
    ground : Ground
        The target.
    start : Start
    frame : Frame
    scaled : Scaled
        Closest points of the target in the frame.
    """

    ground: Ground
    start: Start
    frame: Frame
    scaled: Scaled

    @classmethod
    def of(cls, ground: Ground, start: Start) -> Begun:
        """Return the beginning of a start."""
        return cls(ground, start, *unit_scale(ground.surface, start.tessellation, start.points, ground.closest))


def can_refit(surface: Surface, spec: FitSpec, start: Start) -> bool:
    """Whether `refit` solves this fit: a free sheet as near to a curved target as it gets, by the own solver.

    All others (planar targets, exact sheets, prescribed contracted shapes, openings, preferences, other solvers) are
    for :func:`kirisurf.pipeline.fit_surface`.
    """
    plain = spec.closeness == "best" and spec.solver in ("auto", "newton") and spec.max_steps is None
    plain = plain and spec.prefer == "balanced"
    return plain and surface.outline is None and not needs_both_states(start.tessellation, spec)


def is_direct(start: Start) -> bool:
    """Whether a fit from this start is one solve, instead of several from coarse to fine.

    A finer sheet is held near what the coarser one gave: going on from another sheet then leads to a neighbor of the
    solution, not to the same one.
    """
    return start.layout is None or len(layouts(start.layout)) == 1


@on_one_thread
def refit(
    begun: Begun,
    spec: FitSpec,
    points: Float[np.ndarray, "n 3"] | None = None,
    watch: Watch | None = None,
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> FitResult:
    """Solve the fit of a spec from what is at hand.

    Parameters
    ----------
    begun : Begun
        Made of the spec's start; one that `can_refit`.
    spec : FitSpec
    points : (n, 3), optional
        A sheet of the same pattern to go on from, in the target's units: a solution under other bounds, or the best
        point of a fit that was stopped. The problem is that of a fit from the start; where these points do not lead
        to a solution, the start gets its turn.
    watch : callable, optional
        Receives every point at which the solver renews its model of the target: all but the last, short steps.
    progress, should_stop : callables, optional
        As for :func:`kirisurf.pipeline.fit_surface`.

    Returns
    -------
    FitResult
        Without `points` the same as that of :func:`kirisurf.pipeline.fit_surface`.
    """
    clock = time.perf_counter
    began = clock()
    ground, start = begun.ground, begun.start
    limits = Limits(tolerance=float(np.clip(1e-2 * spec.tolerance, 1e-13, 1e-11)))

    def left() -> Limits:
        return limits if spec.max_seconds is None else replace(limits, max_seconds=spec.max_seconds - (clock() - began))

    formulate = _formulated(begun.frame, begun.scaled, start.tessellation, spec, watch)
    continuation = _continued(start.tessellation, spec, left)
    outcome: Outcome | None = None
    notes: tuple[str, ...] = ()
    # a fit that was stopped before it came to its finest level has only its start to show
    if points is not None and not np.array_equal(points, start.points):
        outcome, notes = _from_points(continuation, formulate, begun.frame, start.points, points, progress, should_stop)
    if outcome is None and start.layout is not None and spec.initial == "auto":
        below = [partial(_level, ground, layout, spec, left, watch) for layout in layouts(start.layout)[:0:-1]]
        finest = Level(start.layout, begun.frame, formulate, continuation)
        outcome, notes = solve_cascade(below, finest, progress, should_stop)
    elif outcome is None:
        outcome, notes = continuation.solve(formulate, begun.frame.into(start.points), progress, should_stop)
    ended = clock()
    found = begun.frame.back(outcome.points)
    fit = Fit(start.tessellation, frozen(found), begun.frame.length, outcome.status, outcome.history)
    contracted = contract(start.tessellation, fit.points)
    return FitResult(
        surface=ground.surface,
        initial=frozen(start.points),
        fit=fit,
        contracted=contracted,
        notes=start.notes + notes,
        warnings=start.warnings,
        seconds={"start": 0.0, "solve": ended - began, "contract": clock() - ended},
        feasibility=start.feasibility,
    )


def _from_points(
    continuation: Continuation,
    formulate: Formulate,
    frame: Frame,
    start: np.ndarray,
    points: np.ndarray,
    progress: Progress | None,
    should_stop: ShouldStop | None,
) -> tuple[Outcome | None, tuple[str, ...]]:
    """Solve from a sheet, held near the start as a fit from there is; None where that leads to no sound solution."""
    at, here = formulate(frame.into(start), Weights(), continuation.guarded), frame.into(points)
    outcome = continuation.make_solver(continuation.left()).solve(at(here), here, at, progress, should_stop)
    if outcome.status in (Status.INTERRUPTED, Status.TIME_LIMIT):
        return outcome, ()
    if outcome.status is not Status.CONVERGED or not continuation.sound(outcome.points):
        return None, ()
    outcome, notes = continuation.recentered(outcome, formulate, progress, should_stop)
    return outcome, ("Solve: from the sheet that was there before.", *notes)


def _level(ground: Ground, layout: Layout, spec: FitSpec, left: Callable[[], Limits], watch: Watch | None) -> Level:
    frame, scaled = unit_scale(ground.surface, layout.tessellation, layout.points, ground.closest)
    formulate = _formulated(frame, scaled, layout.tessellation, spec, watch)
    return Level(layout, frame, formulate, _continued(layout.tessellation, spec, left))


def _continued(tessellation: Tessellation, spec: FitSpec, left: Callable[[], Limits]) -> Continuation:
    enough, sound = partial(sufficiency, spec, tessellation), partial(are_sound, tessellation)
    return Continuation(partial(make_solver, spec.solver), left, enough, sound)


def _formulated(
    frame: Frame, scaled: Scaled, tessellation: Tessellation, spec: FitSpec, watch: Watch | None
) -> Formulate:
    """The problems of a fit; whoever watches is shown the points for which one is asked."""

    def formulate(reference: np.ndarray, weights: Weights, guarded: bool) -> Callable[[np.ndarray], Problem]:
        problem_at = Formulation(
            tessellation,
            reference,
            scaled,
            weights,
            margin=MARGIN * float(np.sin(np.radians(spec.min_angle))),
            smallest_edge=MARGIN * spec.min_edge * median_edge(tessellation, reference),
            guarded=guarded,
        ).problem_at
        if watch is None:
            return problem_at

        def watched(points: np.ndarray) -> Problem:
            watch(tessellation, frame.back(points))
            return problem_at(points)

        return watched

    return formulate
