"""The main line: a target and a spec in, a deployed and a contracted sheet out."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.contract import contract
from kirisurf.curved import solve_curved
from kirisurf.errors import LimitError
from kirisurf.fit_result import FitResult
from kirisurf.flat import solve_flat
from kirisurf.one_thread import on_one_thread
from kirisurf.quadric_blend import QuadricBlend
from kirisurf.shortfalls import shortfalls
from kirisurf.solved import Solved
from kirisurf.solvers.choice import default_steps
from kirisurf.solvers.outcome import Limits
from kirisurf.spec import FitSpec
from kirisurf.start import Laid
from kirisurf.states import Fit, Step
from kirisurf.status import Status
from kirisurf.surface import Surface
from kirisurf.topology import require_disk
from kirisurf.unit_cells.catalog import find_cell

BYTES_PER_TILE = 115_000
"""Peak memory of a solve over its tiles: 109 kB measured at 128x128 quad tiles, 112 kB at 256x256."""

_FOUND = (Status.CONVERGED, Status.INTERRUPTED, Status.TIME_LIMIT)
_TOO_EXACT = (
    "Exact: no sheet was found that is rigid and has every vertex on the surface. Flat tiles with all corners on a "
    "curved surface have hardly more freedom than along the outline, whatever their size, so that patterns of more "
    "than about 12x12 tiles seldom succeed: ask for fewer cells, or for the closest rigid sheet (--closeness best)."
)


@on_one_thread
def fit_surface(
    surface: Surface,
    spec: FitSpec,
    progress: Callable[[Step], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
    laid: Laid | None = None,
) -> FitResult:
    """Fit a kirigami sheet to a surface, or to the inside of a planar outline.

    Parameters
    ----------
    surface : Surface
        A disk; it is oriented consistently first. One with an outline is a planar target.
    spec : FitSpec
    progress : callable, optional
        Called with every accepted step of the solver.
    should_stop : callable, optional
        Asked after every step; where it says True, the best point so far is the result.
    laid : callable, optional
        Called with the start before the solve, where a pattern is laid on the target.

    Returns
    -------
    FitResult
        Its `fit.status` says how the solve ended; a solve that did not converge still gives its best point.

    Raises
    ------
    UnusableError
        Where the surface is not a disk, cannot be flattened, or is too narrow for the tiles asked for.
    ParameterError
        Where the solver does not suit the size of the problem, or options do not go together.
    """
    clock = time.perf_counter
    began = clock()
    require_memory(spec)
    surface = require_disk(surface)
    notes: tuple[str, ...] = ()
    if spec.closeness == "exact" and surface.smooth is None and surface.outline is None:
        surface = replace(surface, smooth=QuadricBlend(surface))
        notes = (f"Exact: the target of every vertex is the smooth surface of {QuadricBlend.formula}.",)
    limits = Limits(
        # two digits below what is promised, for the rounding of contraction and files
        tolerance=float(np.clip(1e-2 * spec.tolerance, 1e-13, 1e-11)),
        max_steps=spec.max_steps if spec.max_steps is not None else default_steps(spec.solver),
    )

    def left() -> Limits:
        """The limits with the time that is left now."""
        return limits if spec.max_seconds is None else replace(limits, max_seconds=spec.max_seconds - (clock() - began))

    solve = solve_curved if surface.outline is None else solve_flat
    solved = solve(surface, spec, left, progress, should_stop, laid)
    ended = clock()
    fit = Fit(solved.tessellation, frozen(solved.points), solved.edge_length, solved.outcome.status, solved.history)
    contracted = contract(solved.tessellation, fit.points, like=solved.contracted)
    warnings = solved.warnings
    if spec.closeness == "exact" and surface.outline is None and fit.status not in _FOUND:
        warnings += (_TOO_EXACT,)
    prescribed = None if solved.prescribed is None else solved.prescribed(contracted.points)
    if fit.status is Status.CONVERGED:
        edge = solved.edge_length
        warnings += shortfalls(spec, fit.tessellation, fit.points, contracted.points, edge, solved.boundary, prescribed)
    return FitResult(
        surface=surface,
        initial=frozen(solved.initial),
        fit=fit,
        contracted=contracted,
        notes=notes + _said(solved) + solved.notes,
        warnings=warnings,
        seconds={
            "start": solved.started - began,
            "solve": ended - solved.started,
            "contract": clock() - ended,
        },
        feasibility=solved.feasibility,
        boundary=solved.boundary,
        contracted_boundary=prescribed,
        freedom=solved.freedom,
    )


def _said(solved: Solved) -> tuple[str, ...]:
    """What was known before the solve, and what is left open after it."""
    before = (
        () if solved.feasibility is None else (f"{solved.feasibility.sentence} {solved.feasibility.advice}".strip(),)
    )
    if solved.freedom is None:
        return before
    return *before, (
        f"Freedom: the sheet can change in {solved.freedom} ways to first order without breaking a row (rigid motions "
        "not counted); --prefer chooses among them."
    )


def require_memory(spec: FitSpec) -> None:
    """Refuse a pattern whose solve would not fit into the memory that is free now.

    Raises
    ------
    LimitError
        With the number of tiles that would fit.
    """
    each = len(find_cell(spec.tessellation).tiles) if spec.cells is not None else 1
    tiles = each * spec.cells[0] * spec.cells[1] if spec.cells is not None else spec.tiles or 0
    free = _free_memory()
    if free is not None and tiles * BYTES_PER_TILE > free:
        raise LimitError(
            f"memory: expected at most about {free // BYTES_PER_TILE} tiles for the {free / 1e9:.1f} GB that are free, "
            f"got {tiles}; ask for fewer (--tiles, --cells)"
        )


def _free_memory() -> int | None:
    """Bytes that a new program could have; None where the system does not say."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        # what Linux keeps of files it gives back: of the pages that are free, a machine that has run for long has few
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return 1024 * int(line.split()[1])
    try:
        return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return None
