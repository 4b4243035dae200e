"""Tiles stay convex: successive corners of a tile turn the same way.

Without these rows a tile can turn inside out: its angles are measured without sign, so that their sums round a
point and the planarity may hold for a tile that no flat sheet has.
"""

from __future__ import annotations

import numpy as np

from kirisurf.latest import Latest
from kirisurf.normal_product import gradient, hessian, value
from kirisurf.tessellation import Tessellation
from kirisurf.vectors import gathered

MARGIN = 1e-3
"""Least product of the sines of two successive corners, for sides as long as in the start."""


class ConvexTiles:
    """k - 1 inequality rows for every tile of k corners: (u x v).(v x w) >= margin |u||v|^2|w| for its sides.

    Row j compares the corners j and j + 1; the chain of k - 1 rows compares all. The lengths are those of the start.
    """

    name = "convexity"

    def __init__(self, tessellation: Tessellation, size: int, start: np.ndarray, margin: float = MARGIN) -> None:
        _, self.stencil = tessellation.tiles.by_size()[size]
        self.curvature_stencil = self.stencil
        self.n_rows = size - 1
        self._margin = margin
        self._size = size
        self._sides = Latest(self._sides_at)
        lengths = np.sqrt((self._sides(start) ** 2).sum(axis=1))
        self._scale = [1.0 / (a * b**2 * c) for a, b, c in (lengths[list(three)] for three in self._rows())]

    def _rows(self) -> list[tuple[int, int, int]]:
        """The three successive sides of every row; side i runs from corner i to corner i + 1."""
        k = self._size
        return [((j - 1) % k, j, (j + 1) % k) for j in range(k - 1)]

    def _sides_at(self, points: np.ndarray) -> np.ndarray:
        corner = gathered(points, self.stencil)
        return np.roll(corner, -1, axis=0) - corner

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Scaled rows minus the margin, (t, k - 1): not negative where allowed."""
        sides = self._sides(points)
        rows = [s * value(sides[u], sides[v], sides[w]) for s, (u, v, w) in zip(self._scale, self._rows(), strict=True)]
        return np.stack(rows, axis=1) - self._margin

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (t, k - 1, 3 k)."""
        sides, k = self._sides(points), self._size
        result = np.zeros((k - 1, k, 3, sides.shape[2]))
        for row, scale, (u, v, w) in zip(result, self._scale, self._rows(), strict=True):
            for side, part in zip((u, v, w), gradient(sides[u], sides[v], sides[w], scale), strict=True):
                row[(side + 1) % k] += part
                row[side] -= part
        return np.moveaxis(result.reshape(k - 1, 3 * k, -1), -1, 0)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (t, 3 k, 3 k)."""
        sides, k = self._sides(points), self._size
        by_sides = np.zeros((k, 3, k, 3, sides.shape[2]))
        for j, (scale, (u, v, w)) in enumerate(zip(self._scale, self._rows(), strict=True)):
            by_uv, by_uw, by_vv, by_vw = hessian(sides[u], sides[v], sides[w], scale * multipliers[:, j])
            by_sides[v, :, v] += by_vv
            for a, b, block in ((u, v, by_uv), (u, w, by_uw), (v, w, by_vw)):
                by_sides[a, :, b] += block
                by_sides[b, :, a] += block.swapaxes(0, 1)
        # a corner ends the side before it and starts its own
        half = np.roll(by_sides, 1, axis=0) - by_sides
        full = np.roll(half, 1, axis=2) - half
        return np.moveaxis(full.reshape(3 * k, 3 * k, -1), -1, 0)
