"""Tiles that hinge on each other face the same way: the product of their normals stays positive.

Without these rows two tiles can fold back on each other by more than a right angle, and then cross their neighbors.
"""

from __future__ import annotations

import numpy as np

from kirisurf.latest import Latest
from kirisurf.slit_ends import SlitEnds
from kirisurf.tessellation import Tessellation
from kirisurf.vectors import add_origin, dot, gathered, outer

MARGIN = 0.2
"""Least cosine of the angle between the normals, for tiles as large as in the start."""

_DIAGONAL = np.arange(3)


class FacingTiles:
    """One inequality row for every slit end: (e x b).(c x d) >= margin |e||b||c||d|.

    Seen from the hinge a, the sides e and b span the first tile, c and d the second. The lengths are those of
    the start.
    """

    name = "facing"
    n_rows = 1

    def __init__(self, tessellation: Tessellation, start: np.ndarray, margin: float = MARGIN) -> None:
        # (a, b, c, d, e), in the order of the opening rows: equal stencils share their place in the assembly
        ends = SlitEnds.of(tessellation)
        self.stencil = ends.stencil
        self.curvature_stencil = self.stencil
        self._margin = margin
        self._sides = Latest(self._sides_at)
        self._scale = ends.signs.prod(axis=0) / np.sqrt(
            np.prod([dot(side, side) for side in self._sides(start)], axis=0)
        )

    def _sides_at(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        a, *others = gathered(points, self.stencil)
        return tuple(other - a for other in others)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Scaled rows minus the margin, (k, 1): not negative where allowed."""
        b, c, d, e = self._sides(points)
        # of the form (e.c)(b.d) - (e.d)(b.c), which is the same
        return (self._scale * (dot(e, c) * dot(b, d) - dot(e, d) * dot(b, c)) - self._margin)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (k, 1, 15)."""
        b, c, d, e = self._sides(points)
        ec, bd, ed, bc = (self._scale * dot(u, v) for u, v in ((e, c), (b, d), (e, d), (b, c)))
        result = np.empty((5, 3, b.shape[1]))
        result[1:] = d * ec - c * ed, e * bd - b * ed, b * ec - e * bc, c * bd - d * bc
        np.negative(result[1:].sum(axis=0), out=result[0])
        return np.moveaxis(result.reshape(1, 15, -1), -1, 0)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 15, 15)."""
        b, c, d, e = self._sides(points)
        weight = self._scale * multipliers[:, 0]
        wb, wc, wd = weight * b, weight * c, weight * d
        full = np.zeros((5, 3, 5, 3, b.shape[1]))
        blocks = {
            (1, 2): (outer(wd, e), -dot(e, wd)),
            (1, 3): (-outer(wc, e), dot(e, wc)),
            (2, 3): (outer(e, wb) - outer(wb, e), 0.0),
            (1, 4): (outer(wd, c) - outer(wc, d), 0.0),
            (2, 4): (-outer(wb, d), dot(wb, d)),
            (3, 4): (outer(wb, c), -dot(wb, c)),
        }
        for (i, j), (block, inner) in blocks.items():
            block[_DIAGONAL, _DIAGONAL] += inner
            full[i, :, j] = block
            full[j, :, i] = block.swapaxes(0, 1)
        return add_origin(full)
