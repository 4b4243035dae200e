"""What every solver returns, and how it speaks while it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from kirisurf.problem import Problem
from kirisurf.states import Step
from kirisurf.status import Status


@dataclass(frozen=True, eq=False)
class Outcome:
    """Best point of a solve.

    Attributes
    ----------
    points : (n, 3)
        In units of the tile edge.
    status : Status
    history : tuple of Step
    """

    points: np.ndarray
    status: Status
    history: tuple[Step, ...] = field(default=())


@dataclass(frozen=True)
class Limits:
    """When a solve ends.

    Attributes
    ----------
    tolerance : float
        Largest equality row.
    optimality : float
        Largest entry of the gradient of the Lagrangian.
    max_steps : int
    max_seconds : float
    """

    tolerance: float = 1e-11
    optimality: float = 1e-8
    max_steps: int = 120
    max_seconds: float = float("inf")


Progress = Callable[[Step], None]
ShouldStop = Callable[[], bool]
Refresh = Callable[[np.ndarray], Problem]
"""Returns the problem with its model of the target renewed at the given points; stencils stay the same."""
