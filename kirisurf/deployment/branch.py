"""Branches: equilibria past the states that a prescribed opening can hold, followed by arc length through folds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium_curve import Balance, EquilibriumCurve
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.path import Path, PathStatus, ShouldStop, jumps
from kirisurf.errors import ParameterError, UnusableError

FIRST, LONGEST, SHORTEST = 0.02, 0.15, 1e-5
"""Lengths of steps: root mean square displacement in tile edges."""

GROWTH, SHRINK = 1.5, 0.4
STRAIGHT = 0.95
"""Cosine between the ends of a step above which the next one is longer."""

MOST_STATES = 120
"""States of a branch at most."""

MOST_IN_ALL = 400
"""States of all branches of a path at most; three to six of them take as long as a state of the path."""

BACK = 0.25
"""Part of the shape's opening by which a branch may turn back behind its beginning."""


class BranchEnd(Enum):
    """Why a branch was followed no further."""

    HELD = "It came past a fold to a state beyond the jump that its opening can hold."
    AWAY = "It turned back far behind the jump."
    LONG = "It has as many states as were allowed."
    LOST = "No next state was found: a slit opened as far as the model goes, or curves cross."
    INTERRUPTED = "It was interrupted."


@dataclass(frozen=True, eq=False)
class Branch:
    """A piece of the curve of equilibria under a load on the mean opening, stable or not.

    Attributes
    ----------
    states : tuple of Balance
    lengths : (k - 1,)
        Arcs between them: root mean square displacement in tile edges.
    stationary : tuple of Balance
        States between them whose load is 0: minima of the energy where `n_negative` is 0, saddles where it is 1.
    end : BranchEnd
    steps : int
        Newton steps.
    """

    states: tuple[Balance, ...]
    lengths: Float[np.ndarray, " _"]
    stationary: tuple[Balance, ...]
    end: BranchEnd
    steps: int

    @property
    def openings(self) -> Float[np.ndarray, " k"]:
        """Mean opening of every state in radians."""
        return np.array([state.opening for state in self.states])

    @property
    def energies(self) -> Float[np.ndarray, " k"]:
        """The energy of every state, without the work of the load."""
        return np.array([state.energy for state in self.states])

    @property
    def folds(self) -> tuple[int, ...]:
        """Numbers of the states behind which the opening turns back."""
        return tuple(k for k, (one, two) in enumerate(pairwise(self.states)) if one.rises != two.rises)

    @property
    def first_turn(self) -> int:
        """How many states there are before the opening first turns back."""
        return 1 + (self.folds or (len(self.states) - 1,))[0]

    @property
    def crossings(self) -> tuple[int, ...]:
        """Numbers of the states behind which another curve crosses, or two folds lie in one step.

        At a fold the number of falling directions that keep the opening changes by one. Where it changes otherwise,
        symmetry is broken: a curve that is not followed begins there.
        """
        changes = ((abs(one.n_across - two.n_across), one.rises != two.rises) for one, two in pairwise(self.states))
        return tuple(k for k, (change, turns) in enumerate(changes) if change != int(turns))


def follow_branch(
    energy: Energy,
    guide: Guide,
    start: Float[np.ndarray, "n d"],
    opens: bool = True,
    beyond: float | None = None,
    most: int = MOST_STATES,
    longest: float = LONGEST,
    should_stop: ShouldStop | None = None,
) -> Branch:
    """Follow the curve of equilibria of a sheet under a load on its mean opening, through folds.

    The step adapts itself: it is shortened where no state is found near the foreseen one, or the curve bends.

    Parameters
    ----------
    energy : Energy
    guide : Guide
    start : (n, d)
        In equilibrium under a load on the mean opening, as are the states of a free path in the plane.
    opens : bool
        Begin in the direction in which the opening grows; else in that in which it falls.
    beyond : float, optional
        Opening in radians: past a fold, the branch ends at the first state beyond it that its opening can hold.
    most : int
        States at most.
    longest : float
        Longest step: root mean square displacement in tile edges.
    should_stop : callable, optional

    Raises
    ------
    ParameterError
        Where fewer than two states are allowed, or the longest step is not above `SHORTEST`.
    UnusableError
        Where no load on the opening holds the start.

    Examples
    --------
    >>> from kirisurf.deployment.springs import energy_of
    >>> from kirisurf.pattern import quad_pattern
    >>> sheet = quad_pattern(2, 2, 0.6)
    >>> energy = energy_of(sheet, sheet.contracted, 1e-3, 2)
    >>> branch = follow_branch(energy, Guide(sheet, sheet.contracted, sheet.deployed), sheet.deployed, most=5)
    >>> len(branch.states), branch.folds, branch.states[-1].n_across
    (5, (), 0)
    """
    if most < 2:
        raise ParameterError(f"most: expected at least 2 states, got {most}")
    if not longest > SHORTEST:
        raise ParameterError(f"longest: expected a step above {SHORTEST:g} tile edges, got {longest}")
    points = np.asarray(start, float)
    curve = EquilibriumCurve(energy, Pins.of(guide.deployed), points)
    states, lengths = [curve.at(points, 1.0 if opens else -1.0)], list[float]()
    back = BACK * mean_opening(energy, guide.deployed)
    way = 1 if opens else -1
    length, has_turned, end = min(FIRST, longest), False, BranchEnd.LONG
    bend: np.ndarray | None = None
    while len(states) < most:
        if should_stop is not None and should_stop():
            end = BranchEnd.INTERRUPTED
            break
        before = states[-1]
        after = curve.after(before, length, None if bend is None else length * bend)
        if after is None:
            length *= SHRINK
            if length < SHORTEST:
                end = BranchEnd.LOST
                break
            continue
        bend = (after.direction - before.direction) / length
        states.append(after)
        lengths.append(length)
        has_turned = has_turned or before.rises != after.rises
        if has_turned and beyond is not None and after.n_across == 0 and way * (after.opening - beyond) > 0:
            end = BranchEnd.HELD
            break
        if way * (states[0].opening - after.opening) > back:
            end = BranchEnd.AWAY
            break
        if after.direction @ before.direction > STRAIGHT:
            length = min(GROWTH * length, longest)
    stationary = [
        curve.stationary(one, two, length)
        for (one, two), length in zip(pairwise(states), lengths, strict=True)
        if one.force * two.force < 0
    ]
    found = tuple(state for state in stationary if state is not None)
    return Branch(tuple(states), np.array(lengths), found, end, curve.steps)


def jump_branches(
    energy: Energy,
    guide: Guide,
    path: Path,
    most: int = MOST_STATES,
    most_in_all: int = MOST_IN_ALL,
    should_stop: ShouldStop | None = None,
) -> tuple[Branch, ...]:
    """Follow the curve of equilibria at the jumps of a free path in the plane.

    Until `most_in_all` states are found: on from the states before, where most saddles are, the highest first, then
    back from the ones behind. Other paths have no branches: there the load is not one on the opening.
    """
    if path.drive != "free" or energy.dimension != 2 or path.status is not PathStatus.JUMPED:
        return ()
    rows = sorted(jumps(energy, guide, path).tolist(), key=lambda row: -float(path.energies[row : row + 2].max()))
    branches: list[Branch] = []
    left = most_in_all
    for begin, beyond in [(row, row + 1) for row in rows] + [(row + 1, row) for row in rows]:
        if left < 2 or (should_stop is not None and should_stop()):
            break
        goal, count = mean_opening(energy, path.points[beyond]), min(most, left)
        try:
            branch = follow_branch(
                energy, guide, path.points[begin], begin < beyond, goal, count, should_stop=should_stop
            )
        except UnusableError:  # a state whose stiffness cannot be factored begins no branch
            continue
        branches.append(branch)
        left -= len(branch.states)
    return tuple(branches)
