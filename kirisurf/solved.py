"""A solved fit, before its sheet is contracted: what the solvers of curved and of planar targets both return."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.feasibility import Feasibility
from kirisurf.prescribed import Prescribed
from kirisurf.solvers.outcome import Outcome
from kirisurf.states import Step
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Solved:
    """The deployed sheet and how it was found.

    Attributes
    ----------
    tessellation : Tessellation
    initial, points : (n, 3)
        Start and result, in the target's units.
    edge_length : float
        The solver's unit of length.
    outcome : Outcome
    notes, warnings : tuple of str
    started : float
        When the solve began, by `time.perf_counter`.
    feasibility : Feasibility, optional
    boundary : Prescribed, optional
        The outline that the deployed sheet follows.
    contracted : (n, 2), optional
        Where the contracted sheet was laid, in the target's units.
    prescribed : callable, optional
        Returns the outline that the contracted sheet follows, from its points (n, 2).
    freedom : int, optional
    """

    tessellation: Tessellation
    initial: Float[np.ndarray, "n 3"]
    points: Float[np.ndarray, "n 3"]
    edge_length: float
    outcome: Outcome
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    started: float
    feasibility: Feasibility | None = None
    boundary: Prescribed | None = None
    contracted: Float[np.ndarray, "n 2"] | None = None
    prescribed: Callable[[np.ndarray], Prescribed] | None = None
    freedom: int | None = None

    @property
    def history(self) -> tuple[Step, ...]:
        """Steps of all solves."""
        return self.outcome.history
