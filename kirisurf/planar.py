"""Fits of planar targets: the sheet lies in the plane, and its outer vertices exactly on an outline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.approaching import Approach
from kirisurf.continuation import Continuation
from kirisurf.contracted_shape import ContractedShape
from kirisurf.contracted_solution import laid_start
from kirisurf.following import followed
from kirisurf.formulation import Weights
from kirisurf.morphing import Morph
from kirisurf.outline_rows import FollowsOutline
from kirisurf.outlines import Outline
from kirisurf.prescribed import Prescribed
from kirisurf.problem import Problem, Term
from kirisurf.pulling import Formulate
from kirisurf.rim import Rim, cell_size, free_rim, rectangle_rim
from kirisurf.scaling import median_edge
from kirisurf.solvers.outcome import Outcome, Progress, ShouldStop
from kirisurf.states import Step
from kirisurf.status import Status
from kirisurf.tessellation import Tessellation
from kirisurf.two_states import Shape, TwoStates


@dataclass(frozen=True, eq=False)
class Planar:
    """A solved planar problem, with what is needed to solve it again with other wishes.

    Attributes
    ----------
    outcome : Outcome
        In tile edges, deployed points first.
    notes : tuple of str
    middle : (2,)
        Origin of the points, in the target's units.
    length : float
        Their unit.
    problem : callable
        Problem near points (q, 3), for weights and wishes.
    rim : Rim
    outline : Outline
        In the target's units.
    """

    outcome: Outcome
    notes: tuple[str, ...]
    middle: Float[np.ndarray, " 2"]
    length: float
    problem: Formulate
    rim: Rim
    outline: Outline

    @property
    def boundary(self) -> Prescribed:
        """The outline that the sheet follows, in the target's units."""
        return Prescribed(self.rim.vertices, self.rim.sides, self.outline)

    @property
    def local(self) -> Outline:
        """The outline in tile edges."""
        return self.outline.moved(-self.middle).scaled(1 / self.length)


def solve_rectangular(
    tessellation: Tessellation,
    outline: Outline,
    contracted: ContractedShape,
    shape: Callable[[float], Shape],
    continuation: Continuation,
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> Planar:
    """Bend the regular rectangular pattern into an outline with four sides (see :mod:`kirisurf.morphing`).

    Parameters
    ----------
    tessellation : Tessellation
        Its deployed layout is the regular pattern, upright.
    outline : Outline
        Bottom, right, top, left.
    contracted : ContractedShape
    shape : callable
        What is asked of tiles and openings, for the median tile edge of the sheet that a problem starts from.
    continuation : Continuation
    progress, should_stop : callables, optional
    """
    layout, middle = regular_layout(tessellation, outline)
    length = median_edge(tessellation, np.column_stack([layout, np.zeros(len(layout))]))
    local = outline.moved(-middle).scaled(1 / length)
    morph = Morph(tessellation, layout / length, local, contracted, shape(1.0))
    outcome, notes, problem = _reached(morph, shape, continuation, progress, should_stop)
    return Planar(outcome, notes, middle, length, problem, morph.rim, outline)


def _reached(
    way: Morph | Approach,
    shape: Callable[[float], Shape],
    continuation: Continuation,
    progress: Progress | None,
    should_stop: ShouldStop | None,
) -> tuple[Outcome, tuple[str, ...], Formulate]:
    """Follow a way, and at its end ask for edges by the sizes that they have there, not by those of the start.

    Where it cannot be followed with all outer vertices inside the outline, it is tried with the tips alone, and then
    without a tip in every corner.
    """
    most = None if continuation.in_stages else continuation.left().max_steps
    history: tuple[Step, ...] = ()
    for chosen, said in _ways(way):
        found, notes = followed(chosen, continuation.make_solver, continuation.left, most, progress, should_stop)
        history += found.history
        outcome = replace(found, history=history)
        way, notes = chosen, notes + said
        if found.status in _FINAL or not continuation.in_stages:
            break

    def problem(points: np.ndarray, weights: Weights, wishes: tuple[Term, ...]) -> Callable[[np.ndarray], Problem]:
        own = shape(median_edge(way.tessellation, points[: way.tessellation.n_vertices]))
        return replace(way, shape=own).at(points, 1.0, weights, wishes)

    if outcome.status is not Status.CONVERGED:
        return outcome, notes, problem

    def formulate(reference: np.ndarray, weights: Weights, guarded: bool) -> Callable[[np.ndarray], Problem]:
        return problem(reference, weights, ())

    outcome, more = continuation.recentered(outcome, formulate, progress, should_stop)
    return outcome, notes + more, problem


_FINAL = (Status.CONVERGED, Status.INTERRUPTED, Status.TIME_LIMIT)
_OUTSIDE = (
    "Solve: no sheet was found with every outer vertex inside the outline; some behind the tips may lie outside it."
)
_CORNERS = "Solve: no sheet was found with a tip in every corner of the outline."


def _ways(way: Morph | Approach) -> list[tuple[Morph | Approach, tuple[str, ...]]]:
    """A way and those that ask for less, with what is then said."""
    free = replace(way, inside=False)
    ways = [(way, ()), (free, (_OUTSIDE,))]
    if isinstance(free, Approach) and len(free.pinned):
        ways.append((replace(free, pinned=free.pinned[:0]), (_OUTSIDE, _CORNERS)))
    return ways


def regular_layout(
    tessellation: Tessellation, outline: Outline
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, " 2"]]:
    """Return the regular pattern about the origin, as large as an outline, and the outline's middle.

    The middle is that of the outline's area.
    """
    low, extent = tessellation.deployed.min(axis=0), np.ptp(tessellation.deployed, axis=0)
    scale = np.sqrt(outline.area / np.prod(extent))
    return scale * (tessellation.deployed - low - 0.5 * extent), np.asarray(outline.polygon.centroid.coords[0])


def solve_trimmed(
    tessellation: Tessellation,
    start: Float[np.ndarray, "n 3"],
    outline: Outline,
    shape: Callable[[float], Shape],
    continuation: Continuation,
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> Planar:
    """Move the tips of a trimmed pattern to an outline (see :mod:`kirisurf.approaching`).

    Parameters
    ----------
    tessellation : Tessellation
    start : (n, 3)
        The laid pattern, in the target's units, with z = 0.
    outline : Outline
    shape, continuation, progress, should_stop
        As for :func:`solve_rectangular`.
    """
    middle, length, local, points = _localized(tessellation, start, outline)
    flat = points[:, :2]
    rim = free_rim(tessellation, local.project(flat).distances, cell_size(tessellation, points), flat)
    pinned = nearest_to_corners(rim, flat, local)
    # the other side of a notch whose one side is in a corner has to leave it
    weld = tessellation.weld
    kept = ~np.isin(weld[rim.vertices], weld[pinned]) | np.isin(rim.vertices, pinned)
    rim = Rim(rim.vertices[kept], rim.sides[kept])
    laid = laid_start(tessellation, points, ContractedShape())
    approach = Approach(tessellation, laid, local, rim, pinned, shape(1.0))
    outcome, notes, problem = _reached(approach, shape, continuation, progress, should_stop)
    return Planar(outcome, notes, middle, length, problem, rim, outline)


def solve_laid(
    tessellation: Tessellation,
    start: Float[np.ndarray, "n 3"],
    outline: Outline,
    contracted: ContractedShape,
    shape: Callable[[float], Shape],
    continuation: Continuation,
    progress: Progress | None = None,
    should_stop: ShouldStop | None = None,
) -> Planar:
    """Solve a rectangular pattern from where it was laid on the inside of an outline.

    Parameters
    ----------
    tessellation : Tessellation
    start : (n, 3)
        The laid pattern, in the target's units, with z = 0.
    outline : Outline
        With four sides.
    contracted, shape, continuation, progress, should_stop
        As for :func:`solve_rectangular`.
    """
    middle, length, local, points = _localized(tessellation, start, outline)
    rim = rectangle_rim(tessellation.deployed)
    local, turns = facing(local, points[:, :2], rim)
    points = laid_start(tessellation, points, contracted)

    def problem(points: np.ndarray, weights: Weights, wishes: tuple[Term, ...]) -> Callable[[np.ndarray], Problem]:
        others = np.setdiff1d(tessellation.outline, rim.vertices)
        rows = (FollowsOutline("boundary", rim, others, local, points), *contracted.rows(tessellation))
        own = shape(median_edge(tessellation, points[: tessellation.n_vertices]))
        return TwoStates(tessellation, points, None, weights, own, rows, wishes).problem_at

    def formulate(reference: np.ndarray, weights: Weights, guarded: bool) -> Callable[[np.ndarray], Problem]:
        return problem(reference, weights, ())

    outcome, notes = continuation.solve(formulate, points, progress, should_stop)
    return Planar(outcome, notes, middle, length, problem, rim, outline.with_first_side(turns))


def _localized(
    tessellation: Tessellation, start: np.ndarray, outline: Outline
) -> tuple[np.ndarray, float, Outline, np.ndarray]:
    """The middle of an outline, the median tile edge, and outline and start in that frame."""
    middle = np.asarray(outline.polygon.centroid.coords[0])
    length = median_edge(tessellation, start)
    local = outline.moved(-middle).scaled(1 / length)
    return middle, length, local, (start - [middle[0], middle[1], 0.0]) / length


def facing(outline: Outline, points: Float[np.ndarray, "n 2"], rim: Rim) -> tuple[Outline, int]:
    """Return the outline with its sides numbered from another one, so that they face those of a rim."""
    apart = []
    for turn in range(4):
        turned = outline.with_first_side(turn)
        found = turned.project(points[rim.vertices], rim.sides)
        apart.append(float(np.linalg.norm(found.points - points[rim.vertices], axis=1).sum()))
    best = int(np.argmin(apart))
    return outline.with_first_side(best), best


def nearest_to_corners(rim: Rim, points: Float[np.ndarray, "n 2"], outline: Outline) -> np.ndarray:
    """Return the vertex of a rim for every corner of an outline, each the nearest one that is left."""
    chosen: list[int] = []
    for corner in outline.corners if not outline.is_smooth else np.zeros((0, 2)):
        apart = np.linalg.norm(points[rim.vertices] - corner, axis=1)
        apart[np.isin(rim.vertices, chosen)] = np.inf
        chosen.append(int(rim.vertices[int(apart.argmin())]))
    return np.array(chosen, dtype=np.int64)
