"""Minima: states in which a sheet rests by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.guide import Guide, nearest_place
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.path import STRAINLESS

SAME_OPENING, SAME_PLACE = 0.01, 0.05
"""Two states are one if mean openings (radians) and vertices (root mean square, tile edges) agree so far."""

FLAT = 0.02
"""Mean opening in radians below which a sheet is flat: in space its last way home is soft, and not gone to the end."""

NEARLY_NONE = 1e-4
"""Energy, over the highest of the path, below which a sheet whose slits are springs is on its way to the flat state."""

RELAX_STEPS = 300


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


def rest_from(minimizer: Minimizer, guide: Guide, start: Float[np.ndarray, "n d"], highest: float) -> Minimum | None:
    """Return where a sheet that is let go comes to rest, None where that was not found.

    Parameters
    ----------
    minimizer : Minimizer
    guide : Guide
    start : (n, d)
    highest : float
        Highest energy of the path, over which a sheet is seen to be on its way to the flat state.
    """
    energy = minimizer.energy
    low = NEARLY_NONE * max(highest, STRAINLESS)
    # with less energy its mean opening is less: the mean of squares is no less than the square of the mean
    enough = min(low, energy.torsion * FLAT**2) if energy.torsion > 0 else -np.inf
    rest = minimizer.solve(start, max_steps=RELAX_STEPS, enough=enough)
    flat = bool(rest.energy <= low and mean_opening(energy, rest.points) < FLAT)
    if not flat and not (rest.is_converged and rest.is_stable):
        return None
    return minimum_of(energy, guide, guide.flat if flat else rest.points, flat)


def minimum_of(energy: Energy, guide: Guide, points: Float[np.ndarray, "n d"], flat: bool) -> Minimum:
    """Return a state of rest with what is measured of it."""
    opening = mean_opening(energy, points)
    strain = float(np.abs(energy.strains(points)).max())
    fraction = opening / mean_opening(energy, guide.deployed)
    return Minimum(points, energy.value(points), opening, fraction, strain, bool(flat or opening < FLAT))


def is_same(one: Minimum, other: Minimum, length: float) -> bool:
    """Are two states of rest the same one?"""
    if one.is_flat and other.is_flat:
        return True
    if abs(one.opening - other.opening) >= SAME_OPENING:
        return False
    return distance(one.points, other.points, length) < SAME_PLACE


def distance(points: Float[np.ndarray, "n d"], others: Float[np.ndarray, "n d"], length: float) -> float:
    """Return the root mean square distance of two sheets, one upon the other, in tile edges."""
    return float(np.sqrt(((nearest_place(points, others) - others) ** 2).sum(axis=1).mean()) / length)
