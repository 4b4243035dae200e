"""Fits of curved targets: a sheet near a surface, from one layout or from coarse to fine."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from kirisurf.asked import MARGIN, contracted_shape, needs_both_states, shape_of, sufficiency
from kirisurf.cascade import Level, layouts, solve_cascade
from kirisurf.continuation import Continuation, Formulate
from kirisurf.contracted_shape import ContractedShape
from kirisurf.contracted_solution import contracted_solution, laid_start
from kirisurf.crossing import tiles_cross
from kirisurf.formulation import Formulation, Weights
from kirisurf.freedom import freedom_of
from kirisurf.ground import Ground
from kirisurf.layout import Layout
from kirisurf.problem import Problem, Term
from kirisurf.pulling import pulled
from kirisurf.scaling import Frame, Scaled, median_edge, unit_scale
from kirisurf.solved import Solved
from kirisurf.solvers.choice import make_solver
from kirisurf.solvers.outcome import Limits, Outcome, Progress, ShouldStop
from kirisurf.soundness import are_apart, are_facing, are_sound
from kirisurf.spec import FitSpec
from kirisurf.start import Laid, Start, make_start
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation
from kirisurf.two_states import TwoStates

EVEN = 0.1
"""Weight of fairness in a solve with guards."""


def solve_curved(
    surface: Surface,
    spec: FitSpec,
    left: Callable[[], Limits],
    progress: Progress | None,
    should_stop: ShouldStop | None,
    laid: Laid | None = None,
) -> Solved:
    """Solve for the sheet nearest to a surface.

    Raises
    ------
    UnusableError, ParameterError
        See :func:`kirisurf.pipeline.fit_surface`.
    """
    contracted = contracted_shape(spec)
    ground = Ground(surface)
    start = make_start(surface, spec, ground)
    if laid is not None:
        laid(start)
    started = time.perf_counter()
    if needs_both_states(start.tessellation, spec):
        return _both_states(ground, spec, start, contracted, left, started, progress, should_stop)
    if start.layout is not None and spec.initial == "auto" and spec.closeness == "best" and _is_free(spec):
        below = [partial(_level, ground, layout, spec, left) for layout in layouts(start.layout)[:0:-1]]
        finest = _level(ground, start.layout, spec, left)
        frame, formulate = finest.frame, finest.formulate
        outcome, notes = solve_cascade(below, finest, progress, should_stop)
    else:
        frame, formulate, continuation = _formulated(ground, start.tessellation, start.points, spec, left)
        outcome, notes = continuation.solve(formulate, frame.into(start.points), progress, should_stop)
    target = Scaled(ground.closest, frame)
    outcome, more = _pulled(outcome, target, start.tessellation, spec, left, progress, should_stop)
    return Solved(
        start.tessellation,
        start.points,
        frame.back(outcome.points),
        frame.length,
        outcome,
        start.notes + notes + more,
        start.warnings,
        started,
        start.feasibility,
        freedom=freedom_of(outcome, formulate(outcome.points, Weights(), False), start.tessellation.n_vertices),
    )


def _is_free(spec: FitSpec) -> bool:
    """May the solve choose its own way? Not where the user limits its steps, or names a solver to compare with."""
    return spec.max_steps is None and spec.solver in ("auto", "newton")


def _level(ground: Ground, layout: Layout, spec: FitSpec, left: Callable[[], Limits]) -> Level:
    return Level(layout, *_formulated(ground, layout.tessellation, layout.points, spec, left))


def _formulated(
    ground: Ground, tessellation: Tessellation, points: np.ndarray, spec: FitSpec, left: Callable[[], Limits]
) -> tuple[Frame, Formulate, Continuation]:
    """The frame of a start (n, 3), its problems, and the way they are solved."""
    frame, scaled = unit_scale(ground.surface, tessellation, points, ground.closest)

    def formulate(reference: np.ndarray, weights: Weights, guarded: bool) -> Callable[[np.ndarray], Problem]:
        return _problem(tessellation, scaled, spec, reference, weights, (), guarded)

    enough = partial(sufficiency, spec, tessellation)
    sound = partial(are_sound, tessellation)
    solver = partial(make_solver, spec.solver)
    return frame, formulate, Continuation(solver, left, enough, sound, spec.max_steps is None)


def _problem(
    tessellation: Tessellation,
    target: Scaled,
    spec: FitSpec,
    reference: np.ndarray,
    weights: Weights,
    wishes: tuple[Term, ...],
    guarded: bool = False,
) -> Callable[[np.ndarray], Problem]:
    """The problem near a sheet (n, 3), as a function of where the target is modeled."""
    return Formulation(
        tessellation,
        reference,
        target,
        weights,
        exact=spec.closeness == "exact",
        margin=MARGIN * float(np.sin(np.radians(spec.min_angle))),
        smallest_edge=MARGIN * spec.min_edge * median_edge(tessellation, reference),
        guarded=guarded,
        wishes=wishes,
    ).problem_at


def _pulled(
    outcome: Outcome,
    target: Scaled,
    tessellation: Tessellation,
    spec: FitSpec,
    left: Callable[[], Limits],
    progress: Progress | None,
    should_stop: ShouldStop | None,
) -> tuple[Outcome, tuple[str, ...]]:
    """Pull a solved sheet towards the preference, where there is one."""
    return pulled(
        outcome,
        spec.prefer,
        tessellation,
        target,
        partial(_problem, tessellation, target, spec),
        partial(make_solver, spec.solver),
        left,
        lambda found: sufficiency(spec, tessellation, found) >= 1 and are_sound(tessellation, found),
        progress,
        should_stop,
    )


def _both_states(
    ground: Ground,
    spec: FitSpec,
    start: Start,
    contracted: ContractedShape,
    left: Callable[[], Limits],
    started: float,
    progress: Progress | None,
    should_stop: ShouldStop | None,
) -> Solved:
    """Solve with the contracted points as unknowns."""
    tessellation, n = start.tessellation, start.tessellation.n_vertices
    frame, scaled = unit_scale(ground.surface, tessellation, start.points, ground.closest)
    points = laid_start(tessellation, frame.into(start.points), contracted)

    def problem(
        reference: np.ndarray, weights: Weights, wishes: tuple[Term, ...], guarded: bool = False
    ) -> Callable[[np.ndarray], Problem]:
        return TwoStates(
            tessellation,
            reference,
            scaled,
            weights,
            shape_of(spec, median_edge(tessellation, reference[:n])),
            contracted.rows(tessellation),
            wishes,
            spec.closeness == "exact",
            guarded,
        ).problem_at

    def formulate(reference: np.ndarray, weights: Weights, guarded: bool) -> Callable[[np.ndarray], Problem]:
        # rows do not keep tiles across a bay of the rim apart; more even tiles do
        fairness = max(weights.fairness, EVEN) if guarded else weights.fairness
        return problem(reference, replace(weights, fairness=fairness), (), guarded)

    def sound(found: np.ndarray) -> bool:
        flat = found[n + tessellation.weld, :2]
        return (
            are_facing(tessellation, found[:n])
            and not tiles_cross(tessellation, found[:n])
            and are_apart(tessellation, flat)
        )

    solver = partial(make_solver, spec.solver)

    def enough(found: np.ndarray) -> float:
        return sufficiency(spec, tessellation, found[:n])

    continuation = Continuation(solver, left, enough, sound, spec.max_steps is None)
    outcome, notes = continuation.solve(formulate, points, progress, should_stop)
    outcome, more = pulled(
        outcome,
        spec.prefer,
        tessellation,
        scaled,
        problem,
        solver,
        left,
        lambda found: enough(found) >= 1 and sound(found),
        progress,
        should_stop,
    )
    laid, prescribed = contracted_solution(tessellation, outcome.points, frame.length, contracted)
    return Solved(
        tessellation,
        start.points,
        frame.back(outcome.points[:n]),
        frame.length,
        outcome,
        start.notes + notes + more,
        start.warnings,
        started,
        start.feasibility,
        None,
        laid,
        prescribed,
        freedom_of(outcome, problem(outcome.points, Weights(), ()), n),
    )
