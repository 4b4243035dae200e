"""What a step of Newton's method is made of: the state that it begins at, and the operator that it solves with."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.deployment.energy import Energy
from kirisurf.deployment.factor import Factor, Factors
from kirisurf.deployment.loading import Loaded, Loading, loaded
from kirisurf.deployment.stiffness import Stiffness

LEAST_SHIFT = 1e-9
"""Multiple of the identity that is always added: what no rod holds stays where it is."""

FIRST_SHIFT, MOST_SHIFT = 1e-4, 1e6
RAISED = 4.0
"""Factor by which a shift grows."""

INVERSE_STEPS = 30
"""Steps of inverse iteration that find the softest direction."""


@dataclass(frozen=True, eq=False)
class State:
    """Where a step begins."""

    here: Loaded
    gradient: Float[np.ndarray, " q"]
    residual: float

    @property
    def total(self) -> float:
        """The energy that is minimized."""
        return self.here.total


@dataclass(frozen=True, eq=False)
class Operator:
    """Second derivatives of the energy and of its loading, factored: H + s s' / compliance, s the load's slope."""

    factor: Factor
    slope: Float[np.ndarray, " q"] | None
    response: Float[np.ndarray, " q"] | None
    compliance: float

    @property
    def n_negative(self) -> int:
        """Negative eigenvalues, by the inertia of the bordered matrix; -1 where the factorization failed."""
        return self.factor.n_negative - int(self.factor.n_negative >= 0 and self.compliance < 0)

    def solve(self, right: Float[np.ndarray, " q"]) -> Float[np.ndarray, " q"]:
        """Return x with (H + s s' / compliance) x = right."""
        x = self.factor.solve(right)
        if self.slope is not None and self.response is not None:
            x -= self.response * ((self.slope @ x) / self.compliance)
        return x


@dataclass(frozen=True, eq=False)
class Problem:
    """An energy by the coordinates that are free, lengths in tile edges and forces in those of a rod with strain 1.

    Attributes
    ----------
    energy : Energy
    free : (n, d) bool
        Coordinates that are not held.
    tolerance : float
        On the residual.
    curved : bool
        False for steps of Gauss and Newton: for sheets that can be free of strain, of which they find a near one.
    stiffness : Stiffness
        Pattern of the second derivatives by the free coordinates.
    factors : Factors
    """

    energy: Energy
    free: Bool[np.ndarray, "n d"]
    tolerance: float
    curved: bool
    stiffness: Stiffness
    factors: Factors = field(default_factory=Factors)

    @property
    def least_shift(self) -> float:
        """The shift that is always there: large enough for what rounding makes of motions that no rod resists."""
        return LEAST_SHIFT if self.curved else 10 * LEAST_SHIFT

    @property
    def first_shift(self) -> float:
        """The shift after the least one."""
        return FIRST_SHIFT if self.curved else 1e-2 * FIRST_SHIFT

    def state(self, points: Float[np.ndarray, "n d"], loading: Loading) -> State:
        """Return the energy with its derivatives at one set of points."""
        here = loaded(self.energy, points, loading, self.curved)
        gradient = here.gradient[self.free]
        return State(here, gradient, float(np.abs(gradient).max(initial=0.0)))

    def moved(self, points: Float[np.ndarray, "n d"], move: Float[np.ndarray, " q"]) -> Float[np.ndarray, "n d"]:
        """Return points with their free coordinates moved, the move in tile edges."""
        result = points.copy()
        result[self.free] += self.energy.length * move
        return result

    def work(self, state: State, move: Float[np.ndarray, " q"]) -> float:
        """Return what a move adds to the energy to first order."""
        return self.energy.unit_force * self.energy.length * float(state.gradient @ move)

    def operator(self, state: State, shift: float) -> Operator:
        """Factor the second derivatives with a multiple of the identity added."""
        here = state.here
        entries = self.stiffness.numbers(here.bends) * (self.energy.length / self.energy.unit_force)
        factor = self.factors.of(self.stiffness.matrix(entries, shift + here.pull))
        if here.slope is None or factor.n_negative < 0:
            return Operator(factor, None, None, 1.0)
        slope = here.slope[self.free]
        response = factor.solve(slope)
        return Operator(factor, slope, response, here.compliance + float(slope @ response))

    def convex(self, state: State, shift: float) -> tuple[Operator | None, float]:
        """Factor with the given shift, or the first larger one that leaves no direction in which the energy falls."""
        while shift <= MOST_SHIFT:
            operator = self.operator(state, shift)
            # without curvature H is a sum of squares: negative pivots are rounding
            if operator.n_negative == 0 or (operator.n_negative > 0 and not self.curved):
                return operator, shift
            shift = max(RAISED * shift, FIRST_SHIFT)
        return None, shift


def softest(operator: Factor | Operator, side: Float[np.ndarray, " q"]) -> Float[np.ndarray, " q"]:
    """Return the direction of least stiffness, of length 1, by inverse iteration from a start that is not 0."""
    mode = side
    for _ in range(INVERSE_STEPS):
        mode = operator.solve(mode)
        mode /= np.linalg.norm(mode)
    return mode
