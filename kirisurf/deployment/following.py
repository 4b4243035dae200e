"""Following a sheet from flat to deployed, state after state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.deployment.drive import rigid_rows
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Equilibrium, Minimizer
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import Anchor, Loading, mean_opening
from kirisurf.deployment.path import STRAINLESS, Path, Progress, ShouldStop, measured_path

RIGID_TOLERANCE = 1e-13
"""Residual at which a state of a sheet without torsion is taken: its strains are then 1e-12 at most."""

STATE_STEPS = 100
RIGID_STEPS = 14
"""Newton steps at most for a state."""

HALVED = 3
"""How often the way to a state is halved where the state is not found at once."""

SMOOTH = 0.2
"""Displacement beyond the guide's, in tile edges, after which a state is not extrapolated from those before it."""

RETURN = 0.1
"""Part of its distance to the guide that a sheet in space gives up at every state."""

SUPPORT = 100.0
"""Stiffness of the supports of a sheet in space, over lambda."""

LEAST_SUPPORT = 1e-4


def follow_held(
    energy: Energy,
    guide: Guide,
    held: Bool[np.ndarray, " n"],
    fractions: Float[np.ndarray, " k"],
    trajectory: str = "turning",
    should_stop: ShouldStop | None = None,
    progress: Progress | None = None,
    drive: str = "vertices",
) -> Path:
    """Follow the sheet while some vertices are moved and the rest relaxes."""
    minimizer = Minimizer(energy, held=held, toward=guide.deployed - guide.flat)
    way = guide.at if trajectory == "turning" else guide.straight

    def solve(fraction: float, start: np.ndarray) -> Equilibrium:
        return minimizer.solve(np.where(held[:, None], way(fraction), start), max_steps=STATE_STEPS)

    states = _follow(energy, guide, fractions, solve, should_stop, progress)
    return measured_path(energy, guide, drive, fractions, states)


def follow_free_planar(
    energy: Energy,
    guide: Guide,
    fractions: Float[np.ndarray, " k"],
    should_stop: ShouldStop | None = None,
    progress: Progress | None = None,
) -> Path:
    """Follow a planar sheet under a load that opens its slits, and holds no vertex.

    At each state the energy is least among all with that mean opening, so that where it has a maximum along the path,
    the gradient vanishes: it is the saddle between two stable states, and its height the barrier.
    """
    rows, toward = rigid_rows(guide), guide.deployed - guide.flat
    minimizer = Minimizer(energy, rows=rows, toward=toward)
    first, last = (mean_opening(energy, end) for end in (guide.flat, guide.deployed))

    def solve(fraction: float, start: np.ndarray) -> Equilibrium:
        load = Loading(opening=first + fraction * (last - first))
        found = minimizer.solve(start, load, max_steps=STATE_STEPS)
        if found.energy > STRAINLESS:
            return found
        finer = minimizer.with_tolerance(RIGID_TOLERANCE).solve(found.points, load, max_steps=5)
        return replace(finer, steps=found.steps + finer.steps, is_converged=found.is_converged)

    return measured_path(
        energy, guide, "free", fractions, _follow(energy, guide, fractions, solve, should_stop, progress)
    )


def follow_rigid(
    energy: Energy,
    guide: Guide,
    fractions: Float[np.ndarray, " k"],
    should_stop: ShouldStop | None = None,
    progress: Progress | None = None,
) -> Path:
    """Follow a sheet in space without torsion through states that are free of strain, where there are such.

    In space tiles on point hinges have many motions. Every state is the one without strain next to its predecessor,
    moved as the guide moves and a little towards it. The path begins at the deployed sheet, since in the flat one,
    where all slits are closed, all its branches meet. Where there is none, what is found are least strains.
    """
    still = energy.with_torsion(0.0)
    rows, toward = rigid_rows(guide), guide.deployed - guide.flat
    # rigid motions need not be held: steps of least length hold none
    minimizer = Minimizer(still, toward=toward, curved=False, tolerance=RIGID_TOLERANCE)
    strained: Minimizer | None = None
    states: list[Equilibrium] = []
    points = guide.deployed
    count = len(fractions)
    for k in range(count - 1, -1, -1):
        if should_stop is not None and should_stop():
            return measured_path(still, guide, "free", fractions[k + 1 :], states[::-1], interrupted=True)
        before = float(fractions[min(k + 1, count - 1)])
        state = _rigid_state(minimizer, guide, before, float(fractions[k]), points, HALVED)
        if not state.is_converged:
            strained = strained or Minimizer(still, rows=rows, toward=toward)
            anchored = Loading(anchor=Anchor(guide.at(fractions[k]), LEAST_SUPPORT))
            held = strained.solve(state.points, anchored, max_steps=STATE_STEPS)
            state = strained.solve(held.points, max_steps=STATE_STEPS)
        states.append(state)
        points = state.points
        if progress is not None:
            progress(count - k, count)
    return measured_path(still, guide, "free", fractions, states[::-1])


def _rigid_state(
    minimizer: Minimizer, guide: Guide, before: float, fraction: float, points: np.ndarray, halvings: int
) -> Equilibrium:
    """The state without strain next to one before, by way of one half way where it is not found at once."""
    kept = (1 - RETURN) * fraction / before if before > 0 else 0.0
    state = minimizer.solve(guide.at(fraction) + kept * (points - guide.at(before)), max_steps=RIGID_STEPS)
    if state.is_converged:
        return state
    if state.energy <= STRAINLESS:  # next to the flat sheet the last digits come slowly
        return replace(state, is_converged=True)
    if halvings == 0:
        return state
    middle = 0.5 * (before + fraction)
    half = _rigid_state(minimizer, guide, before, middle, points, halvings - 1)
    end = _rigid_state(minimizer, guide, middle, fraction, half.points, halvings - 1)
    return replace(end, steps=state.steps + half.steps + end.steps)


def follow_supported(
    energy: Energy,
    guide: Guide,
    rigid: Path,
    should_stop: ShouldStop | None = None,
    progress: Progress | None = None,
) -> Path:
    """Follow a sheet in space with torsion, held by soft supports near a path without.

    Without supports it would give way to its slits in one of the many motions that strain nothing: see `holding` for
    the force that this takes.
    """
    minimizer = Minimizer(energy, toward=guide.deployed - guide.flat)
    stiffness = max(SUPPORT * energy.torsion, LEAST_SUPPORT)
    states: list[Equilibrium] = []
    off = [np.zeros_like(guide.flat)] * 2
    for k, points in enumerate(rigid.points):
        if should_stop is not None and should_stop():
            return measured_path(energy, guide, "free", rigid.fractions[:k], states, interrupted=True)
        guess = points + 2 * off[-1] - off[-2]
        states.append(minimizer.solve(guess, Loading(anchor=Anchor(points, stiffness)), max_steps=STATE_STEPS))
        off.append(states[-1].points - points)
        if progress is not None:
            progress(k + 1, len(rigid.points))
    return measured_path(energy, guide, "free", rigid.fractions, states)


def _follow(
    energy: Energy,
    guide: Guide,
    fractions: np.ndarray,
    solve: Callable[[float, np.ndarray], Equilibrium],
    should_stop: ShouldStop | None,
    progress: Progress | None,
) -> list[Equilibrium]:
    """Solve state after state, each from the guide and what the ones before are off it, extrapolated."""
    states: list[Equilibrium] = []
    off = [np.zeros_like(guide.flat)]
    for k, fraction in enumerate(fractions):
        if should_stop is not None and should_stop():
            break
        guided = guide.at(fraction)
        guesses = [off[-1]]
        if len(off) > 3:
            guesses.append(3 * off[-1] - 3 * off[-2] + off[-3])
        guesses.sort(key=lambda guess: energy.value(guided + guess))
        for guess in (*guesses, np.zeros_like(guided)):
            state = solve(float(fraction), guided + guess)
            if state.is_converged:
                break
        states.append(state)
        # what was before a jump, or is no equilibrium, says nothing of what comes
        moved = float(np.abs(state.points - guided - off[-1]).max()) > SMOOTH * energy.length
        off = [*([] if moved else off), state.points - guided] if state.is_converged else [np.zeros_like(guided)]
        if progress is not None:
            progress(k + 1, len(fractions))
    return states
