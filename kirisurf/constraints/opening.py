"""Neighboring tiles do not overlap: <(b-a) x (c-a), (c-a) x (d-a)> >= margin |b-a| |c-a|^2 |d-a| at slit ends.

Why not over L^4, as the other rows are: tiles may differ in size by a factor of several over one sheet, and a
margin in one unit would then forbid small tiles instead of small openings. The lengths are those of the start.
"""

from __future__ import annotations

import numpy as np

from kirisurf.latest import Latest
from kirisurf.normal_product import gradient, hessian
from kirisurf.slit_ends import SlitEnds
from kirisurf.tessellation import Tessellation
from kirisurf.vectors import add_origin, cross, dot, gathered


class OpenHinges:
    """Two inequality rows for every slit end: a is the hinge, b ends one side, c the other.

    In the first row d goes on from a in c's tile; in the second b and c change roles, and it goes on in b's.
    A row is positive where the slit opens the right way about the normal of one tile; the margin keeps it open.
    Why two, where the paper has one: between tiles that are folded sharply against each other a slit can be open
    about the one normal and closed about the other, and then also about their mean.
    """

    name = "opening"
    n_rows = 2

    def __init__(self, tessellation: Tessellation, margin: float, start: np.ndarray) -> None:
        self.margin = margin
        ends = SlitEnds.of(tessellation)
        # (a, b, c, d of the first row, d of the second)
        self.stencil = ends.stencil
        self.curvature_stencil = self.stencil
        self._sides = Latest(self._sides_at)
        lb, lc, ld, le = (np.sqrt(dot(side, side)) for side in self._sides(start))
        self._scale = ends.signs / np.stack([lb * lc**2 * ld, lc * lb**2 * le])

    def _sides_at(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        a, *others = gathered(points, self.stencil)
        return tuple(other - a for other in others)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Scaled rows minus the margin, (k, 2): not negative where allowed."""
        b, c, d, e = self._sides(points)
        # (u x v).(v x w) with the roles of the two tiles exchanged changes sign twice: both rows are alike
        normal = cross(b, c)
        rows = np.stack([dot(normal, cross(c, d)), -dot(normal, cross(b, e))])
        return (self._scale * rows - self.margin).T

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (k, 2, 15)."""
        b, c, d, e = self._sides(points)
        result = np.zeros((2, 5, 3, b.shape[1]))
        for row, scale, (i, j, k), sides in zip(
            result, self._scale, ((1, 2, 3), (2, 1, 4)), ((b, c, d), (c, b, e)), strict=True
        ):
            row[i], row[j], row[k] = gradient(*sides, scale)
            np.negative(row[i] + row[j] + row[k], out=row[0])
        return np.moveaxis(result.reshape(2, 15, -1), -1, 0)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 15, 15)."""
        b, c, d, e = self._sides(points)
        weights = self._scale * multipliers.T
        full = np.zeros((5, 3, 5, 3, b.shape[1]))
        for weight, (i, j, k), sides in zip(weights, ((1, 2, 3), (2, 1, 4)), ((b, c, d), (c, b, e)), strict=True):
            full[i, :, j], full[i, :, k], full[j, :, j], full[j, :, k] = hessian(*sides, weight)
        # both rows have a block of b and c; all others are of one row alone
        full[1, :, 2] += full[2, :, 1].swapaxes(0, 1)
        for i, j in ((1, 2), (1, 3), (2, 3), (1, 4), (2, 4)):
            full[j, :, i] = full[i, :, j].swapaxes(0, 1)
        return add_origin(full)
