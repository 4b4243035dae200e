"""Round every interior contracted vertex the tile angles sum to 2 pi."""

from __future__ import annotations

import numpy as np

from kirisurf.corner_angle import corner_angles, corner_gradients, corner_hessians
from kirisurf.tessellation import Tessellation


class FullTurns:
    """One row for every ring of `size` corners, in radians."""

    n_rows = 1

    def __init__(self, tessellation: Tessellation, size: int) -> None:
        which, corners = tessellation.rings.by_size()[size]
        self.name = "angle"
        self.rings = which
        self._size = size
        self.curvature_stencil = tessellation.corners[corners.ravel()]
        self.stencil = self.curvature_stencil.reshape(len(which), 3 * size)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Sum of angles minus 2 pi, (r, 1)."""
        angles = corner_angles(points[self.curvature_stencil])
        return angles.reshape(-1, self._size).sum(axis=1, keepdims=True) - 2 * np.pi

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (r, 1, 9 size)."""
        return corner_gradients(points[self.curvature_stencil]).reshape(len(self.stencil), 1, -1)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (r size, 9, 9)."""
        weight = np.repeat(multipliers[:, 0], self._size)
        return weight[:, None, None] * corner_hessians(points[self.curvature_stencil])
