"""Following a sheet from flat to deployed, state after state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.deployment.course import DEGREE, RIGID_TOLERANCE, STATE_STEPS, Course, extrapolated
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Equilibrium, Minimizer
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import Anchor, Loading, mean_opening
from kirisurf.deployment.path import STRAINLESS, Path, Progress, ShouldStop, measured_path

RIGID_STEPS = 14
"""Newton steps at most for a state without strain."""

HALVED = 3
"""How often the way to a state is halved where the state is not found at once."""

RETURN = 0.3
"""Part of its distance to the guide that a sheet in space gives up at every state."""

WEAK, NEAR = 1e-9, 1e-6
"""Stiffness of the springs that keep a foreseen state from drifting, and the residual up to which they act."""

NEAR_STEPS = 2
"""Newton steps with these springs: two bring a sheet near a state without strain, and what follows finds it."""

SUPPORT = 100.0
"""Stiffness of the supports of a sheet in space, over lambda."""

LEAST_SUPPORT = 1e-4


def follow_held(
    energy: Energy,
    guide: Guide,
    held: Bool[np.ndarray, " n"],
    fractions: Float[np.ndarray, " k"],
    places: Float[np.ndarray, "k n d"],
    should_stop: ShouldStop | None = None,
    progress: Progress | None = None,
    drive: str = "vertices",
) -> Path:
    """Follow the sheet while some vertices are moved and the rest relaxes.

    In space the path begins at the deployed sheet, since in the flat one, where all slits are closed, its branches
    meet.

    Parameters
    ----------
    energy : Energy
    guide : Guide
    held : (n,)
        Vertices that are moved.
    fractions : (k,)
    places : (k, n, d)
        Where they are at every part of the way; the rest is sought near the places of the other vertices.
    should_stop, progress : callable, optional
    drive : str
        Name for the path.
    """
    minimizer = Minimizer(energy, held=held, toward=guide.deployed - guide.flat)
    course = Course(minimizer, guide, drive, fractions, places, held=held, from_end=energy.dimension == 3)
    return course.followed(should_stop, progress)


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
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed), toward=guide.deployed - guide.flat)
    first, last = (mean_opening(energy, end) for end in (guide.flat, guide.deployed))
    loadings = [Loading(opening=first + fraction * (last - first)) for fraction in fractions]
    course = Course(minimizer, guide, "free", fractions, guide.places(fractions), loadings)
    return course.followed(should_stop, progress)


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
    toward = guide.deployed - guide.flat
    # rigid motions need not be held: steps of least length hold none
    minimizer = Minimizer(still, toward=toward, curved=False, tolerance=RIGID_TOLERANCE)
    supported: Minimizer | None = None
    strained: Minimizer | None = None
    states: list[Equilibrium] = []
    points, off = guide.deployed, list[np.ndarray]()
    count = len(fractions)
    for k in range(count - 1, -1, -1):
        if should_stop is not None and should_stop():
            return measured_path(still, guide, "free", fractions[k + 1 :], states[::-1], interrupted=True)
        before = float(fractions[min(k + 1, count - 1)])
        expected = _expected(guide, before, float(fractions[k]), points)
        state = _rigid_state(minimizer, guide, before, float(fractions[k]), points, HALVED, off)
        if not state.is_converged:
            supported = supported or Minimizer(still, toward=toward)
            strained = strained or Minimizer(still, pins=Pins.of(guide.deployed), toward=toward)
            anchored = Loading(anchor=Anchor(guide.at(fractions[k]), LEAST_SUPPORT))
            held = supported.solve(state.points, anchored, max_steps=STATE_STEPS)
            state = strained.solve(held.points, max_steps=STATE_STEPS)
        states.append(state)
        points = state.points
        off = [*off[-DEGREE:], points - expected]
        if progress is not None:
            progress(count - k, count)
    return measured_path(still, guide, "free", fractions, states[::-1])


def _expected(guide: Guide, before: float, fraction: float, points: np.ndarray) -> np.ndarray:
    """Points moved as the guide moves from one part of the way to another, and a little towards it."""
    kept = (1 - RETURN) * fraction / before if before > 0 else 0.0
    return guide.at(fraction) + kept * (points - guide.at(before))


def _rigid_state(
    minimizer: Minimizer,
    guide: Guide,
    before: float,
    fraction: float,
    points: np.ndarray,
    halvings: int,
    off: Sequence[np.ndarray] = (),
) -> Equilibrium:
    """The state without strain next to one before, by way of one half way where it is not found at once.

    What states before were off the expected ones foresees it. Foreseen states alone would drift along the motions
    that strain nothing: springs to the expected points, weak enough to strain nothing either, keep them.
    """
    start, steps = _expected(guide, before, fraction, points), 0
    foreseen = min((start + guess for guess in extrapolated(off)), key=minimizer.energy.value, default=start)
    if minimizer.energy.value(foreseen) < minimizer.energy.value(start):
        near = minimizer.with_tolerance(NEAR).solve(foreseen, Loading(anchor=Anchor(start, WEAK)), max_steps=NEAR_STEPS)
        start, steps = near.points, near.steps
    state = minimizer.solve(start, max_steps=RIGID_STEPS)
    state = replace(state, steps=state.steps + steps)
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
    loadings = [Loading(anchor=Anchor(points, stiffness)) for points in rigid.points]
    course = Course(minimizer, guide, "free", rigid.fractions, rigid.points, loadings)
    return course.followed(should_stop, progress)
