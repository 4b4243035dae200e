"""No tile edge is too short: |e|^2 / L^2 >= smallest^2."""

from __future__ import annotations

import numpy as np

from kirisurf.block import difference_matrix
from kirisurf.tessellation import Tessellation

_HESSIAN = 2 * difference_matrix(0, 1, 2).T @ difference_matrix(0, 1, 2)


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
        edge = points[self.stencil[:, 1]] - points[self.stencil[:, 0]]
        return np.einsum("ki,ki->k", edge, edge)[:, None] - self._smallest**2

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (s, 1, 6)."""
        edge = 2 * (points[self.stencil[:, 1]] - points[self.stencil[:, 0]])
        return np.concatenate([-edge, edge], axis=1)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (s, 6, 6)."""
        return multipliers[:, 0, None, None] * _HESSIAN
