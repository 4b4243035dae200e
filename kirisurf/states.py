"""What a solve returns, and what a contraction returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from kirisurf.status import Status
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Step:
    """One accepted step of a solver.

    Attributes
    ----------
    residuals : mapping
        Largest residual of every constraint block, dimensionless.
    objective : float
    optimality : float
        Largest entry of the gradient of the Lagrangian.
    step_length : float
        Largest displacement of a vertex over the tile edge.
    seconds : float
        Since the start of the solve.
    """

    residuals: Mapping[str, float]
    objective: float
    optimality: float
    step_length: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Fit:
    """A deployed state of a tessellation.

    Attributes
    ----------
    tessellation : Tessellation
    points : (n, 3)
        Deployed vertices in the target's units and frame.
    edge_length : float
        The length scale L used by the solver (median tile edge of the start), in the target's units.
    status : Status
    history : tuple of Step
    """

    tessellation: Tessellation
    points: Float[np.ndarray, "n 3"]
    edge_length: float
    status: Status
    history: tuple[Step, ...] = field(default=())


@dataclass(frozen=True, eq=False)
class Contracted:
    """The flat, closed state of a fit.

    Attributes
    ----------
    points : (n, 2)
        Contracted vertices; copies of a welded vertex coincide up to `gap`.
    gap : (n,)
        Distance of every vertex to the mean of its welded copies, in the target's units.
    """

    points: Float[np.ndarray, "n 2"]
    gap: Float[np.ndarray, " n"]
