"""From the regular pattern to a prescribed outline, in steps each of which starts at a sheet that fits.

The regular pattern in its most open state meets every row for the rectangle that it fills, and contracted it is a
sheet too. The rectangle is then bent into the outline, side by side, and so is, where one is prescribed, that of
the contracted sheet; the sheet follows, predicted by the displacement of a patch over the four sides (Coons 1967).
Why not at once: the tiles have many more ways to be wrong than to be right. Of the 46 published planar designs the
direct way finds 41, this one all, and smoother ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.contracted_shape import ContractedShape
from kirisurf.formulation import Weights
from kirisurf.four_sides import between, patch
from kirisurf.outline_rows import FollowsOutline, OutlineRows
from kirisurf.outlines import Outline
from kirisurf.problem import Problem, Term
from kirisurf.rim import Rim, rectangle_rim
from kirisurf.tessellation import Tessellation
from kirisurf.two_states import Shape, TwoStates


@dataclass(frozen=True, eq=False)
class Morph:
    """A family of problems from the regular pattern (0) to the prescribed outline (1).

    Lengths are in tile edges of the regular pattern.

    Attributes
    ----------
    tessellation : Tessellation
        Rectangular; its deployed layout is the regular pattern.
    layout : (n, 2)
        The regular pattern deployed, at the size and place at which its rectangle has the outline's area and middle.
    outline : Outline
        With four sides: bottom, right, top, left.
    contracted : ContractedShape
    shape : Shape
    inside : bool
        Whether no other vertex may lie outside the outline.
    words : str
    """

    tessellation: Tessellation
    layout: Float[np.ndarray, "n 2"]
    outline: Outline
    contracted: ContractedShape
    shape: Shape
    inside: bool = True
    words: str = "the regular pattern was bent into the outline"

    @property
    def rim(self) -> Rim:
        """The tips that follow the outline."""
        return rectangle_rim(self.layout)

    def outline_at(self, t: float) -> Outline:
        """Return the outline at t: every side is t times the prescribed one and 1 - t times the rectangle's."""
        low, high = self.layout.min(axis=0), self.layout.max(axis=0)
        return between(low, high, self.outline, t)

    def start(self) -> Float[np.ndarray, "q 3"]:
        """Return the regular pattern: deployed, contracted, and what the contracted outline needs."""
        n = len(self.layout)
        return np.concatenate(
            [np.column_stack([self.layout, np.zeros(n)]), self.contracted.start(self.tessellation, self._scale)]
        )

    def moved(self, points: Float[np.ndarray, "q 3"], t: float, to: float) -> Float[np.ndarray, "q 3"]:
        """Return points of the problem at t, displaced as the patches over the outlines are on the way from t."""
        n, result = len(self.layout), points.copy()
        low, high = self.layout.min(axis=0), self.layout.max(axis=0)
        place = (self.layout - low) / (high - low)
        result[:n, :2] += patch(self.outline_at(to), place) - patch(self.outline_at(t), place)
        return self.contracted.moved(result, self.tessellation, t, to)

    def at(
        self, start: np.ndarray, t: float, weights: Weights, wishes: tuple[Term, ...] = ()
    ) -> Callable[[np.ndarray], Problem]:
        """Return the problem at t, held near `start`."""
        others = np.setdiff1d(self.tessellation.outline, self.rim.vertices) if self.inside else self.rim.vertices[:0]
        rows: tuple[OutlineRows, ...] = (FollowsOutline("boundary", self.rim, others, self.outline_at(t), start),)
        rows += self.contracted.rows(self.tessellation, t)
        return TwoStates(self.tessellation, start, None, weights, self.shape, rows, wishes).problem_at

    @property
    def _scale(self) -> float:
        """Size of the layout over that of the tessellation's own."""
        return float(np.ptp(self.layout[:, 0]) / np.ptp(self.tessellation.deployed[:, 0]))
