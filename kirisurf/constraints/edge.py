"""No tile edge is too short: |e|^2 / L^2 >= smallest^2."""

from __future__ import annotations

import numpy as np

from kirisurf.tessellation import Tessellation
from kirisurf.vectors import dot, gathered

SQUARED_LENGTH_HESSIAN = 2 * np.kron([[1.0, -1.0], [-1.0, 1.0]], np.eye(3))
"""Second derivatives (6, 6) of |a - b|^2 by the points a and b."""


class LongEdges:
    """One inequality row for every tile edge; points are in units of the tile edge L."""

    name = "edge"
    n_rows = 1

    def __init__(self, tessellation: Tessellation, smallest: float) -> None:
        self.stencil = tessellation.tiles.edges
        self.curvature_stencil = self.stencil
        self._smallest = smallest

    def residual(self, points: np.ndarray) -> np.ndarray:
        """|e|^2 - smallest^2, (s, 1): not negative where allowed."""
        begin, end = gathered(points, self.stencil)
        edge = end - begin
        return dot(edge, edge)[:, None] - self._smallest**2

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (s, 1, 6)."""
        begin, end = points.take(self.stencil.T, axis=0)
        edge = 2 * (end - begin)
        return np.concatenate([-edge, edge], axis=1)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (s, 6, 6)."""
        return multipliers[:, :, None] * SQUARED_LENGTH_HESSIAN
