"""From a trimmed pattern inside an outline to one whose tips lie on it, in steps each of which starts at a sheet.

The regular pattern, laid and trimmed, is a sheet; its tips lie at some distances from the outline. These distances
shrink to zero together, and the tips nearest to the outline's corners move to the corners.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.formulation import Weights
from kirisurf.outline_rows import ApproachesOutline
from kirisurf.outlines import Outline
from kirisurf.problem import Problem, Term
from kirisurf.rim import Rim
from kirisurf.tessellation import Tessellation
from kirisurf.two_states import Shape, TwoStates


@dataclass(frozen=True, eq=False)
class Approach:
    """A family of problems from the laid pattern (0) to one on the outline (1), in tile edges.

    Attributes
    ----------
    tessellation : Tessellation
    laid : (q, 3)
        The laid pattern: deployed, then contracted.
    outline : Outline
    rim : Rim
        Tips, without sides.
    pinned : (c,)
        The tip of every corner of the outline.
    shape : Shape
    inside : bool
        Whether no other vertex may lie farther outside the outline than laid.
    words : str
    """

    tessellation: Tessellation
    laid: Float[np.ndarray, "q 3"]
    outline: Outline
    rim: Rim
    pinned: Int[np.ndarray, " c"]
    shape: Shape
    inside: bool = True
    words: str = "the tips of the trimmed pattern were moved to the outline"

    def start(self) -> Float[np.ndarray, "q 3"]:
        """Return the laid pattern."""
        return self.laid

    def moved(self, points: Float[np.ndarray, "q 3"], t: float, to: float) -> Float[np.ndarray, "q 3"]:
        """Return points as they are: tips are few, and take the tiles behind them along."""
        return points

    def at(
        self, start: np.ndarray, t: float, weights: Weights, wishes: tuple[Term, ...] = ()
    ) -> Callable[[np.ndarray], Problem]:
        """Return the problem at t, held near `start`."""
        tips = self.rim.vertices[~np.isin(self.rim.vertices, self.pinned)]
        offsets = (1 - t) * self.outline.project(self.laid[tips, :2]).distances
        places = (1 - t) * self.laid[self.pinned, :2] + t * self.outline.corners[: len(self.pinned)]
        others = np.setdiff1d(self.tessellation.outline, self.rim.vertices) if self.inside else self.rim.vertices[:0]
        most = np.maximum((1 - t) * self.outline.project(self.laid[others, :2]).distances, 0.0)
        rows = ApproachesOutline("boundary", tips, others, offsets, most, self.outline, self.pinned, places)
        return TwoStates(self.tessellation, start, None, weights, self.shape, (rows,), wishes).problem_at
