"""Shapes of contracted tiles: edge lengths and signed angles.

A rigid tile has the same shape in both states. Where the contracted points are unknowns too, its shape is that of
flat polygons there: cheaper, and with signed angles, which are smooth also at straight and reflex corners.
"""

from __future__ import annotations

import numpy as np


class FlatTileShapes:
    """2 k rows for every chosen tile of k corners: edge length (over L) and signed angle of each corner in turn.

    Parameters
    ----------
    loops : (t, k) int
        Vertices of the tiles, counter-clockwise; their points are flat.
    """

    name = "shape"

    def __init__(self, loops: np.ndarray) -> None:
        self.n_rows = 2 * loops.shape[1]
        self.stencil = loops
        self.curvature_stencil = np.stack([loops, np.roll(loops, -1, axis=1)], axis=2).reshape(-1, 2)

    def _edges(self, points: np.ndarray) -> np.ndarray:
        """Edges from every corner to the next, (t, k, 2)."""
        corner = points[self.stencil][:, :, :2]
        return np.roll(corner, -1, axis=1) - corner

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Lengths and interior angles in (0, 2 pi), (t, 2 k)."""
        after = self._edges(points)
        before = np.roll(after, 1, axis=1)
        turn = np.arctan2(_cross(before, after), (before * after).sum(axis=2))
        return np.stack([np.linalg.norm(after, axis=2), np.pi - turn], axis=2).reshape(len(after), -1)

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (t, 2 k, 3 k)."""
        edges = self._edges(points)
        tiles, size = self.stencil.shape
        length = np.linalg.norm(edges, axis=2, keepdims=True)
        along = edges / length
        around = np.stack([-along[..., 1], along[..., 0]], axis=2) / length
        result = np.zeros((tiles, size, 2, size, 3))
        for k in range(size):
            after, before = (k + 1) % size, (k - 1) % size
            result[:, k, 0, after, :2] = along[:, k]
            result[:, k, 0, k, :2] = -along[:, k]
            # the angle is pi plus the direction of the edge before minus that of the edge after
            result[:, k, 1, before, :2] = -around[:, before]
            result[:, k, 1, k, :2] = around[:, before] + around[:, k]
            result[:, k, 1, after, :2] = -around[:, k]
        return result.reshape(tiles, 2 * size, 3 * size)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (t k, 6, 6), one block for every edge."""
        edges = self._edges(points)
        tiles, size = self.stencil.shape
        by_length, by_angle = multipliers.reshape(tiles, size, 2).transpose(2, 0, 1)
        # the direction of an edge enters the angle at its end, and with the other sign the one at its start
        by_direction = np.roll(by_angle, -1, axis=1) - by_angle
        squared = (edges**2).sum(axis=2)
        length = np.sqrt(squared)
        x, y = edges[..., 0] / length, edges[..., 1] / length
        across, mixed = by_length / length, by_direction / squared
        block = np.zeros((tiles, size, 3, 3))
        block[..., 0, 0] = across * y * y + 2 * mixed * x * y
        block[..., 1, 1] = across * x * x - 2 * mixed * x * y
        block[..., 0, 1] = block[..., 1, 0] = -across * x * y + mixed * (y * y - x * x)
        full = np.einsum("ij,tkab->tkiajb", np.array([[1.0, -1.0], [-1.0, 1.0]]), block)
        return full.reshape(-1, 6, 6)


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
