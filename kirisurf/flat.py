"""Fits of planar targets: the sheet lies in the plane, its outer vertices on an outline."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from kirisurf.asked import contracted_shape, shape_of, sufficiency
from kirisurf.continuation import Continuation
from kirisurf.contracted_solution import contracted_solution
from kirisurf.errors import ParameterError
from kirisurf.formulation import Weights
from kirisurf.freedom import freedom_of
from kirisurf.motion import motion_of
from kirisurf.outlines import Outline
from kirisurf.pattern import tile_pattern
from kirisurf.planar import Planar, regular_layout, solve_laid, solve_rectangular, solve_trimmed
from kirisurf.pulling import pulled
from kirisurf.solved import Solved
from kirisurf.solvers.choice import make_solver
from kirisurf.solvers.outcome import Limits, Progress, ShouldStop
from kirisurf.soundness import are_apart
from kirisurf.spec import FitSpec
from kirisurf.start import Laid, make_start
from kirisurf.surface import Surface
from kirisurf.trimming import rectangle_mask
from kirisurf.unit_cells.catalog import find_cell


def solve_flat(
    surface: Surface,
    spec: FitSpec,
    left: Callable[[], Limits],
    progress: Progress | None,
    should_stop: ShouldStop | None,
    laid: Laid | None = None,
) -> Solved:
    """Solve for a sheet whose outer vertices lie on the outline of a planar target.

    A rectangular pattern is bent into the outline, or with another start than `auto` solved from where it was laid;
    of a trimmed pattern the tips are moved to the outline.

    Raises
    ------
    UnusableError, ParameterError
        See :func:`kirisurf.pipeline.fit_surface`.
    """
    outline = surface.outline
    if not isinstance(outline, Outline):
        raise ParameterError(f"target: expected a planar outline, got {type(outline).__name__}")
    contracted, solver = contracted_shape(spec), partial(make_solver, spec.solver)
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    shape = partial(shape_of, spec)
    feasible = None
    if spec.cells is not None:
        outline, said = outline.four_sides()
        notes = (f"Placement: {said}",)
    if spec.cells is not None and spec.initial == "auto":
        cell = find_cell(spec.tessellation)
        tessellation = tile_pattern(cell, rectangle_mask(cell, motion_of(cell).adjacency, *spec.cells))
        layout, middle = regular_layout(tessellation, outline)
        initial = np.column_stack([layout + middle, np.zeros(len(layout))])
    else:
        start = make_start(surface, spec)
        if laid is not None:
            laid(start)
        tessellation, initial, feasible = start.tessellation, start.points, start.feasibility
        notes, warnings = notes + start.notes, start.warnings
    started = time.perf_counter()
    n = tessellation.n_vertices

    def enough(found: np.ndarray) -> float:
        return sufficiency(spec, tessellation, found[:n])

    def sound(found: np.ndarray) -> bool:
        deployed, flat = found[:n, :2], found[n + tessellation.weld, :2]
        return are_apart(tessellation, deployed) and are_apart(tessellation, flat)

    continuation = Continuation(solver, left, enough, sound, spec.max_steps is None)
    if spec.cells is None:
        planar = solve_trimmed(tessellation, initial, outline, shape, continuation, progress, should_stop)
    elif spec.initial == "auto":
        planar = solve_rectangular(tessellation, outline, contracted, shape, continuation, progress, should_stop)
    else:
        planar = solve_laid(tessellation, initial, outline, contracted, shape, continuation, progress, should_stop)
    outcome, more = pulled(
        planar.outcome,
        spec.prefer,
        tessellation,
        planar.local,
        planar.problem,
        solver,
        left,
        lambda found: enough(found) >= 1 and sound(found),
        progress,
        should_stop,
    )
    flat, prescribed = contracted_solution(tessellation, outcome.points, planar.length, contracted)
    return Solved(
        tessellation,
        initial,
        _deployed(planar, outcome.points[: tessellation.n_vertices]),
        planar.length,
        outcome,
        notes + planar.notes + more,
        warnings,
        started,
        feasible,
        planar.boundary,
        flat,
        prescribed,
        freedom_of(outcome, planar.problem(outcome.points, Weights(), ()), n),
    )


def _deployed(planar: Planar, points: np.ndarray) -> np.ndarray:
    """Deployed points in the target's units, exactly in the plane z = 0."""
    found = planar.length * points
    found[:, :2] += planar.middle
    found[:, 2] = 0.0
    return found
