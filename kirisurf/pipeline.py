"""The main line: a surface and a spec in, a deployed and a contracted sheet out."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.cascade import Level, layouts, solve_cascade
from kirisurf.continuation import Continuation, Formulate
from kirisurf.contract import contract
from kirisurf.errors import LimitError
from kirisurf.formulation import Formulation, Weights
from kirisurf.layout import Layout
from kirisurf.problem import Problem
from kirisurf.quadric_blend import QuadricBlend
from kirisurf.scaling import Frame, median_edge, unit_scale
from kirisurf.sizes import slit_openings, tile_edges
from kirisurf.solvers.choice import default_steps, make_solver
from kirisurf.solvers.outcome import Limits
from kirisurf.soundness import are_sound
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from kirisurf.states import Contracted, Fit, Step
from kirisurf.status import Status
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation
from kirisurf.topology import require_disk

MARGIN = 1.1
"""Smallest edges and openings are asked of the solver with this factor, since it measures them by the sizes of
the start, and the certificate by those of the finished sheet."""

BYTES_PER_TILE = 115_000
"""Peak memory of a solve over its tiles: 109 kB measured at 128x128 tiles, 112 kB at 256x256."""


_FOUND = (Status.CONVERGED, Status.INTERRUPTED, Status.TIME_LIMIT)
_TOO_EXACT = (
    "Exact: no sheet was found that is rigid and has every vertex on the surface. Flat tiles with all corners on a "
    "curved surface have hardly more freedom than along the outline, whatever their size, so that patterns of more "
    "than about 12x12 tiles seldom succeed: ask for fewer cells, or for the closest rigid sheet (--closeness best)."
)


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
    require_memory(spec)
    surface = require_disk(surface)
    notes: tuple[str, ...] = ()
    if spec.closeness == "exact" and surface.smooth is None:
        surface = replace(surface, smooth=QuadricBlend(surface))
        notes = (f"Exact: the target of every vertex is the smooth surface of {QuadricBlend.formula}.",)
    start = make_start(surface, spec)
    started = clock()
    limits = Limits(
        # two digits below what is promised, for the rounding of contraction and files
        tolerance=float(np.clip(1e-2 * spec.tolerance, 1e-13, 1e-11)),
        max_steps=spec.max_steps if spec.max_steps is not None else default_steps(spec.solver),
    )

    def left() -> Limits:
        """The limits with the time that is left now."""
        return limits if spec.max_seconds is None else replace(limits, max_seconds=spec.max_seconds - (clock() - began))

    if start.layout is not None and spec.initial == "auto" and spec.closeness == "best" and _is_free(spec):
        below = [partial(_level, surface, layout, spec, left) for layout in layouts(start.layout)[:0:-1]]
        finest = _level(surface, start.layout, spec, left)
        frame = finest.frame
        outcome, note = solve_cascade(below, finest, progress, should_stop)
    else:
        frame, formulate, continuation = _formulated(surface, start.tessellation, start.points, spec, left)
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
        notes=notes + start.notes + note,
        warnings=start.warnings + (() if spec.closeness == "best" or fit.status in _FOUND else (_TOO_EXACT,)),
        seconds={"start": started - began, "solve": solved - started, "contract": clock() - solved},
    )


def _is_free(spec: FitSpec) -> bool:
    """May the solve choose its own way? Not where the user limits its steps, or names a solver to compare with."""
    return spec.max_steps is None and spec.solver in ("auto", "newton")


def _level(surface: Surface, layout: Layout, spec: FitSpec, left: Callable[[], Limits]) -> Level:
    return Level(layout, *_formulated(surface, layout.tessellation, layout.points, spec, left))


def _formulated(
    surface: Surface, tessellation: Tessellation, points: np.ndarray, spec: FitSpec, left: Callable[[], Limits]
) -> tuple[Frame, Formulate, Continuation]:
    """The frame of a start (n, 3), its problems, and the way they are solved."""
    frame, scaled = unit_scale(surface, tessellation, points)

    def formulate(reference: np.ndarray, weights: Weights, guarded: bool) -> Callable[[np.ndarray], Problem]:
        return Formulation(
            tessellation,
            reference,
            scaled,
            weights,
            exact=spec.closeness == "exact",
            margin=MARGIN * float(np.sin(np.radians(spec.min_angle))),
            smallest_edge=MARGIN * spec.min_edge * median_edge(tessellation, reference),
            guarded=guarded,
        ).problem_at

    def sufficiency(points: np.ndarray) -> float:
        edges = tile_edges(tessellation, points)
        least = slit_openings(tessellation, points).min(initial=np.pi)
        opening = least / np.radians(spec.min_angle) if spec.min_angle > 0 else np.inf
        edge = edges.min() / np.median(edges) / spec.min_edge if spec.min_edge > 0 else np.inf
        return float(min(opening, edge))

    sound = partial(are_sound, tessellation)
    solver = partial(make_solver, spec.solver)
    return frame, formulate, Continuation(solver, left, sufficiency, sound, spec.max_steps is None)


def require_memory(spec: FitSpec) -> None:
    """Refuse a pattern whose solve would not fit into the memory that is free now.

    Raises
    ------
    LimitError
        With the number of tiles that would fit.
    """
    tiles = 4 * spec.cells[0] * spec.cells[1] if spec.cells is not None else spec.tiles or 0
    try:
        free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return
    if tiles * BYTES_PER_TILE > free:
        raise LimitError(
            f"memory: expected at most about {free // BYTES_PER_TILE} tiles for the {free / 1e9:.1f} GB that are free, "
            f"got {tiles}; ask for fewer (--tiles, --cells)"
        )
