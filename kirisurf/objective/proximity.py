"""Nearness to a reference state, which holds the pattern at its size and place."""

from __future__ import annotations

import numpy as np


class Proximity:
    """Three rows for every vertex: its displacement from a reference, over L."""

    name = "proximity"
    n_rows = 3

    def __init__(self, reference: np.ndarray) -> None:
        self._reference = reference
        self.stencil = np.arange(len(reference))[:, None]
        self.curvature_stencil = self.stencil[:0]
        self._jacobian = np.broadcast_to(np.eye(3), (len(reference), 3, 3))

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Displacements (n, 3)."""
        return points - self._reference

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (n, 3, 3)."""
        return self._jacobian

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives: none."""
        return np.zeros((0, 3, 3))
