"""Passes: saddles on branches from which a sheet comes to rest on one side here, on the other there."""

from __future__ import annotations

from collections.abc import Sequence

from kirisurf.deployment.branch import Branch
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import PUSH, Minimizer
from kirisurf.deployment.equilibrium_curve import Balance, EquilibriumCurve
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.minimum import Minimum, is_same, rest_from
from kirisurf.deployment.path import ShouldStop

MOST_TRIED = 12
"""Saddles, the lowest first, whose two sides are followed."""

SAME_ENERGY = 1e-7
"""Two saddles are one if their energies, over the highest of the path, agree so far."""


def find_passes(
    energy: Energy,
    guide: Guide,
    branches: Sequence[Branch],
    minima: Sequence[Minimum],
    highest: float,
    should_stop: ShouldStop | None = None,
) -> dict[int, list[Balance]]:
    """Return the saddles that lead down to two neighboring minima, by the number of the more closed one.

    Parameters
    ----------
    energy : Energy
    guide : Guide
    branches : sequence of Branch
    minima : sequence of Minimum
        By growing opening.
    highest : float
        Highest energy of the path: what lies above it parts nothing.
    should_stop : callable, optional
        True ends the search.
    """
    found: dict[int, list[Balance]] = {}
    for saddle in _saddles(branches, highest)[:MOST_TRIED]:
        if should_stop is not None and should_stop():
            break
        sides = _sides(energy, guide, saddle, minima, highest)
        if len(sides) == 2 and max(sides) == min(sides) + 1:
            found.setdefault(min(sides), []).append(saddle)
    return found


def _saddles(branches: Sequence[Branch], highest: float) -> list[Balance]:
    """Different saddles with one falling direction, lowest first: branches that meet show the same."""
    every = [state for branch in branches for state in branch.stationary if state.n_negative == 1]
    different: list[Balance] = []
    for state in sorted(every, key=lambda state: state.energy):
        is_new = not different or state.energy > different[-1].energy + SAME_ENERGY * highest
        if is_new and state.energy <= highest:
            different.append(state)
    return different


def _sides(energy: Energy, guide: Guide, saddle: Balance, minima: Sequence[Minimum], highest: float) -> set[int]:
    """Numbers of the minima in which the sheet comes to rest from both sides of a saddle."""
    pins = Pins.of(guide.deployed)
    mode = EquilibriumCurve(energy, pins, saddle.points).falling(saddle)
    if mode is None:
        return set()
    minimizer = Minimizer(energy, pins=pins, toward=guide.deployed - guide.flat)
    reached = set()
    for sign in (-PUSH, PUSH):
        rest = rest_from(minimizer, guide, saddle.points + sign * energy.length * mode, highest)
        here = [k for k, one in enumerate(minima) if rest is not None and is_same(rest, one, energy.length)]
        if rest is None or not here:
            return set()
        # those next to each other may both be taken for it: one side leads to one
        reached.add(min(here, key=lambda k: abs(minima[k].opening - rest.opening)))
    return reached
