"""Equilibria: minima of the energy of a sheet, free or with some of its vertices held."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.arrays import frozen
from kirisurf.deployment.descent import Descent
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.guide import nearest_place
from kirisurf.deployment.loading import Loading
from kirisurf.deployment.newton import Problem, softest

TOLERANCE = 1e-10
"""Largest force on a free vertex at an equilibrium, over that of a rod with strain 1."""

STILL = 1e-7
"""Largest force on a free vertex at a saddle, which is found by the opening at which its load vanishes."""

MAX_STEPS = 200
MAX_ESCAPES = 4
PUSH = 0.02
"""How far a sheet is pushed off a saddle, in tile edges."""


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

    It descends (:class:`kirisurf.deployment.descent.Descent`), and where it would end at a saddle it is pushed off
    along the softest direction.

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
        free = np.ones((energy.n_vertices, energy.dimension), bool)
        if held is not None:
            free[np.asarray(held, bool)] = False
        if pins is not None:
            free &= ~pins.held(free.shape)
        numbers = np.full(free.shape, -1)
        numbers[free] = np.arange(int(free.sum()))
        self._problem = Problem(energy, free, tolerance, curved, energy.stiffness(numbers))
        self._pins, self._toward = pins, toward

    @property
    def energy(self) -> Energy:
        """What is minimized."""
        return self._problem.energy

    def with_torsion(self, torsion: float) -> Minimizer:
        """Return the same for another lambda, sharing order and pattern."""
        return self._with(replace(self._problem, energy=self.energy.with_torsion(torsion)))

    def with_tolerance(self, tolerance: float) -> Minimizer:
        """Return the same with another tolerance on the residual."""
        return self._with(replace(self._problem, tolerance=tolerance))

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
            found = Descent(self._problem, points, loading)
            found.run(max_steps - steps, enough)
            steps += found.steps
            if found.is_stable or not found.is_balanced or steps >= max_steps:
                break
            points = self._pushed(found, axes)
        end = found.points
        if self._pins is not None:
            end = nearest_place(end, place if near is None else np.asarray(near, float))
        state = found.state
        return Equilibrium(frozen(end), state.here.energy, state.residual, steps, found.is_balanced, found.is_stable)

    def is_saddle(self, points: Float[np.ndarray, "n d"]) -> bool:
        """Does nothing pull, and does the energy fall in one direction and in no other?"""
        at = np.asarray(points, float)
        state = self._problem.state(at if self._pins is None else at @ self._pins.frame(at), Loading())
        return state.residual <= STILL and self._problem.operator(state, self._problem.least_shift).n_negative == 1

    def _with(self, problem: Problem) -> Minimizer:
        other = object.__new__(Minimizer)
        other._problem, other._pins, other._toward = problem, self._pins, self._toward
        return other

    def _pushed(self, found: Descent, axes: Float[np.ndarray, "d d"]) -> Float[np.ndarray, "n d"]:
        """Points off a saddle, along the direction of least stiffness."""
        problem = self._problem
        operator, _ = problem.convex(found.state, found.shift)
        if operator is None:
            return found.points
        side = np.random.default_rng(0).standard_normal(problem.stiffness.size)
        if self._toward is not None:
            toward = (self._toward @ axes)[problem.free]
            side = toward / np.linalg.norm(toward) + 0.1 * side / np.linalg.norm(side)
        mode = softest(operator, side)
        sign = -1.0 if mode @ side < 0 else 1.0
        return problem.moved(found.points, sign * PUSH / np.abs(mode).max() * mode)
