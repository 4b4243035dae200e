"""Equilibria: minima of the energy of a sheet, free or with some of its vertices held."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.arrays import frozen
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.factor import Factors
from kirisurf.deployment.guide import nearest_place
from kirisurf.deployment.loading import Loading, loaded
from kirisurf.deployment.newton import Operator, State

TOLERANCE = 1e-10
"""Largest force on a free vertex at an equilibrium, over that of a rod with strain 1."""

NOTHING = 1e-20
"""Energy below which a state is a minimum whatever its second derivatives: energies are sums of squares."""

STILL = 1e-7
"""Largest force on a free vertex at a saddle, which is found by the opening at which its load vanishes."""

LEAST_SHIFT = 1e-9
"""Multiple of the identity that is always added: what no rod holds stays where it is."""

FIRST_SHIFT, MOST_SHIFT = 1e-4, 1e6
LONGEST = 0.5
"""Largest displacement of a coordinate in one step, in tile edges."""

MAX_STEPS = 200
MAX_ESCAPES = 4
PUSH = 0.02
"""How far a sheet is pushed off a saddle, in tile edges."""

REUSED = 0.1
"""A factor serves again after a step that brought the residual below this part of the one before."""

ROUNDING = 1e-13
"""Part of an energy that rounding may change."""

INVERSE_STEPS = 30
"""Steps of inverse iteration that find the softest direction."""


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Where a minimization ended.

    Attributes
    ----------
    points : (n, d)
    energy : float
        Without that of the loading.
    residual : float
        Largest force on a free vertex over that of a rod with strain 1.
    steps : int
        Newton steps.
    is_converged : bool
    is_stable : bool
        No direction is left in which the energy falls, to second order.
    """

    points: Float[np.ndarray, "n d"]
    energy: float
    residual: float
    steps: int
    is_converged: bool
    is_stable: bool


class Minimizer:
    """Newton's method for one sheet with one kind of support; order and pattern of the matrix are found once.

    minimize E(x)  subject to  x_i = given for held coordinates

    Each step solves with H + shift, the shift so large that the energy is convex where the sheet is free to move
    (read from the signs of the pivots), and is taken if the energy falls as the model says; else the shift grows
    (Levenberg, Marquardt). Where it would end at a saddle it is pushed off along the softest direction.

    Parameters
    ----------
    energy : Energy
    held : (n,) bool, optional
        Vertices that stay where the start has them.
    pins : Pins, optional
        Supports that hold the rigid motions of a sheet; not together with anchors, which hold them too.
    toward : (n, d), optional
        Direction that decides to which side a sheet is pushed off a saddle.
    curved : bool
        False for steps of Gauss and Newton: for sheets that can be free of strain, of which they find a near one.
    tolerance : float
        On the residual.
    """

    def __init__(
        self,
        energy: Energy,
        held: Bool[np.ndarray, " n"] | None = None,
        pins: Pins | None = None,
        toward: Float[np.ndarray, "n d"] | None = None,
        curved: bool = True,
        tolerance: float = TOLERANCE,
    ) -> None:
        self.energy, self.curved, self.tolerance = energy, curved, tolerance
        # the larger one covers what rounding makes of the many motions that no rod resists
        self._least = LEAST_SHIFT if curved else 10 * LEAST_SHIFT
        self._pins = pins
        free = np.ones((energy.n_vertices, energy.dimension), bool)
        if held is not None:
            free[np.asarray(held, bool)] = False
        self._free = free if pins is None else free & ~pins.held(free.shape)
        numbers = np.full(free.shape, -1)
        numbers[self._free] = np.arange(int(self._free.sum()))
        self._stiffness, self._factors = energy.stiffness(numbers), Factors()
        self._toward = toward

    def with_torsion(self, torsion: float) -> Minimizer:
        """Return the same for another lambda, sharing order and pattern."""
        other = object.__new__(Minimizer)
        other.__dict__.update(self.__dict__)
        other.energy = self.energy.with_torsion(torsion)
        return other

    def with_tolerance(self, tolerance: float) -> Minimizer:
        """Return the same with another tolerance on the residual."""
        other = object.__new__(Minimizer)
        other.__dict__.update(self.__dict__)
        other.tolerance = tolerance
        return other

    def solve(
        self,
        start: Float[np.ndarray, "n d"],
        loading: Loading | None = None,
        max_steps: int = MAX_STEPS,
        near: Float[np.ndarray, "n d"] | None = None,
        enough: float = -np.inf,
    ) -> Equilibrium:
        """Minimize the energy.

        Parameters
        ----------
        start : (n, d)
            Held coordinates stay as they are here.
        loading : Loading, optional
        max_steps : int
        near : (n, d), optional
            A sheet that is pinned is in the end moved, as a whole, to where it lies nearest to these points, by
            default the start.
        enough : float
            Energy below which no more is sought.
        """
        loading, steps = loading or Loading(), 0
        place = np.asarray(start, float)
        axes = np.eye(place.shape[1]) if self._pins is None else self._pins.frame(place)
        points = place @ axes if self._pins is not None else place.copy()
        for _ in range(MAX_ESCAPES + 1):
            found, shift = self._descend(points, loading, max_steps - steps, enough)
            steps += found.steps
            if found.is_stable or not found.is_converged or steps >= max_steps:
                break
            points = self._pushed(found.points, loading, shift, axes)
        end = found.points
        if self._pins is not None:
            end = nearest_place(end, place if near is None else np.asarray(near, float))
        return replace(found, points=frozen(end), steps=steps)

    def is_saddle(self, points: Float[np.ndarray, "n d"]) -> bool:
        """Does nothing pull, and does the energy fall in one direction and in no other?"""
        at = np.asarray(points, float)
        state = self._state(at if self._pins is None else at @ self._pins.frame(at), Loading())
        return state.residual <= STILL and self._operator(state, self._least).n_negative == 1

    def _state(self, points: np.ndarray, loading: Loading) -> State:
        here = loaded(self.energy, points, loading, self.curved)
        gradient = here.gradient[self._free]
        return State(here, gradient, float(np.abs(gradient).max(initial=0.0)))

    def _descend(
        self, points: np.ndarray, loading: Loading, max_steps: int, enough: float
    ) -> tuple[Equilibrium, float]:
        length, unit = self.energy.length, self.energy.unit_force
        shift, step, is_convex = self._least, 0, not self.curved
        state, operator, is_fresh = self._state(points, loading), None, True
        while not (state.residual <= self.tolerance and is_convex) and np.isfinite(state.residual):
            if state.residual <= self.tolerance and state.total <= NOTHING:
                is_convex = True
                break
            if operator is None:
                # where nothing pulls, all that is left to know is whether this is a minimum
                shift = self._least if state.residual <= self.tolerance else shift
                operator, shift = self._convex(state, shift)
                is_fresh = True
                is_convex = operator is not None and (shift <= self._least or not self.curved)
            if operator is None or state.residual <= self.tolerance or step >= max_steps or state.total <= enough:
                break
            step += 1
            move = -operator.solve(state.gradient)
            move *= min(1.0, LONGEST / max(float(np.abs(move).max(initial=0.0)), 1e-300))
            trial = self._moved(points, length * move)
            there = self._state(trial, loading)
            expected = -0.5 * unit * length * float(state.gradient @ move)
            if there.total <= state.total - 0.01 * expected or self._is_nearer(there, state):
                # without curvature an old factor knows nothing of the motions that were free then
                keeps = shift <= self._least and self.curved and there.residual <= REUSED * state.residual
                points, state, is_fresh = trial, there, False
                operator = operator if keeps else None
                shift = shift / 8 if shift > 0.1 * FIRST_SHIFT else self._least
            else:
                if is_fresh:
                    shift = max(4 * shift, FIRST_SHIFT if self.curved else 1e-2 * FIRST_SHIFT)
                operator = None
        is_converged = state.residual <= self.tolerance
        return Equilibrium(points, state.here.energy, state.residual, step, is_converged, is_convex), shift

    def _is_nearer(self, there: State, state: State) -> bool:
        """Is a state nearer to equilibrium, where energies differ by no more than rounding?"""
        rounding = ROUNDING * (abs(state.total) + ROUNDING)
        return bool(there.residual < 0.5 * state.residual and there.total <= state.total + rounding)

    def _operator(self, state: State, shift: float) -> Operator:
        here = state.here
        # lengths in tile edges and forces in those of a rod with strain 1
        entries = self._stiffness.numbers(here.bends) * (self.energy.length / self.energy.unit_force)
        factor = self._factors.of(self._stiffness.matrix(entries, shift + here.pull))
        if here.slope is None or factor.n_negative < 0:
            return Operator(factor, None, None, 1.0)
        slope = here.slope[self._free]
        response = factor.solve(slope)
        return Operator(factor, slope, response, here.compliance + float(slope @ response))

    def _convex(self, state: State, shift: float) -> tuple[Operator | None, float]:
        """Factor with the given shift, or the first larger one that leaves no direction in which the energy falls."""
        while shift <= MOST_SHIFT:
            operator = self._operator(state, shift)
            # without curvature H is a sum of squares: negative pivots are rounding
            if operator.n_negative == 0 or (operator.n_negative > 0 and not self.curved):
                return operator, shift
            shift = max(4 * shift, FIRST_SHIFT)
        return None, shift

    def _pushed(self, points: np.ndarray, loading: Loading, shift: float, axes: np.ndarray) -> np.ndarray:
        """Points off a saddle, along the direction of least stiffness."""
        operator, _ = self._convex(self._state(points, loading), shift)
        if operator is None:
            return points
        side = np.random.default_rng(0).standard_normal(self._stiffness.size)
        if self._toward is not None:
            toward = (self._toward @ axes)[self._free]
            side = toward / np.linalg.norm(toward) + 0.1 * side / np.linalg.norm(side)
        mode = side
        for _ in range(INVERSE_STEPS):
            mode = operator.solve(mode)
            mode /= np.linalg.norm(mode)
        sign = -1.0 if mode @ side < 0 else 1.0
        return self._moved(points, sign * PUSH * self.energy.length / np.abs(mode).max() * mode)

    def _moved(self, points: np.ndarray, move: np.ndarray) -> np.ndarray:
        result = points.copy()
        result[self._free] += move
        return result
