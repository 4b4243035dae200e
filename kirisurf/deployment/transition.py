"""The stiffness of slits at which a sheet stops to rest open."""

from __future__ import annotations

import numpy as np

from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.minimum import RELAX_STEPS
from kirisurf.deployment.path import ShouldStop

LEAST_TORSION, GROWTH = 1e-8, 4.0
"""Smallest lambda at which an open state is sought, whose forces are a hundred times the tolerance; and the factor by
which lambda then grows."""

FELL = 0.6
"""A sheet that closes to less than this part of its opening while lambda grows a little has lost its open state."""

RIGID_TORSION = 1e-4
"""The smallest lambda to try where rigid tiles lead from flat to shape: without strain it is a mere factor."""

HALVINGS = 30


def transition_torsion(
    energy: Energy,
    guide: Guide,
    least: float = LEAST_TORSION,
    most: float = 10.0,
    should_stop: ShouldStop | None = None,
) -> float | None:
    """Return the lambda above which the open state is gone: a sheet let go at the shape closes.

    The open state is followed from the deployed one as lambda grows, and the interval in which it is lost is halved.

    Parameters
    ----------
    energy : Energy
    guide : Guide
    least, most : float
        Smallest and largest lambda to try.
    should_stop : callable, optional

    Returns
    -------
    float or None
        0 where the sheet closes even at the smallest lambda, infinity where it rests open at the largest; None where
        neither was seen, or it was stopped.
    """
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed))
    low, high, points, is_sure = 0.0, least, guide.deployed, True
    while True:
        if should_stop is not None and should_stop():
            return None
        rests, found = _rest(minimizer, high, points)
        if rests is False:
            break
        is_sure = is_sure and rests is not None
        if rests:
            low, points = high, found
        if high >= most:
            return np.inf if rests else None
        high = min(GROWTH * high, most)
    if low == 0.0:
        return 0.0 if is_sure else None
    for _ in range(HALVINGS):
        if should_stop is not None and should_stop():
            return None
        middle = float(np.sqrt(low * high))
        rests, found = _rest(minimizer, middle, points)
        if rests:
            low, points = middle, found
        else:
            high = middle
        if high - low <= 1e-4 * high:
            break
    return 0.5 * (low + high)


def _rest(minimizer: Minimizer, torsion: float, start: np.ndarray) -> tuple[bool | None, np.ndarray]:
    """Does a sheet that is let go rest open? None where it is open, but no state of rest was found."""
    energy = minimizer.energy
    kept = FELL * mean_opening(energy, start)
    enough = 0.99 * torsion * kept**2
    found = minimizer.with_torsion(torsion).solve(start, max_steps=RELAX_STEPS, enough=enough)
    if found.energy <= enough or mean_opening(energy, found.points) < kept:
        return False, found.points
    return (True if found.is_converged and found.is_stable else None), found.points
