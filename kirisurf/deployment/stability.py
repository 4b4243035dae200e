"""Stability: where a sheet rests when it is let go, and what lies between."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.optimize import brentq

from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Equilibrium, Minimizer
from kirisurf.deployment.guide import Guide, nearest_place
from kirisurf.deployment.loading import STIFFNESS, Loading, mean_opening
from kirisurf.deployment.path import STRAINLESS, Path, ShouldStop

RELEASES = 4
"""States, evenly along a path, from which a sheet is let go besides both ends and the path's own minima."""

SAME_OPENING, SAME_PLACE = 0.01, 0.05
"""Two states are one if mean openings (radians) and vertices (root mean square, tile edges) agree so far."""

FLAT = 0.02
"""Mean opening in radians below which a sheet is flat: in space its last way home is soft, and not gone to the end."""

NEARLY_NONE = 1e-4
"""Energy, over the highest of the path, below which a sheet whose slits are springs is on its way to the flat state."""

SLIGHT = 1e-6
"""Height, over the highest energy of the path, up to which there is nothing between two minima."""

RELAX_STEPS = 300
LEADS = 0.99
"""Part of the shape's opening from which on a path leads to the shape."""

NEARBY = 0.25
"""Distance in tile edges up to which a path comes near a state, beside half of its own step there."""


@dataclass(frozen=True, eq=False)
class Minimum:
    """A state in which a sheet rests by itself.

    Attributes
    ----------
    points : (n, d)
    energy : float
    opening : float, radians
        Mean opening.
    fraction : float
        The same over that of the deployed sheet.
    largest_strain : float
    is_flat : bool
    """

    points: Float[np.ndarray, "n d"]
    energy: float
    opening: float
    fraction: float
    largest_strain: float
    is_flat: bool


@dataclass(frozen=True, eq=False)
class Barrier:
    """What lies between two neighboring minima.

    Attributes
    ----------
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

    energy: float
    fraction: float
    closing: float
    opening: float
    is_saddle: bool


def find_minima(energy: Energy, guide: Guide, path: Path, should_stop: ShouldStop | None = None) -> tuple[Minimum, ...]:
    """Return the stable states that a sheet falls into when it is let go along a path, by growing opening.

    Where nothing costs energy along a path that leads to the shape, and slits have no springs, both ends are returned.
    """
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed), toward=guide.deployed - guide.flat)
    values = path.energies
    leads = mean_opening(energy, path.points[-1]) >= LEADS * mean_opening(energy, guide.deployed)
    if energy.torsion == 0 and values.max() <= STRAINLESS and leads:
        # it rests wherever it is left
        return tuple(_minimum(energy, guide, end, flat) for end, flat in ((guide.flat, True), (guide.deployed, False)))
    inner = 1 + np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:]))
    evenly = np.linspace(0, len(values) - 1, RELEASES + 2).round().astype(int)
    low = NEARLY_NONE * max(values.max(), STRAINLESS)
    # with less energy its mean opening is less: the mean of squares is no less than the square of the mean
    enough = min(low, energy.torsion * FLAT**2) if energy.torsion > 0 else -np.inf
    found: list[Minimum] = []
    for start in (guide.flat, *path.points[np.unique(np.r_[inner, evenly])], guide.deployed):
        if should_stop is not None and should_stop():
            break
        rest = minimizer.solve(start, max_steps=RELAX_STEPS, enough=enough)
        flat = bool(rest.energy <= low and mean_opening(energy, rest.points) < FLAT)
        if not flat and not (rest.is_converged and rest.is_stable):
            continue
        new = _minimum(energy, guide, guide.flat if flat else rest.points, flat)
        if not any(_is_same(new, old, energy.length) for old in found):
            found.append(new)
    return _apart(energy, path, sorted(found, key=lambda minimum: minimum.opening))


def find_barriers(energy: Energy, guide: Guide, path: Path, minima: tuple[Minimum, ...]) -> tuple[Barrier, ...]:
    """Return the barriers between neighboring minima: the highest point of the path between them.

    On the free path of a planar sheet it is then moved to where the load on the opening vanishes, which is a saddle.
    Where nothing costs energy along the path there are none, and none are known where it does not come near both.
    """
    if path.energies.max(initial=0.0) <= STRAINLESS:
        return ()
    last = mean_opening(energy, guide.deployed)
    openings = np.array([mean_opening(energy, points) for points in path.points])
    least = SLIGHT * float(path.energies.max())
    barriers = []
    for closed, opened in pairwise(minima):
        floor = max(closed.energy, opened.energy)
        top = _top(energy, path, openings, closed, opened)
        if top is None or path.energies[top] <= floor + least:
            continue
        points, height, is_saddle = path.points[top], float(path.energies[top]), False
        if path.drive == "free" and energy.dimension == 2 and 0 < top < len(openings) - 1:
            refined = _saddle(energy, guide, path, openings, top)
            # on the other side of a jump there may be another saddle, which does not part these two
            if refined is not None and refined.energy > floor:
                points, height, is_saddle = refined.points, refined.energy, True
        at = mean_opening(energy, points) / last
        barriers.append(Barrier(height, at, height - opened.energy, height - closed.energy, is_saddle))
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
        if _distance(minimum.points, path.points[nearest], energy.length) > NEARBY + 0.5 * path.moves[nearest]:
            return None
    between = np.flatnonzero((openings > closed.opening) & (openings < opened.opening))
    return int(between[path.energies[between].argmax()]) if len(between) else None


def _distance(points: np.ndarray, others: np.ndarray, length: float) -> float:
    """Root mean square distance of two sheets, one upon the other, in tile edges."""
    return float(np.sqrt(((nearest_place(points, others) - others) ** 2).sum(axis=1).mean()) / length)


def _minimum(energy: Energy, guide: Guide, points: np.ndarray, flat: bool) -> Minimum:
    opening = mean_opening(energy, points)
    strain = float(np.abs(energy.strains(points)).max())
    fraction = opening / mean_opening(energy, guide.deployed)
    return Minimum(points, energy.value(points), opening, fraction, strain, bool(flat or opening < FLAT))


def _is_same(one: Minimum, other: Minimum, length: float) -> bool:
    if one.is_flat and other.is_flat:
        return True
    if abs(one.opening - other.opening) >= SAME_OPENING:
        return False
    return _distance(one.points, other.points, length) < SAME_PLACE


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
