"""Stability: where a sheet rests when it is let go, and what lies between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from kirisurf.deployment.branch import Branch
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Equilibrium, Minimizer
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import STIFFNESS, Loading, mean_opening
from kirisurf.deployment.minimum import Minimum, distance, is_same, minimum_of, rest_from
from kirisurf.deployment.passes import find_passes
from kirisurf.deployment.path import STRAINLESS, Path, ShouldStop, jumps

RELEASES = 4
"""States, evenly along a path, from which a sheet is let go besides both ends and the path's own minima."""

SLIGHT = 1e-6
"""Height, over the highest energy of the path, up to which there is nothing between two minima."""

LEADS = 0.99
"""Part of the shape's opening from which on a path leads to the shape."""

NEARBY = 0.25
"""Distance in tile edges up to which a path comes near a state, beside half of its own step there."""


@dataclass(frozen=True, eq=False)
class Barrier:
    """What lies between two neighboring minima.

    Attributes
    ----------
    below : int
        Number of the more closed of the two, among all minima.
    energy : float
        At the top.
    fraction : float
        Mean opening there over that of the deployed sheet.
    closing, opening : float
        Height over the more open minimum, and over the more closed one.
    is_saddle : bool
        The top is a point where nothing pulls and one direction leads down: no lower way passes near it. Elsewhere
        the height is that along the path, which another way may undercut.
    """

    below: int
    energy: float
    fraction: float
    closing: float
    opening: float
    is_saddle: bool


def find_minima(
    energy: Energy,
    guide: Guide,
    path: Path,
    should_stop: ShouldStop | None = None,
    branches: Sequence[Branch] = (),
) -> tuple[Minimum, ...]:
    """Return the stable states that a sheet falls into when it is let go along a path, by growing opening.

    Where nothing costs energy along a path that leads to the shape, and slits have no springs, both ends are returned.
    Those that lie on branches at the path's jumps are among them.
    """
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed), toward=guide.deployed - guide.flat)
    values = path.energies
    leads = mean_opening(energy, path.points[-1]) >= LEADS * mean_opening(energy, guide.deployed)
    if energy.torsion == 0 and values.max() <= STRAINLESS and leads:
        # it rests wherever it is left
        return tuple(
            minimum_of(energy, guide, end, flat) for end, flat in ((guide.flat, True), (guide.deployed, False))
        )
    inner = 1 + np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:]))
    evenly = np.linspace(0, len(values) - 1, RELEASES + 2).round().astype(int)
    known = [state.points for branch in branches for state in branch.stationary if state.n_negative == 0]
    highest = float(values.max())
    found: list[Minimum] = []
    for start in (guide.flat, *path.points[np.unique(np.r_[inner, evenly])], guide.deployed, *known):
        if should_stop is not None and should_stop():
            break
        new = rest_from(minimizer, guide, start, highest)
        if new is not None and not any(is_same(new, old, energy.length) for old in found):
            found.append(new)
    return _apart(energy, path, sorted(found, key=lambda minimum: minimum.opening))


def find_barriers(
    energy: Energy,
    guide: Guide,
    path: Path,
    minima: tuple[Minimum, ...],
    branches: Sequence[Branch] = (),
    should_stop: ShouldStop | None = None,
) -> tuple[Barrier, ...]:
    """Return the barriers between neighboring minima: the highest point of the path between them.

    On the free path of a planar sheet it is then moved to where the load on the opening vanishes, which is a saddle.
    Where the path jumps, the lowest saddle on its branches takes its place from which the sheet, let go on both sides,
    comes to rest in the two minima. Where nothing costs energy along the path there are none, and none are known where
    it does not come near both and no branch has such a saddle.
    """
    if path.energies.max(initial=0.0) <= STRAINLESS:
        return ()
    last = mean_opening(energy, guide.deployed)
    openings = np.array([mean_opening(energy, points) for points in path.points])
    highest = float(path.energies.max())
    # before it jumps, the sheet comes to the fold, which is higher than the states next to it
    folding = [branch for branch in branches if branch.folds]
    limit = max([highest, *(state.energy for branch in folding for state in branch.states[: branch.first_turn])])
    leaps = jumps(energy, guide, path)
    passes = find_passes(energy, guide, branches, minima, limit, should_stop)
    barriers = []
    for number, (closed, opened) in enumerate(pairwise(minima)):
        floor = max(closed.energy, opened.energy)
        points, height, is_saddle = guide.flat, np.inf, False
        top = _top(energy, path, openings, closed, opened)
        if top is not None and path.energies[top] > floor + SLIGHT * highest:
            points, height = path.points[top], float(path.energies[top])
            if path.drive == "free" and energy.dimension == 2 and 0 < top < len(openings) - 1:
                refined = _saddle(energy, guide, path, openings, top)
                # on the other side of a jump there may be another saddle, which does not part these two
                if refined is not None and refined.energy > floor:
                    points, height, is_saddle = refined.points, refined.energy, True
        inside = [row for row in leaps if openings[row + 1] > closed.opening and openings[row] < opened.opening]
        # the path itself bounds what it is smooth over
        bound = limit if inside and not is_saddle else min(height, limit)
        lower = [state for state in passes.get(number, ()) if floor < state.energy <= bound]
        if lower:
            best = min(lower, key=lambda state: state.energy)
            points, height, is_saddle = best.points, best.energy, True
        if height < np.inf:
            at = mean_opening(energy, points) / last
            barriers.append(Barrier(number, height, at, height - opened.energy, height - closed.energy, is_saddle))
    return tuple(barriers)


def _apart(energy: Energy, path: Path, minima: list[Minimum]) -> tuple[Minimum, ...]:
    """Minima with something between: of two at one height on one flat stretch of the path the more open one.

    What the path does not come near it says nothing of.
    """
    openings = np.array([mean_opening(energy, points) for points in path.points])
    least = SLIGHT * float(path.energies.max())
    kept: list[Minimum] = []
    for minimum in minima:
        if kept and abs(minimum.energy - kept[-1].energy) <= least:
            top = _top(energy, path, openings, kept[-1], minimum)
            if top is not None and path.energies[top] <= max(kept[-1].energy, minimum.energy) + least:
                if not kept[-1].is_flat:
                    kept[-1] = minimum
                continue
        kept.append(minimum)
    return tuple(kept)


def _top(energy: Energy, path: Path, openings: np.ndarray, closed: Minimum, opened: Minimum) -> int | None:
    """The highest state of a path between two minima; None where it does not come near both."""
    for minimum in (closed, opened):
        nearest = int(np.abs(openings - minimum.opening).argmin())
        if distance(minimum.points, path.points[nearest], energy.length) > NEARBY + 0.5 * path.moves[nearest]:
            return None
    between = np.flatnonzero((openings > closed.opening) & (openings < opened.opening))
    return int(between[path.energies[between].argmax()]) if len(between) else None


def _saddle(energy: Energy, guide: Guide, path: Path, openings: np.ndarray, top: int) -> Equilibrium | None:
    """The saddle between the neighbors of the highest state, where the load on the opening changes its sign."""
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed), toward=guide.deployed - guide.flat)
    found = [minimizer.solve(path.points[top], Loading(opening=openings[top]))]

    def load(asked: float) -> float:
        found[0] = minimizer.solve(found[0].points, Loading(opening=asked))
        return STIFFNESS * (asked - mean_opening(energy, found[0].points))

    ends = float(openings[top - 1]), float(openings[top + 1])
    # asked again, an end next to a jump may give another answer
    known = {end: load(end) for end in ends}
    if not known[ends[0]] > 0 > known[ends[1]]:
        return None
    load(openings[top])
    load(brentq(lambda asked: known[asked] if asked in known else load(asked), *ends, xtol=1e-13, rtol=1e-13))
    return found[0] if minimizer.is_saddle(found[0].points) else None
