"""The curve of all equilibria of a sheet under a load on its mean opening, stable or not: steps by arc length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import brentq

from kirisurf.deployment.descent import REUSED
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import STILL, TOLERANCE
from kirisurf.deployment.factor import Factor, Factors
from kirisurf.deployment.loading import Loaded, Loading, loaded, mean_opening
from kirisurf.deployment.newton import FIRST_SHIFT, LEAST_SHIFT, MOST_SHIFT, softest
from kirisurf.errors import UnusableError

CORRECTIONS = 12
"""Newton steps at most that bring a foreseen state onto the curve; most use an old factor."""

OFF = 0.5
"""Distance of a state from the foreseen one, over the step, from which on it may lie on another curve."""

TURN, SHARP = 0.8, 1e-3
"""Least cosine between the directions of the curve at both ends of a step, and the step below which any is taken: where
two sides of a slit meet, their contact grows stiff within so short a way that the curve has a corner."""


@dataclass(frozen=True, eq=False)
class Balance:
    """A state of the curve: gradient of E = force * gradient of the mean opening.

    Attributes
    ----------
    points : (n, d)
    force : float
        Energy per radian: above 0 where the sheet has to be opened, below where it opens by itself; E is stationary
        where it is 0.
    opening : float, radians
    energy, residual : float
    n_negative : int
        Directions in which E, with the work of the force, falls.
    n_across : int
        Those among them that keep the mean opening: 0 for what a prescribed opening can hold.
    direction : (q,)
        Of the curve, in free coordinates and tile edges, of length 1.
    force_slope : float
        Change of the force over displacement in that direction.
    rises : bool
        Does the opening grow in that direction?
    """

    points: Float[np.ndarray, "n d"]
    force: float
    opening: float
    energy: float
    residual: float
    n_negative: int
    n_across: int
    direction: Float[np.ndarray, " q"]
    force_slope: float
    rises: bool


class EquilibriumCurve:
    """Newton's method for a state x and its force m together.

    ::

        grad E(x) = m grad s(x),    (x - foreseen) . direction = 0

    With s the mean opening, these equations are regular where the curve turns back in the opening, and where the
    stiffness is singular; only where curves cross they are not. Arcs are measured in x alone, as the root mean square
    over the vertices in tile edges: x never stands still along the curve, since the opening always has a slope.

    Parameters
    ----------
    energy : Energy
    pins : Pins
    place : (n, d)
        Rigid motions are held as this state has them.
    """

    def __init__(self, energy: Energy, pins: Pins, place: Float[np.ndarray, "n d"]) -> None:
        self.energy = energy
        self._axes = pins.frame(place)
        self._free = ~pins.held(place.shape)
        numbers = np.full(place.shape, -1)
        numbers[self._free] = np.arange(int(self._free.sum()))
        self._stiffness, self._factors = energy.stiffness(numbers), Factors()
        self._root = float(np.sqrt(len(place)))
        self._scale = 1.0 / (energy.unit_force * energy.length)
        self.steps = 0

    def at(self, points: Float[np.ndarray, "n d"], sign: float = 1.0) -> Balance:
        """Return a state in equilibrium under a load, its direction that in which the opening grows, or falls.

        Raises
        ------
        UnusableError
            Where no load on the opening holds it.
        """
        inside = points @ self._axes
        plain = self._loaded(inside, 0.0)
        slope = self._of(plain.slope)
        force = float(self._of(plain.gradient) @ slope) / float(slope @ slope) / self._scale
        found = self._measured(inside, force, None, sign)
        if found is None or found.residual > STILL:
            rest = "a singular one" if found is None else f"one with a residual of {found.residual:.2g}"
            raise UnusableError(f"state: expected one in equilibrium under a load on its mean opening, got {rest}")
        return found

    def after(self, before: Balance, length: float, bend: Float[np.ndarray, " q"] | None = None) -> Balance | None:
        """Return the state at a length of arc behind another, None where there is none near the foreseen one.

        Parameters
        ----------
        before : Balance
        length : float
            Root mean square displacement along the direction, in tile edges.
        bend : (q,), optional
            Change of the direction over the length, by which the state is foreseen more exactly.
        """
        reach = length * self._root
        inside = self.foreseen(before, length, bend) @ self._axes
        found = self._corrected(inside, before.force + reach * before.force_slope, before.direction, OFF * abs(reach))
        if found is None:
            return None
        there = self._measured(*found, before.direction, 1.0)
        if there is None or (abs(length) > SHARP and there.direction @ before.direction < TURN):
            return None
        return there

    def foreseen(
        self, before: Balance, length: float, bend: Float[np.ndarray, " q"] | None = None
    ) -> Float[np.ndarray, "n d"]:
        """Return the points from which `after` begins: off by the square of the length, with its bend by the cube."""
        shift = before.direction
        if bend is not None:
            shift = shift + 0.5 * (bend - (bend @ before.direction) * before.direction)
        inside = before.points @ self._axes
        inside[self._free] += self.energy.length * length * self._root * shift
        return inside @ self._axes.T

    def stationary(self, before: Balance, after: Balance, length: float) -> Balance | None:
        """Return the state between two, a length of arc apart, whose force is 0: nothing pulls there."""
        known = {0.0: before, length: after}

        def force(at: float) -> float:
            if at not in known:
                found = self.after(before, at)
                if found is None:
                    raise ArithmeticError
                known[at] = found
            return known[at].force

        try:
            brentq(force, 0.0, length, xtol=1e-6 * abs(length), rtol=1e-6)
        except ArithmeticError:
            return None
        nearest = min(known.values(), key=lambda state: abs(state.force))
        found = self._corrected(nearest.points @ self._axes, 0.0, None, 0.1 * length * self._root)
        return None if found is None else self._measured(*found, before.direction, 1.0)

    def falling(self, state: Balance) -> Float[np.ndarray, "n d"] | None:
        """Return the direction (largest component 1) in which the energy falls fastest from a saddle, None if none."""
        here, shift = self._loaded(state.points @ self._axes, state.force), LEAST_SHIFT
        factor = self._factored(here, shift)
        if factor.n_negative <= 0:
            return None
        while factor.n_negative != 0:
            shift = max(4 * shift, FIRST_SHIFT)
            if shift > MOST_SHIFT:
                return None
            factor = self._factored(here, shift)
        mode = softest(factor, np.random.default_rng(0).standard_normal(int(self._free.sum())))
        field = np.zeros(state.points.shape)
        field[self._free] = mode / np.abs(mode).max()
        return field @ self._axes.T

    def _corrected(
        self, inside: np.ndarray, force: float, direction: np.ndarray | None, most: float
    ) -> tuple[np.ndarray, float] | None:
        """The state on the curve next to a foreseen one, across the direction, or with the force as it is."""
        factor: Factor | None = None
        away, last = np.zeros(int(self._free.sum())), np.inf
        response = away
        start = inside
        for _ in range(CORRECTIONS):
            here = self._loaded(inside, force)
            gradient = self._of(here.gradient)
            residual = float(np.abs(gradient).max(initial=0.0))
            if residual <= TOLERANCE:
                return inside, force
            if not np.isfinite(residual):
                return None
            if factor is None or residual > REUSED * last:
                factor = self._factored(here)
                if factor.n_negative < 0:
                    return None
                response = factor.solve(self._of(here.slope)) * self._scale
            last = residual
            self.steps += 1
            move = -factor.solve(gradient)
            if direction is not None:
                change = -float(direction @ (move + away)) / float(direction @ response)
                move, force = move + change * response, force + change
            away = away + move
            if np.linalg.norm(away) > most:
                return None
            inside = start.copy()
            inside[self._free] += self.energy.length * away
        return None

    def _measured(self, inside: np.ndarray, force: float, toward: np.ndarray | None, sign: float) -> Balance | None:
        here = self._loaded(inside, force)
        factor, slope = self._factored(here), self._of(here.slope)
        if factor.n_negative < 0:
            return None
        response = factor.solve(slope)
        size = float(np.linalg.norm(response))
        softness = float(slope @ response)
        way = sign * (softness if toward is None else float(toward @ response))
        turned = -1.0 if way < 0 else 1.0
        return Balance(
            points=inside @ self._axes.T,
            force=force,
            opening=mean_opening(self.energy, inside),
            energy=here.energy,
            residual=float(np.abs(self._of(here.gradient)).max(initial=0.0)),
            n_negative=factor.n_negative,
            # Sylvester: of the stiffness bordered by the slope, less the one that the border adds
            n_across=factor.n_negative + int(softness > 0) - 1,
            direction=turned * response / size,
            force_slope=turned / (self._scale * size),
            rises=bool(turned * softness > 0),
        )

    def _loaded(self, inside: np.ndarray, force: float) -> Loaded:
        return loaded(self.energy, inside, Loading(force=force))

    def _of(self, field: np.ndarray | None) -> np.ndarray:
        return np.zeros(0) if field is None else field[self._free]

    def _factored(self, here: Loaded, shift: float = LEAST_SHIFT) -> Factor:
        entries = self._stiffness.numbers(here.bends) * (self.energy.length / self.energy.unit_force)
        return self._factors.of(self._stiffness.matrix(entries, shift))
