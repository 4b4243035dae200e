"""Corners of contracted tiles, with their sign: angles in (0, 2 pi), also where a tile is not convex."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int


class TurnedCorners:
    """One row for every corner: sin(theta - alpha) |u||v| = cos(alpha) u x v - sin(alpha) u.v, over L^2.

    theta is the angle from u, which leads from the corner to the next vertex, to v, which leads to the previous
    one; the points are flat. As an equality the row pins the angle, also at pi, where it says that three points are
    collinear. As an inequality it keeps it between alpha and alpha + pi: from below, or, with u and v exchanged and
    2 pi - alpha, from above.

    Parameters
    ----------
    name : str
    corners : (g, 3) int
        (previous, vertex, next).
    angles : (g,)
        alpha of every corner, in radians.
    margins : (g,), optional
        What the rows must exceed, over L^2.
    """

    n_rows = 1

    def __init__(
        self,
        name: str,
        corners: Int[np.ndarray, "g 3"],
        angles: Float[np.ndarray, " g"],
        margins: Float[np.ndarray, " g"] | None = None,
    ) -> None:
        self.name = name
        self.stencil = np.asarray(corners, dtype=np.int64)
        self.curvature_stencil = self.stencil
        self._margins = np.zeros(len(self.stencil)) if margins is None else margins
        cosine, sine = np.cos(angles), np.sin(angles)
        # u' M v with M = cos [[0, 1], [-1, 0]] - sin 1
        self._form = np.stack([np.stack([-sine, cosine], 1), np.stack([-cosine, -sine], 1)], 1)
        self._hessian = self._hessians()

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Values of the rows, (g, 1)."""
        u, v = self._sides(points)
        return (np.einsum("gi,gij,gj->g", u, self._form, v) - self._margins)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 9)."""
        u, v = self._sides(points)
        by_u, by_v = np.einsum("gij,gj->gi", self._form, v), np.einsum("gi,gij->gj", u, self._form)
        result = np.zeros((len(u), 1, 3, 3))
        result[:, 0, 0, :2], result[:, 0, 2, :2] = by_v, by_u
        result[:, 0, 1, :2] = -(by_u + by_v)
        return result.reshape(-1, 1, 9)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g, 9, 9)."""
        return multipliers[:, :, None] * self._hessian

    def _sides(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        before, here, after = points[self.stencil].transpose(1, 0, 2)[:, :, :2]
        return after - here, before - here

    def _hessians(self) -> np.ndarray:
        """Of the quadratic form, (g, 9, 9): the same everywhere."""
        full = np.zeros((len(self.stencil), 3, 3, 3, 3))
        form = np.zeros((len(self.stencil), 3, 3))
        form[:, :2, :2] = self._form
        # u = x_2 - x_1 and v = x_0 - x_1
        signs_u, signs_v = np.array([0.0, -1.0, 1.0]), np.array([1.0, -1.0, 0.0])
        for i in range(3):
            for j in range(3):
                full[:, i, :, j] += signs_u[i] * signs_v[j] * form
                full[:, j, :, i] += signs_u[i] * signs_v[j] * form.transpose(0, 2, 1)
        return full.reshape(-1, 9, 9)
