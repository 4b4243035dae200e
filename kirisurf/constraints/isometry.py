"""Both states have the same tiles: every edge and diagonal is as long in the one as in the other.

The unknowns are the deployed points and, behind them, one contracted point for every welded vertex. Sides of a slit
are then equally long, angles round a contracted point add up to full turns, and designed openings close, since
the contracted points are a sheet by themselves: no rows say so one by one, and none depends on the kind of tiles.
"""

from __future__ import annotations

import numpy as np

from kirisurf.tessellation import Tessellation
from kirisurf.triangulation import TriangulatedTiles
from kirisurf.vectors import dot, gathered

_FLAT = np.diag([1.0, 1.0, 0.0])
_STRETCH = 2 * np.kron([[1.0, -1.0], [-1.0, 1.0]], np.eye(3))
_FLAT_STRETCH = 2 * np.kron([[1.0, -1.0], [-1.0, 1.0]], _FLAT)


class IsometricTiles:
    """One row for every edge and diagonal: |x_a - x_b|^2 - |y_A - y_B|^2, over L^2; y are flat points."""

    name = "isometry"
    n_rows = 1

    def __init__(self, tessellation: Tessellation, triangulated: TriangulatedTiles) -> None:
        bars = np.concatenate([tessellation.tiles.edges, triangulated.diagonals[:, [0, 2]]])
        self.stencil = np.hstack([bars, tessellation.n_vertices + tessellation.weld[bars]])
        # the two states do not bend each other's lengths
        self.curvature_stencil = self.stencil.reshape(-1, 2)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Differences of squared lengths, (g, 1)."""
        a, b, c, d = gathered(points, self.stencil)
        deployed, contracted = a - b, (c - d)[:2]
        return (dot(deployed, deployed) - (contracted**2).sum(axis=0))[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 12)."""
        a, b, c, d = points.take(self.stencil.T, axis=0)
        deployed, contracted = 2 * (a - b), 2 * (d - c)
        contracted[:, 2] = 0.0
        return np.concatenate([deployed, -deployed, contracted, -contracted], axis=1)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (2 g, 6, 6): of the deployed and of the contracted bar in turn."""
        result = np.empty((len(multipliers), 2, 6, 6))
        result[:, 0] = multipliers[:, :, None] * _STRETCH
        result[:, 1] = -multipliers[:, :, None] * _FLAT_STRETCH
        return result.reshape(-1, 6, 6)
