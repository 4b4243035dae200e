"""Neighboring tiles do not overlap: <(b-a) x (c-a), (c-a) x (d-a)> >= margin |b-a| |c-a|^2 |d-a| at slit ends.

Why not over L^4, as the other rows are: tiles may differ in size by a factor of several over one sheet, and a
margin in one unit would then forbid small tiles instead of small openings. The lengths are those of the start.
"""

from __future__ import annotations

import numpy as np

from kirisurf.block import cross_matrix
from kirisurf.tessellation import Tessellation


class OpenHinges:
    """Two inequality rows for every slit end: a is the hinge, b ends one side, c the other, d goes on in c's tile.

    A row is positive where the slit opens the right way about the normal of one tile; the margin keeps it open.
    Why two, where the paper has one: between tiles that are folded sharply against each other a slit can be open
    about the one normal and closed about the other, and then also about their mean.
    """

    name = "opening"
    n_rows = 1

    def __init__(self, tessellation: Tessellation, margin: float, start: np.ndarray) -> None:
        self.margin = margin
        self._scale = np.ones(1)
        ends = tessellation.hinges[tessellation.slit_ends]
        # (u x v).(v x w) with the roles of the two tiles exchanged changes sign twice: both rows are alike
        self.stencil = np.concatenate([ends[:, [1, 0, 2, 3]], ends[:, [1, 2, 0, 4]]])
        self.curvature_stencil = self.stencil
        u, v, w, _, _ = self._parts(start)
        lu, lv, lw = (np.linalg.norm(side, axis=1) for side in (u, v, w))
        self._scale = 1.0 / (lu * lv**2 * lw)

    def _parts(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        a, b, c, d = np.moveaxis(points[self.stencil], 1, 0)
        u, v, w = b - a, c - a, d - a
        return u, v, w, np.cross(u, v), np.cross(v, w)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Scaled rows minus the margin, (k, 1): not negative where allowed."""
        *_, first, second = self._parts(points)
        return (self._scale * np.einsum("ki,ki->k", first, second))[:, None] - self.margin

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (k, 1, 12)."""
        u, v, w, first, second = self._parts(points)
        du, dw = np.cross(v, second), np.cross(first, v)
        dv = np.cross(second, u) + np.cross(w, first)
        return (self._scale[:, None] * np.concatenate([-du - dv - dw, du, dv, dw], axis=1))[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 12, 12).

        With P = u x v, Q = v x w, f = P.Q, and matrices [x] of the cross product:
        dP = [u] dv - [v] du, dQ = [v] dw - [w] dv, and d2f = 2 dP.dQ + d2P.Q + P.d2Q.
        """
        u, v, w, first, second = self._parts(points)
        mu, mv, mw = cross_matrix(u), cross_matrix(v), cross_matrix(w)
        zero = np.zeros_like(mu)
        dp = np.concatenate([-mv, mu, zero], axis=2)
        dq = np.concatenate([zero, -mw, mv], axis=2)
        full = np.swapaxes(dp, 1, 2) @ dq
        full += np.swapaxes(full, 1, 2).copy()
        # Q.(du x dv) = du.(dv x Q) = -du.[Q] dv, and P.(dv x dw) likewise
        mq, mp = cross_matrix(second), cross_matrix(first)
        full[:, 0:3, 3:6] -= mq
        full[:, 3:6, 0:3] += mq
        full[:, 3:6, 6:9] -= mp
        full[:, 6:9, 3:6] += mp
        return (self._scale * multipliers[:, 0])[:, None, None] * _with_origin(full)


def _with_origin(full: np.ndarray) -> np.ndarray:
    """Extend second derivatives by difference vectors (k, 9, 9) to the points (origin, ...) (k, 12, 12)."""
    result = np.zeros((len(full), 12, 12))
    result[:, 3:, 3:] = full
    columns = full[:, 0:3] + full[:, 3:6] + full[:, 6:9]
    result[:, 0:3, 3:] = -columns
    result[:, 3:, 0:3] = -np.swapaxes(columns, 1, 2)
    result[:, 0:3, 0:3] = columns[:, :, 0:3] + columns[:, :, 3:6] + columns[:, :, 6:9]
    return result
