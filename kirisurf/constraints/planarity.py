"""Tiles with more than three corners are flat: volumes of successive tetrahedra vanish."""

from __future__ import annotations

import numpy as np

from kirisurf.block import cross_matrix
from kirisurf.tessellation import Tessellation


class FlatTiles:
    """k - 3 rows for every tile of k corners: det(b - a, c - a, d - a) over a and three more corners, over L^3."""

    name = "planarity"
    n_rows = 1

    def __init__(self, tessellation: Tessellation, size: int) -> None:
        _, tiles = tessellation.tiles.by_size()[size]
        # (a, b, c, d) = first corner and three consecutive ones, so that each row adds one corner
        stencils = [tiles[:, [0, k, k + 1, k + 2]] for k in range(1, size - 2)]
        self.stencil = np.concatenate(stencils)
        self.curvature_stencil = self.stencil

    def _edges(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        a, b, c, d = np.moveaxis(points[self.stencil], 1, 0)
        return b - a, c - a, d - a

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Signed volumes, (rows, 1)."""
        u, v, w = self._edges(points)
        return np.einsum("ki,ki->k", u, np.cross(v, w))[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (rows, 1, 12)."""
        u, v, w = self._edges(points)
        du, dv, dw = np.cross(v, w), np.cross(w, u), np.cross(u, v)
        return np.concatenate([-du - dv - dw, du, dv, dw], axis=1)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (rows, 12, 12)."""
        u, v, w = self._edges(points)
        full = np.zeros((len(u), 12, 12))
        # the gradient with respect to u is v x w: its derivative by w is [v x], by v is -[w x]
        for i, j, vector in ((1, 3, v), (3, 2, u), (2, 1, w)):
            block = cross_matrix(vector)
            full[:, 3 * i : 3 * i + 3, 3 * j : 3 * j + 3] = block
            full[:, 3 * j : 3 * j + 3, 3 * i : 3 * i + 3] = np.swapaxes(block, 1, 2)
        # the volume depends on differences only: rows and columns of the first corner follow
        first = -(full[:, 3:6] + full[:, 6:9] + full[:, 9:12])
        full[:, 0:3] = first
        full[:, :, 0:3] = -(full[:, :, 3:6] + full[:, :, 6:9] + full[:, :, 9:12])
        return multipliers[:, 0, None, None] * full
