"""From coarse to fine: a fine sheet starts from what a coarser one needed.

A sheet of a few hundred tiles is solved directly. For a finer one the solution is carried over (see
`kirisurf.prolongation`), twice as fine each time; it is then also what the sheet is held near, instead of the
regular pattern. Measured on peaks: 5 and 6 steps at 32x32 and 64x64 tiles instead of 15 and 40.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kirisurf.continuation import Continuation, Formulate
from kirisurf.formulation import Weights
from kirisurf.layout import Layout
from kirisurf.prolongation import prolonged
from kirisurf.scaling import Frame
from kirisurf.solvers.outcome import Outcome, Progress, ShouldStop
from kirisurf.states import Step
from kirisurf.status import Status

FEW = 500
"""Tiles that are solved directly: below, the outline is too ragged to say much about a finer one."""

ROUGH = 1e-4, 1e-3
"""Largest equality row and optimality of the coarser levels: they are starts, not sheets."""

FINE_STEPS = 50
"""Most steps of a solve that starts from a coarser one; where they do not do, the plain start gets its turn."""


@dataclass(frozen=True, eq=False)
class Level:
    """One resolution of a fit.

    Attributes
    ----------
    layout : Layout
    frame : Frame
        Its unit is the tile edge of this level.
    formulate : callable
        Problems of this level.
    continuation : Continuation
    """

    layout: Layout
    frame: Frame
    formulate: Formulate
    continuation: Continuation

    @property
    def start(self) -> np.ndarray:
        """The regular pattern (n, 3), in tile edges."""
        return self.frame.into(self.layout.points)


def layouts(finest: Layout) -> tuple[Layout, ...]:
    """Return the layouts of a cascade, the finest first."""
    found = [finest]
    while found[-1].tessellation.n_tiles > FEW:
        coarser = found[-1].coarser()
        if coarser is None:
            break
        found.append(coarser)
    return tuple(found)


def solve_cascade(
    coarser: Sequence[Callable[[], Level]],
    finest: Level,
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> tuple[Outcome, tuple[str, ...]]:
    """Solve level after level.

    Parameters
    ----------
    coarser : sequence of callables
        Make the levels below the finest, the coarsest first; called when their turn comes.
    finest : Level
    progress, should_stop : callables, optional

    Returns
    -------
    Outcome
        Of the finest level, with the steps that were taken there.
    tuple of str
        Sentences on how it was reached.
    """
    before: tuple[Level, np.ndarray] | None = None
    steps = []
    for level in (*(_rough(make()) for make in coarser), finest):
        outcome, notes = _solve_level(level, before, progress, should_stop)
        if outcome.status in (Status.INTERRUPTED, Status.TIME_LIMIT) and level is not finest:
            # nothing of the finest sheet is there yet but its start
            return Outcome(finest.start, outcome.status, ()), notes
        good = outcome.status is Status.CONVERGED
        before = (level, (outcome.points - level.start) * level.frame.length) if good else None
        steps.append(f"{level.layout.tessellation.n_tiles} tiles in {max(0, len(outcome.history) - 1)} steps")
    if coarser:
        notes = (f"Solve: from coarse to fine, {', '.join(steps)}.", *notes)
    return outcome, notes


def _rough(level: Level) -> Level:
    tolerance, optimality = ROUGH
    left = level.continuation.left
    rough = replace(level.continuation, left=lambda: replace(left(), tolerance=tolerance, optimality=optimality))
    return replace(level, continuation=rough)


def _solve_level(
    level: Level, before: tuple[Level, np.ndarray] | None, progress: Progress | None, should_stop: ShouldStop | None
) -> tuple[Outcome, tuple[str, ...]]:
    continuation = level.continuation
    if before is None:
        return continuation.solve(level.formulate, level.start, progress, should_stop)
    coarse, displacements = before
    start = level.start + prolonged(coarse.layout, displacements, level.layout) / level.frame.length
    history: tuple[Step, ...] = ()
    for guarded in (False, True):
        limits = replace(continuation.left(), max_steps=FINE_STEPS)
        at = level.formulate(start, Weights(), guarded)
        outcome = continuation.make_solver(limits).solve(at(start), start, at, progress, should_stop)
        history += outcome.history
        outcome = replace(outcome, history=history)
        if outcome.status in (Status.INTERRUPTED, Status.TIME_LIMIT):
            return outcome, ()
        if outcome.status is not Status.CONVERGED:
            break
        if continuation.sound(outcome.points):
            chosen = replace(continuation, guarded=guarded)
            return chosen.recentered(outcome, level.formulate, progress, should_stop)
    again, notes = continuation.solve(level.formulate, level.start, progress, should_stop)
    tried = "Solve: the start from the coarser sheet did not lead to a solution; the regular pattern was tried."
    return replace(again, history=history + again.history), (tried, *notes)
