"""What a step of Newton's method is made of: the state that it begins at, and the operator that it solves with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.deployment.factor import Factor
from kirisurf.deployment.loading import Loaded


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
