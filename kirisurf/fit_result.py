"""What a fit returns: the sheet in both states, with everything that led to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.feasibility import Feasibility
from kirisurf.prescribed import Prescribed
from kirisurf.states import Contracted, Fit
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class FitResult:
    """A fit with everything that led to it.

    Attributes
    ----------
    surface : Surface
        The target, consistently oriented.
    initial : (n, 3)
        Initial guess, in the target's units.
    fit : Fit
    contracted : Contracted
    notes, warnings : tuple of str
        The automatic choices with their reasons, and what needs to be read.
    seconds : mapping
        start, solve, contract.
    feasibility : Feasibility, optional
        What the target asks of the tessellation.
    boundary, contracted_boundary : Prescribed, optional
        The outlines that the deployed and the contracted sheet follow.
    freedom : int, optional
        Number of ways, to first order, in which the sheet can change without breaking a row; rigid motions do not
        count.
    """

    surface: Surface
    initial: Float[np.ndarray, "n 3"]
    fit: Fit
    contracted: Contracted
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: Mapping[str, float]
    feasibility: Feasibility | None = None
    boundary: Prescribed | None = None
    contracted_boundary: Prescribed | None = None
    freedom: int | None = None

    @property
    def tessellation(self) -> Tessellation:
        """The pattern's topology."""
        return self.fit.tessellation
