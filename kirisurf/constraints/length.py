"""The two copies of a slit edge have one length: (|e1|^2 - |e2|^2) / L^2 = 0."""

from __future__ import annotations

import numpy as np

from kirisurf.constraints.edge import SQUARED_LENGTH_HESSIAN
from kirisurf.stencil import DistinctStencil
from kirisurf.tessellation import Tessellation
from kirisurf.vectors import dot, gathered


class EqualLengths:
    """One row for every slit edge; points are in units of the tile edge."""

    name = "length"
    n_rows = 1

    def __init__(self, tessellation: Tessellation) -> None:
        # where the two copies meet in a hinge, they share a vertex
        self._ends = tessellation.edge_pairs.reshape(-1, 4)
        self._distinct = DistinctStencil(self._ends)
        self.stencil = self._distinct.vertices
        # the two edges do not bend each other's length
        self.curvature_stencil = tessellation.edge_pairs.reshape(-1, 2)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """|e1|^2 - |e2|^2, (e, 1)."""
        a, b, c, d = gathered(points, self._ends)
        first, second = a - b, c - d
        return (dot(first, first) - dot(second, second))[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (e, 1, 3 p) by the p different ends."""
        a, b, c, d = points.take(self._ends.T, axis=0)
        first, second = 2 * (a - b), 2 * (d - c)
        return self._distinct.gathered(np.stack([first, -first, second, -second], axis=1))

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (2 e, 6, 6): of both edges of every pair."""
        return (multipliers * [1.0, -1.0]).reshape(-1, 1, 1) * SQUARED_LENGTH_HESSIAN
