"""Equilibria: minima of the energy with some vertices held, or with some linear measures of the sheet held."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.arrays import frozen
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.factor import Factor, numbered
from kirisurf.deployment.loading import Loaded, Loading, loaded, total_energy

TOLERANCE = 1e-10
"""Largest force on a free vertex at an equilibrium, over that of a rod with strain 1."""

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


@dataclass(frozen=True, eq=False)
class _State:
    """Where a step begins: the rows of what is held, and last, of compliance that is not 0, of what is loaded."""

    here: Loaded
    gradient: Float[np.ndarray, " q"]
    rows: Float[np.ndarray, "m q"]
    residual: float


class Minimizer:
    """Newton's method for one sheet with one kind of support; order and pattern of the matrix are found once.

    minimize E(x)  subject to  x_i = given for held vertices,  rows . x = given

    Each step solves with H + shift, the shift so large that the energy is convex where the sheet is free to move
    (read from the signs of the pivots), and is taken if the energy falls as the model says; else the shift grows
    (Levenberg, Marquardt). Where it would end at a saddle it is pushed off along the softest direction.

    Parameters
    ----------
    energy : Energy
    held : (n,) bool, optional
        Vertices that stay where the start has them.
    rows : (m, n, d), optional
        Linear measures of the points that keep the values of the start; orthonormal.
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
        rows: Float[np.ndarray, "m n d"] | None = None,
        toward: Float[np.ndarray, "n d"] | None = None,
        curved: bool = True,
        tolerance: float = TOLERANCE,
    ) -> None:
        n, d = energy.n_vertices, energy.dimension
        self.energy, self.curved, self.tolerance = energy, curved, tolerance
        # the larger one covers what rounding makes of the many motions that no rod resists
        self._least = LEAST_SHIFT if curved else 10 * LEAST_SHIFT
        self.free = np.ones(n, bool) if held is None else ~np.asarray(held, bool)
        numbers = numbered(energy.elements, self.free, d)
        self._stiffness = energy.stiffness(numbers)
        self._which = np.argsort(numbers[self.free].ravel())
        self._rows = np.zeros((0, self._stiffness.size)) if rows is None else np.stack([self._packed(r) for r in rows])
        self._toward = None if toward is None else self._packed(toward)

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
        self, start: Float[np.ndarray, "n d"], loading: Loading | None = None, max_steps: int = MAX_STEPS
    ) -> Equilibrium:
        """Minimize from a start, whose held vertices and measures are those given."""
        loading, steps = loading or Loading(), 0
        points = np.array(start, float)
        for _ in range(MAX_ESCAPES + 1):
            found, shift = self._descend(points, loading, max_steps - steps)
            steps += found.steps
            if found.is_stable or not found.is_converged or steps >= max_steps:
                break
            points = self._pushed(found.points, loading, shift)
        return replace(found, points=frozen(found.points), steps=steps)

    def is_saddle(self, points: Float[np.ndarray, "n d"]) -> bool:
        """Does the energy fall in one direction and in no other, where the sheet is free to move?"""
        state = self._state(points, Loading())
        factor = Factor(self._stiffness.matrix(self._entries(state), self._least))
        below = (np.linalg.eigvalsh(self._bordered(factor, state)[1]) < 0).sum() if len(state.rows) else 0
        return factor.n_negative - int(below) == 1

    def _state(self, points: np.ndarray, loading: Loading) -> _State:
        here = loaded(self.energy, points, loading, self.curved)
        gradient, rows = self._packed(here.gradient), self._rows
        residual = float(np.abs(gradient - (rows @ gradient) @ rows).max(initial=0.0))
        if here.slope is not None:
            rows = np.concatenate([rows, self._packed(here.slope)[None]])
        return _State(here, gradient, rows, residual)

    def _entries(self, state: _State) -> np.ndarray:
        """Entries of the matrix, lengths in tile edges and forces in those of a rod with strain 1."""
        return self._stiffness.numbers(state.here.bends) * (self.energy.length / self.energy.unit_force)

    def _descend(self, points: np.ndarray, loading: Loading, max_steps: int) -> tuple[Equilibrium, float]:
        length, unit = self.energy.length, self.energy.unit_force
        shift, step, is_convex = self._least, 0, not self.curved
        state, factor = self._state(points, loading), None
        while not (state.residual <= self.tolerance and is_convex) and np.isfinite(state.residual):
            if factor is None:
                factor, shift = self._factored(state, shift)
                is_convex = factor is not None and (shift <= self._least or not self.curved)
            if factor is None or state.residual <= self.tolerance or step >= max_steps:
                break
            step += 1
            move = self._move(factor, state, state.gradient)
            move *= min(1.0, LONGEST / max(float(np.abs(move).max(initial=0.0)), 1e-300))
            trial = points + length * self._unpacked(move)
            expected = -0.5 * unit * length * float(state.gradient @ move)
            slack = 1e-15 * abs(state.here.total) + 1e-30
            if total_energy(self.energy, trial, loading) <= state.here.total - 0.01 * expected + slack:
                before, points = state.residual, trial
                state = self._state(points, loading)
                # without curvature an old factor knows nothing of the motions that were free then
                if shift > self._least or not self.curved or state.residual > REUSED * before:
                    factor = None
                shift = shift / 8 if shift > 0.1 * FIRST_SHIFT else self._least
            else:
                shift, factor = max(4 * shift, FIRST_SHIFT if self.curved else 1e-2 * FIRST_SHIFT), None
        is_converged = state.residual <= self.tolerance
        return Equilibrium(points, state.here.energy, state.residual, step, is_converged, is_convex), shift

    def _factored(self, state: _State, shift: float) -> tuple[Factor | None, float]:
        """Factor with the given shift, or the first larger one that leaves no direction in which the energy falls."""
        entries = self._entries(state)
        while shift <= MOST_SHIFT:
            factor = Factor(self._stiffness.matrix(entries, shift + state.here.pull))
            if factor.n_negative >= 0 and not self.curved:
                return factor, shift  # a sum of squares: negative pivots are rounding
            if 0 <= factor.n_negative <= len(state.rows):
                # by the inertia of the bordered matrix
                below = (np.linalg.eigvalsh(self._bordered(factor, state)[1]) < 0).sum() if len(state.rows) else 0
                if int(below) == factor.n_negative:
                    return factor, shift
            shift = max(4 * shift, FIRST_SHIFT)
        return None, shift

    def _bordered(self, factor: Factor, state: _State) -> tuple[np.ndarray, np.ndarray]:
        """Response to the rows (q, m), and their compliance (m, m)."""
        response = factor.solve(np.ascontiguousarray(state.rows.T))
        compliance = state.rows @ response
        compliance[-1, -1] += state.here.compliance
        return response, 0.5 * (compliance + compliance.T)

    def _move(self, factor: Factor, state: _State, gradient: np.ndarray) -> np.ndarray:
        move = -factor.solve(gradient)
        if len(state.rows):
            response, compliance = self._bordered(factor, state)
            move -= response @ np.linalg.solve(compliance, state.rows @ move)
        return move

    def _pushed(self, points: np.ndarray, loading: Loading, shift: float) -> np.ndarray:
        """Points off a saddle, along the direction of least stiffness."""
        state = self._state(points, loading)
        factor, _ = self._factored(state, shift)
        if factor is None:
            return points
        side = np.random.default_rng(0).standard_normal(self._stiffness.size)
        if self._toward is not None:
            side = self._toward / np.linalg.norm(self._toward) + 0.1 * side / np.linalg.norm(side)
        mode = side
        for _ in range(INVERSE_STEPS):
            mode = self._move(factor, state, -mode)
            mode /= np.linalg.norm(mode)
        sign = -1.0 if mode @ side < 0 else 1.0
        return points + self._unpacked(sign * PUSH * self.energy.length / np.abs(mode).max() * mode)

    def _packed(self, values: np.ndarray) -> np.ndarray:
        return values[self.free].ravel()[self._which]

    def _unpacked(self, values: np.ndarray) -> np.ndarray:
        inner = np.empty(len(values))
        inner[self._which] = values
        result = np.zeros((self.energy.n_vertices, self.energy.dimension))
        result[self.free] = inner.reshape(-1, self.energy.dimension)
        return result
