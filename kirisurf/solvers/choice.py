"""Which solver a name stands for."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from kirisurf.problem import Problem
from kirisurf.solvers.interior_point import InteriorPoint
from kirisurf.solvers.ipopt import Ipopt
from kirisurf.solvers.outcome import Limits, Outcome, Progress, Refresh, ShouldStop
from kirisurf.solvers.rounds import Method, Peer
from kirisurf.solvers.scipy_peers import ScipyMethod
from kirisurf.solvers.uno import Uno

METHODS: dict[str, Method] = {
    "slsqp": ScipyMethod("slsqp"),
    "trust-constr": ScipyMethod("trust-constr"),
    "ipopt": Ipopt(),
    "uno": Uno(),
}


@runtime_checkable
class Solver(Protocol):
    """Solves problems; configuration only."""

    def solve(
        self,
        problem: Problem,
        start: np.ndarray,
        refresh: Refresh | None = None,
        progress: Progress | None = None,
        should_stop: ShouldStop | None = None,
    ) -> Outcome:
        """Solve from a start (n, 3) in tile edges."""
        ...


def default_steps(name: str) -> int:
    """Return the limit of steps that suits a solver: first-order starts and dense updates need more."""
    return {"slsqp": 500, "trust-constr": 2000, "ipopt": 500, "uno": 500}.get(name, Limits.max_steps)


def make_solver(name: str, limits: Limits) -> Solver:
    """Return the solver of a name: auto and newton are the project's own, the others peers for comparison."""
    return Peer(METHODS[name], limits) if name in METHODS else InteriorPoint(limits)
