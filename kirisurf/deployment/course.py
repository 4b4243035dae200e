"""A course: the states that a sheet is asked for one after the other, and how each is found from those before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.deployment.equilibrium import Equilibrium, Minimizer
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import Loading, total_energy
from kirisurf.deployment.path import STRAINLESS, Path, Progress, ShouldStop, measured_path

RIGID_TOLERANCE = 1e-13
"""Residual at which a state of a sheet without torsion is taken: its strains are then 1e-12 at most."""

STATE_STEPS = 200
"""Newton steps at most for a state."""

FINER_STEPS = 5
"""Newton steps at most that bring a state without strain to `RIGID_TOLERANCE`."""

DEGREE = 4
"""Highest degree of the polynomials by which the next state is foreseen."""


@dataclass(frozen=True, eq=False)
class Course:
    """What a sheet is asked for, k states.

    Attributes
    ----------
    minimizer : Minimizer
    guide : Guide
    drive : str
        Name for the path.
    fractions : (k,)
    places : (k, n, d)
        Points near which every state is sought.
    loadings : sequence of Loading, optional
    held : (n,) bool, optional
        Vertices that are moved: they are where `places` has them.
    from_end : bool
        Begin with the last state.
    """

    minimizer: Minimizer
    guide: Guide
    drive: str
    fractions: Float[np.ndarray, " k"]
    places: Float[np.ndarray, "k n d"]
    loadings: Sequence[Loading] | None = None
    held: Bool[np.ndarray, " n"] | None = None
    from_end: bool = False

    def followed(self, should_stop: ShouldStop | None = None, progress: Progress | None = None) -> Path:
        """Solve state after state, each from its place and what the ones before are off theirs, extrapolated."""
        count = len(self.fractions)
        states: list[Equilibrium] = []
        off = [np.zeros_like(self.guide.flat)]
        for k in range(count)[::-1] if self.from_end else range(count):
            if should_stop is not None and should_stop():
                break
            state = self._state(k, off)
            states.append(state)
            # what is no equilibrium says nothing of what comes
            is_known = state.is_converged
            off = [*off[-DEGREE:], state.points - self.places[k]] if is_known else [np.zeros_like(self.guide.flat)]
            if progress is not None:
                progress(len(states), count)
        found = self.fractions[count - len(states) :] if self.from_end else self.fractions[: len(states)]
        states = states[::-1] if self.from_end else states
        energy = self.minimizer.energy
        return measured_path(energy, self.guide, self.drive, found, states, interrupted=len(states) < count)

    def _state(self, k: int, off: Sequence[Float[np.ndarray, "n d"]]) -> Equilibrium:
        """The state of one number, from the best guess that leads to one."""
        load = Loading() if self.loadings is None else self.loadings[k]
        tried: list[Equilibrium] = []
        for guess in self._guesses(k, off, load):
            tried.append(self.minimizer.solve(guess, load, max_steps=STATE_STEPS, near=self.places[k]))
            if tried[-1].is_converged:
                return self._refined(k, tried[-1], load)
        return self._refined(k, min(tried, key=lambda one: one.residual), load)

    def _guesses(
        self, k: int, off: Sequence[Float[np.ndarray, "n d"]], load: Loading
    ) -> list[Float[np.ndarray, "n d"]]:
        """The two foreseen states with the least energy, and the place itself."""
        guesses = [self.places[k] + guess for guess in extrapolated(off)]
        for guess in guesses if self.held is not None else ():
            guess[self.held] = self.places[k][self.held]
        guesses.sort(key=lambda guess: total_energy(self.minimizer.energy, guess, load))
        return [*guesses[:2], self.places[k]]

    def _refined(self, k: int, state: Equilibrium, load: Loading) -> Equilibrium:
        """The state, without the strain that the tolerance leaves where there should be none."""
        is_rigid = self.held is None and self.loadings is not None and self.minimizer.energy.torsion == 0
        if not is_rigid or state.energy > STRAINLESS:
            return state
        exact = self.minimizer.with_tolerance(RIGID_TOLERANCE)
        finer = exact.solve(state.points, load, max_steps=FINER_STEPS, near=self.places[k])
        return replace(finer, steps=state.steps + finer.steps, is_converged=state.is_converged)


def extrapolated(values: Sequence[Float[np.ndarray, "n d"]]) -> list[Float[np.ndarray, "n d"]]:
    """Return what may come after values at even distances, by polynomials of degree 0 and more through the last."""
    guesses, differences = [values[-1]] if values else [], list(values)
    while len(differences) > 1:
        differences = [after - before for before, after in pairwise(differences)]
        guesses.append(guesses[-1] + differences[-1])
    return guesses
