"""Fairness: the same tile in neighboring unit cells has nearly the same edge lengths and angles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_matrix

from kirisurf.block import Block
from kirisurf.corner_angle import CornerAngles
from kirisurf.latest import Latest
from kirisurf.tessellation import Tessellation
from kirisurf.vectors import gathered


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


class TileShapes:
    """2 k rows for every chosen tile of k corners: edge length (over L) and angle of each corner in turn.

    Parameters
    ----------
    loops : (t, k) int
        Vertices of the tiles.
    """

    name = "shape"

    def __init__(self, loops: np.ndarray) -> None:
        size = loops.shape[1]
        self.n_rows = 2 * size
        self.stencil = loops
        corners = np.stack([np.roll(loops, 1, axis=1), loops, np.roll(loops, -1, axis=1)], axis=2)
        self.curvature_stencil = corners.reshape(-1, 3)
        self._corners = Latest(self._corners_at)

    def _corners_at(self, points: np.ndarray) -> CornerAngles:
        return CornerAngles(gathered(points, self.curvature_stencil))

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Lengths and angles (t, 2 k)."""
        corners = self._corners(points)
        return np.stack([corners.lengths, corners.angles], axis=1).reshape(-1, self.n_rows)

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (t, 2 k, 3 k)."""
        corners, (n_tiles, size) = self._corners(points), self.stencil.shape
        # of corner k of tile t: [..., t, k]
        direction = corners.directions.reshape(3, n_tiles, size)
        gradient = corners.gradients.reshape(3, 3, n_tiles, size)
        result = np.zeros((size, 2, size, 3, n_tiles))
        for k in range(size):
            before, after = (k - 1) % size, (k + 1) % size
            result[k, 0, k], result[k, 0, after] = -direction[..., k], direction[..., k]
            result[k, 1, before], result[k, 1, k], result[k, 1, after] = gradient[..., k]
        return np.moveaxis(result.reshape(2 * size, 3 * size, n_tiles), -1, 0)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (corners, 9, 9)."""
        stretch, weights = multipliers.reshape(-1, 2).T
        return self._corners(points).hessians(weights, stretch)


class EqualNeighbors:
    """2 k rows for every pair of equal tiles of k corners: differences of edge lengths (over L) and of angles.

    The objective is 1/2 weight sum rows^2 (Choi, Dudte, Mahadevan 2019, equation for the smoothness of the
    tiling, there divided by the number of pairs).

    Parameters
    ----------
    tessellation : Tessellation
    size : int
        Corners k of the tiles.
    shapes : callable
        Makes the block of the tiles' own rows from their vertices (t, k).
    corners : (s,) int, optional
        Vertices of all tiles' corners, in the order of `tessellation.tiles.indices`, where it is not these that
        are compared.
    """

    name = "fairness"

    def __init__(
        self,
        tessellation: Tessellation,
        size: int,
        shapes: Callable[[np.ndarray], Block] = TileShapes,
        corners: np.ndarray | None = None,
    ) -> None:
        pairs = neighbor_tiles(tessellation)
        pairs = pairs[(tessellation.tiles.sizes[pairs] == size).all(axis=1)]
        tiles, places = np.unique(pairs, return_inverse=True)
        self.pairs = places.reshape(-1, 2)
        vertices = tessellation.tiles.indices if corners is None else corners
        loops = vertices[tessellation.tiles.offsets[tiles][:, None] + np.arange(size)]
        self.inner = shapes(loops)
        self.n_rows = self.inner.n_rows
        self.stencil = loops[self.pairs].reshape(len(pairs), 2 * size)
        self.curvature_stencil = self.inner.curvature_stencil
        signs = np.tile([1.0, -1.0], len(pairs))
        self._folding = csr_matrix(
            (signs, (self.pairs.ravel(), np.repeat(np.arange(len(pairs)), 2))), shape=(len(tiles), len(pairs))
        )

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Differences (m, 2 k)."""
        values = self.inner.residual(points)
        return values[self.pairs[:, 0]] - values[self.pairs[:, 1]]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (m, 2 k, 6 k)."""
        rows = self.inner.jacobian(points)
        return np.concatenate([rows[self.pairs[:, 0]], -rows[self.pairs[:, 1]]], axis=2)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (corners, 9, 9)."""
        return self.inner.curvature(points, self.folded(multipliers))

    def folded(self, multipliers: np.ndarray) -> np.ndarray:
        """Multipliers of the tiles' own rows (t, 2 k)."""
        return self._folding @ multipliers
