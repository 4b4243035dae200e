"""Tiles are not folded over on themselves: the two triangles along every diagonal face the same way.

Flat tiles whose edges and diagonals are as long in both states may still be folded flat along a diagonal in one.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from kirisurf.latest import Latest
from kirisurf.normal_product import gradient, hessian, value
from kirisurf.vectors import add_origin, gathered

MARGIN = 0.02
"""Least product of the sines of the two triangles, for sides as long as in the start."""


class UnfoldedTiles:
    """One inequality row for every diagonal from a to c: ((b - a) x (c - a)).((c - a) x (e - a)) >= margin.

    The row is divided by the lengths |b - a| |c - a|^2 |e - a| of the start; its margin is at most a tenth of its value
    there.

    Parameters
    ----------
    diagonals : (g, 4) int
        (a, b, c, e), see :class:`kirisurf.triangulation.TriangulatedTiles`.
    start : (n, 3)
    """

    name = "unfolding"
    n_rows = 1

    def __init__(self, diagonals: Int[np.ndarray, "g 4"], start: Float[np.ndarray, "n 3"]) -> None:
        self.stencil = np.asarray(diagonals, dtype=np.int64)
        self.curvature_stencil = self.stencil
        self._sides = Latest(self._sides_at)
        u, v, w = self._sides(start)
        lengths = [np.sqrt((side**2).sum(axis=0)) for side in (u, v, w)]
        scale = 1.0 / (lengths[0] * lengths[1] ** 2 * lengths[2])
        self._margin = np.minimum(MARGIN, 0.1 * np.abs(scale * value(u, v, w)))
        self._scale = scale

    def _sides_at(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        a, b, c, e = gathered(points, self.stencil)
        return b - a, c - a, e - a

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Scaled rows minus the margin, (g, 1): not negative where allowed."""
        return (self._scale * value(*self._sides(points)) - self._margin)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 12)."""
        result = np.empty((4, 3, len(self.stencil)))
        u, v, w = self._sides(points)
        result[1], result[2], result[3] = gradient(u, v, w, self._scale)
        np.negative(result[1:].sum(axis=0), out=result[0])
        return np.moveaxis(result.reshape(1, 12, -1), -1, 0)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g, 12, 12)."""
        u, v, w = self._sides(points)
        by_uv, by_uw, by_vv, by_vw = hessian(u, v, w, self._scale * multipliers[:, 0])
        full = np.zeros((4, 3, 4, 3, len(self.stencil)))
        full[2, :, 2] = by_vv
        for i, j, block in ((1, 2, by_uv), (1, 3, by_uw), (2, 3, by_vw)):
            full[i, :, j] = block
            full[j, :, i] = block.swapaxes(0, 1)
        return add_origin(full)
