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


MOST_RENEWALS = 20
"""How often a converged solve goes on with a renewed model of the target."""
HONEST = 0.02
"""Relative difference of the objective below which the renewed model says what the frozen one said."""


def agree(renewed: float, frozen: float, honest: float = HONEST) -> bool:
    """Are the objectives of a renewed and of a frozen model of the target the same at a solution?"""
    return abs(renewed - frozen) <= honest * abs(frozen) + 1e-14


def longest_displacement(displacements: np.ndarray) -> float:
    """Largest length of the displacements (3 n,) or (n, 3) of vertices, whatever the directions of the axes."""
    return float(np.sqrt((displacements.reshape(-1, 3) ** 2).sum(axis=1).max(initial=0.0)))


Progress = Callable[[Step], None]
ShouldStop = Callable[[], bool]
Refresh = Callable[[np.ndarray], Problem]
"""Returns the problem with its model of the target renewed at the given points; stencils stay the same."""
