"""Fairness: the same tile in neighboring unit cells has nearly the same edge lengths and angles."""

from __future__ import annotations

import numpy as np

from kirisurf.corner_angle import corner_angles, corner_gradients, corner_hessians
from kirisurf.tessellation import Tessellation


def neighbor_tiles(tessellation: Tessellation) -> np.ndarray:
    """Return pairs (m, 2) of equal tiles in cells next to each other in a row or a column."""
    place = {tuple(cell): k for k, cell in enumerate(tessellation.cells.tolist())}
    pairs = [
        (k, place[key])
        for (column, row, which), k in place.items()
        for key in ((column + 1, row, which), (column, row + 1, which))
        if key in place
    ]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


class EqualNeighbors:
    """2 k rows for every pair of equal tiles of k corners: differences of edge lengths (over L) and of angles.

    The objective is 1/2 weight sum rows^2 (Choi, Dudte, Mahadevan 2019, equation for the smoothness of the
    tiling, there divided by the number of pairs).
    """

    name = "fairness"

    def __init__(self, tessellation: Tessellation, size: int) -> None:
        pairs = neighbor_tiles(tessellation)
        pairs = pairs[(tessellation.tiles.sizes[pairs] == size).all(axis=1)]
        self._tiles, self._pair = np.unique(pairs, return_inverse=True)
        self._pair = self._pair.reshape(-1, 2)
        loops = tessellation.tiles.indices[tessellation.tiles.offsets[self._tiles][:, None] + np.arange(size)]
        self.n_rows = 2 * size
        self._size = size
        self.stencil = loops[self._pair].reshape(len(pairs), 2 * size)
        corners = np.stack([np.roll(loops, 1, axis=1), loops, np.roll(loops, -1, axis=1)], axis=2)
        self.curvature_stencil = corners.reshape(-1, 3)
        # where the coordinates of (previous, vertex, next) of corner k stand within a tile
        k = np.arange(size)
        around = np.stack([(k - 1) % size, k, (k + 1) % size], axis=1)
        self._columns = (3 * around[:, :, None] + np.arange(3)).reshape(size, 9)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Differences (m, 2 k)."""
        corners = points[self.curvature_stencil]
        lengths = np.linalg.norm(corners[:, 2] - corners[:, 1], axis=1)
        values = np.stack([lengths, corner_angles(corners)], axis=1).reshape(len(self._tiles), -1)
        return values[self._pair[:, 0]] - values[self._pair[:, 1]]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (m, 2 k, 6 k)."""
        size, corners = self._size, points[self.curvature_stencil]
        edge = corners[:, 2] - corners[:, 1]
        unit = edge / np.linalg.norm(edge, axis=1, keepdims=True)
        lengths = np.concatenate([np.zeros_like(unit), -unit, unit], axis=1)
        gradients = np.stack([lengths, corner_gradients(corners)], axis=1).reshape(-1, size, 2, 9)
        tile = np.zeros((len(self._tiles), size, 2, 3 * size))
        for k in range(size):
            tile[:, k, :, self._columns[k]] = np.moveaxis(gradients[:, k], 2, 0)
        rows = tile.reshape(-1, 2 * size, 3 * size)
        return np.concatenate([rows[self._pair[:, 0]], -rows[self._pair[:, 1]]], axis=2)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (corners, 9, 9)."""
        total = np.zeros((len(self._tiles), self.n_rows))
        np.add.at(total, self._pair[:, 0], multipliers)
        np.add.at(total, self._pair[:, 1], -multipliers)
        weight = total.reshape(-1, 2)
        corners = points[self.curvature_stencil]
        edge = corners[:, 2] - corners[:, 1]
        length = np.linalg.norm(edge, axis=1)
        unit = edge / length[:, None]
        bend = (np.eye(3) - unit[:, :, None] * unit[:, None, :]) * (weight[:, 0] / length)[:, None, None]
        result = weight[:, 1, None, None] * corner_hessians(corners)
        result[:, 3:6, 3:6] += bend
        result[:, 6:9, 6:9] += bend
        result[:, 3:6, 6:9] -= bend
        result[:, 6:9, 3:6] -= bend
        return result
