"""Tiles with more than three corners are flat: volumes of tetrahedra of their corners vanish."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int

from kirisurf.latest import Latest
from kirisurf.vectors import add_origin, cross, dot, gathered


class FlatTiles:
    """One row for every diagonal of a tile: det(b - a, c - a, d - a) over its ends a, c and the corners b, d, over L^3.

    Parameters
    ----------
    diagonals : (g, 4) int
        (a, b, c, d), see :class:`kirisurf.triangulation.TriangulatedTiles`: k - 3 for a tile of k corners.
    """

    name = "planarity"
    n_rows = 1

    def __init__(self, diagonals: Int[np.ndarray, "g 4"]) -> None:
        self.stencil = np.asarray(diagonals, dtype=np.int64)
        self.curvature_stencil = self.stencil
        self._edges = Latest(self._edges_at)

    def _edges_at(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        a, b, c, d = gathered(points, self.stencil)
        u, v, w = b - a, c - a, d - a
        return u, v, w, cross(v, w)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Signed volumes, (rows, 1)."""
        u, _, _, du = self._edges(points)
        return dot(u, du)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (rows, 1, 12)."""
        u, v, w, du = self._edges(points)
        dv, dw = cross(w, u), cross(u, v)
        return np.concatenate([-du - dv - dw, du, dv, dw])[None].transpose(2, 0, 1)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (rows, 12, 12)."""
        u, v, w, _ = self._edges(points)
        full = np.zeros((4, 3, 4, 3, len(multipliers)))
        # the gradient with respect to u is v x w: its derivative by w is [v x], by v is -[w x]
        for i, j, vector in ((1, 3, v), (3, 2, u), (2, 1, w)):
            x, y, z = multipliers[:, 0] * vector
            for row, column, value in ((2, 1, x), (0, 2, y), (1, 0, z)):
                full[i, row, j, column] = full[j, column, i, row] = value
                full[i, column, j, row] = full[j, row, i, column] = -value
        return add_origin(full)
