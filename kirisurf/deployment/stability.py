"""Stability: where a sheet rests when it is let go, and what lies between."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.optimize import brentq

from kirisurf.deployment.drive import pinned_coordinates
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.guide import Guide
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
HALVINGS = 30
LEAST_TORSION, GROWTH = 1e-8, 4.0
"""Smallest lambda at which an open state is sought, whose forces are a hundred times the tolerance; and the factor by
which lambda then grows."""

FELL = 0.6
"""A sheet that closes to less than this part of its opening while lambda grows a little has lost its open state."""


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

    Where nothing costs energy along the path, both ends are returned.
    """
    minimizer = Minimizer(energy, pinned=pinned_coordinates(guide.deployed), toward=guide.deployed - guide.flat)
    values = path.energies
    if values.max() <= STRAINLESS:
        # it rests wherever it is left
        return tuple(_minimum(energy, guide, end, flat) for end, flat in ((guide.flat, True), (guide.deployed, False)))
    inner = 1 + np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:]))
    evenly = np.linspace(0, len(values) - 1, RELEASES + 2).round().astype(int)
    low = NEARLY_NONE * max(values.max(), STRAINLESS)
    found: list[Minimum] = []
    for start in (guide.flat, *path.points[np.unique(np.r_[inner, evenly])], guide.deployed):
        if should_stop is not None and should_stop():
            break
        rest = minimizer.solve(start, max_steps=RELAX_STEPS, enough=low if energy.torsion > 0 else -np.inf)
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
    Where nothing costs energy along the path there are none.
    """
    if path.energies.max(initial=0.0) <= STRAINLESS:
        return ()
    last = mean_opening(energy, guide.deployed)
    openings = np.array([mean_opening(energy, points) for points in path.points])
    barriers = []
    for closed, opened in pairwise(minima):
        between = np.flatnonzero((openings > closed.opening) & (openings < opened.opening))
        if not len(between):
            continue
        top = int(between[path.energies[between].argmax()])
        points, height, is_saddle = path.points[top], float(path.energies[top]), False
        if path.drive == "free" and energy.dimension == 2 and 0 < top < len(openings) - 1:
            refined = _saddle(energy, guide, path, openings, top)
            # on the other side of a jump there may be another saddle, which does not part these two
            if refined is not None and refined[1] > max(closed.energy, opened.energy):
                points, height, is_saddle = refined
        height = max(height, closed.energy, opened.energy)
        at = mean_opening(energy, points) / last
        barriers.append(Barrier(height, at, height - opened.energy, height - closed.energy, is_saddle))
    return tuple(barriers)


def transition_torsion(energy: Energy, guide: Guide, least: float = LEAST_TORSION, most: float = 10.0) -> float:
    """Return the lambda above which the open state is gone: a sheet let go at the shape closes.

    The open state is followed from the deployed one as lambda grows, and the interval in which it is lost is halved.

    Parameters
    ----------
    energy : Energy
    guide : Guide
    least, most : float
        Smallest and largest lambda to try.

    Returns
    -------
    float
        0 where there is no open state even at the smallest lambda, infinity where there is one at the largest.
    """
    minimizer = Minimizer(energy, pinned=pinned_coordinates(guide.deployed))

    def rest(torsion: float, start: np.ndarray) -> np.ndarray | None:
        kept = FELL * mean_opening(energy, start)
        # with less energy its mean opening is less: the mean of squares is no less than the square of the mean
        enough = 0.99 * torsion * kept**2
        found = minimizer.with_torsion(torsion).solve(start, max_steps=RELAX_STEPS, enough=enough)
        is_open = mean_opening(energy, found.points) >= kept
        return found.points if is_open and found.is_converged and found.is_stable else None

    low, high, points = 0.0, least, guide.deployed
    while (found := rest(high, points)) is not None:
        if high >= most:
            return np.inf
        low, high, points = high, min(GROWTH * high, most), found
    if low == 0.0:
        return 0.0
    for _ in range(HALVINGS):
        middle = np.sqrt(low * high)
        found = rest(middle, points)
        if found is None:
            high = middle
        else:
            low, points = middle, found
        if high - low <= 1e-4 * high:
            break
    return float(0.5 * (low + high))


def _apart(energy: Energy, path: Path, minima: list[Minimum]) -> tuple[Minimum, ...]:
    """Minima with something between: of neighbors on one flat stretch of the path the lower, or more open, one."""
    openings = np.array([mean_opening(energy, points) for points in path.points])
    least = SLIGHT * float(path.energies.max())
    kept: list[Minimum] = []
    for minimum in minima:
        if kept:
            between = (openings > kept[-1].opening) & (openings < minimum.opening)
            top = float(path.energies[between].max(initial=0.0))
            if top - max(kept[-1].energy, minimum.energy) <= least:
                if not kept[-1].is_flat and minimum.energy <= kept[-1].energy + least:
                    kept[-1] = minimum
                continue
        kept.append(minimum)
    return tuple(kept)


def _minimum(energy: Energy, guide: Guide, points: np.ndarray, flat: bool) -> Minimum:
    opening = mean_opening(energy, points)
    strain = float(np.abs(energy.strains(points)).max())
    fraction = opening / mean_opening(energy, guide.deployed)
    return Minimum(points, energy.value(points), opening, fraction, strain, bool(flat or opening < FLAT))


def _is_same(one: Minimum, other: Minimum, length: float) -> bool:
    if one.is_flat and other.is_flat:
        return True
    apart = np.sqrt(((one.points - other.points) ** 2).sum(axis=1).mean()) / length
    return bool(abs(one.opening - other.opening) < SAME_OPENING and apart < SAME_PLACE)


def _saddle(
    energy: Energy, guide: Guide, path: Path, openings: np.ndarray, top: int
) -> tuple[np.ndarray, float, bool] | None:
    """The state between the neighbors of the highest one at which the load on the opening changes its sign."""
    minimizer = Minimizer(energy, pinned=pinned_coordinates(guide.deployed), toward=guide.deployed - guide.flat)
    start = path.points[top]
    found = [minimizer.solve(start, Loading(opening=openings[top]))]

    def load(asked: float) -> float:
        found[0] = minimizer.solve(found[0].points, Loading(opening=asked))
        return STIFFNESS * (asked - mean_opening(energy, found[0].points))

    ends = float(openings[top - 1]), float(openings[top + 1])
    # asked again, an end next to a jump may give another answer
    known = {end: load(end) for end in ends}
    if not known[ends[0]] > 0 > known[ends[1]]:
        return None
    load(openings[top])
    brentq(lambda asked: known.get(asked) or load(asked), *ends, xtol=1e-13, rtol=1e-13)
    state = found[0]
    return state.points, state.energy, bool(state.is_converged and minimizer.is_saddle(state.points))
