"""Round every interior contracted vertex the tile angles sum to 2 pi."""

from __future__ import annotations

import numpy as np

from kirisurf.corner_angle import CornerAngles
from kirisurf.latest import Latest
from kirisurf.stencil import DistinctStencil
from kirisurf.tessellation import Tessellation
from kirisurf.vectors import gathered


class FullTurns:
    """One row for every ring of `size` corners, in radians."""

    n_rows = 1

    def __init__(self, tessellation: Tessellation, size: int) -> None:
        which, corners = tessellation.rings.by_size()[size]
        self.name = "angle"
        self.rings = which
        self._size = size
        self.curvature_stencil = tessellation.corners[corners.ravel()]
        self._distinct = DistinctStencil(self.curvature_stencil.reshape(len(which), 3 * size))
        self.stencil = self._distinct.vertices
        self._corners = Latest(self._corners_at)

    def _corners_at(self, points: np.ndarray) -> CornerAngles:
        return CornerAngles(gathered(points, self.curvature_stencil))

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Sum of angles minus 2 pi, (r, 1)."""
        return self._corners(points).angles.reshape(-1, self._size).sum(axis=1, keepdims=True) - 2 * np.pi

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (r, 1, 3 p) by the p vertices of a ring."""
        gradients = self._corners(points).gradients.transpose(2, 0, 1)
        return self._distinct.gathered(gradients.reshape(len(self.stencil), -1, 3))

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (r size, 9, 9)."""
        return self._corners(points).hessians(np.repeat(multipliers[:, 0], self._size))
