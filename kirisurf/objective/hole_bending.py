"""The curvature of holes: how the distances to the target bend across each of them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from kirisurf.projection import Projection

LARGEST_CONDITION = 50.0
"""Condition number of the quadratic monomials at a hole's vertices above which they do not determine how it bends."""


class HoleBending:
    """Three rows for every hole: second differences of the signed distances of the vertices of the tiles round it.

    Distances d = n.(x - p) - 1/2 (x - p).S(x - p) are those of the surface rows, in tile edges. The quadratic q that
    fits them best over the closest points p, in the hole's tangent plane, bends as the sheet does beyond the target:
    to leading order its second derivatives are the second fundamental form of the hole's patch minus the target's.
    The rows are q_xx, sqrt(2) q_xy, q_yy, whose squares sum to the square of that difference in any frame.

    Closest points, normals, shape operators and with them the plane are frozen.

    Parameters
    ----------
    loops : (g, k) int
        Vertices of the tiles round every hole. Holes with fewer than six, or with vertices near a conic, have rows
        that vanish.
    projection : Projection
        Of all vertices.
    """

    name = "hole curvature"
    n_rows = 3

    def __init__(self, loops: Int[np.ndarray, "g k"], projection: Projection) -> None:
        self.stencil = np.asarray(loops, dtype=np.int64)
        self.curvature_stencil = self.stencil.reshape(-1, 1)
        self._points = projection.points[loops]
        self._normals = projection.normals[loops]
        self._shape = projection.shape_operators[loops]
        self._bending = _second_differences(self._points, self._normals)

    def _away(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return x - p and S (x - p), (g, k, 3) each."""
        away = points[self.stencil] - self._points
        return away, (self._shape @ away[..., None])[..., 0]

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Second differences of the distances, (g, 3)."""
        away, bent = self._away(points)
        distances = np.einsum("gki,gki->gk", away, self._normals - 0.5 * bent)
        return np.einsum("grk,gk->gr", self._bending, distances)

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 3, 3 k)."""
        _, bent = self._away(points)
        rows = self._bending[..., None] * (self._normals - bent)[:, None]
        return rows.reshape(len(rows), self.n_rows, -1)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g k, 3, 3)."""
        pull = np.einsum("gr,grk->gk", multipliers, self._bending)
        return (-pull[..., None, None] * self._shape).reshape(-1, 3, 3)


def _second_differences(
    points: Float[np.ndarray, "g k 3"], normals: Float[np.ndarray, "g k 3"]
) -> Float[np.ndarray, "g 3 k"]:
    """Weights of values at points in q_xx, sqrt(2) q_xy, q_yy of the quadratic that fits them best."""
    g, k = points.shape[:2]
    if k < 6:
        return np.zeros((g, 3, k))
    mean = normals.mean(axis=1)
    axis = np.eye(3)[np.abs(mean).argmin(axis=1)]
    first = np.cross(mean, axis)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    second = np.cross(mean, first)
    second /= np.maximum(np.linalg.norm(second, axis=1, keepdims=True), 1e-300)
    away = points - points.mean(axis=1, keepdims=True)
    x, y = np.einsum("gki,gi->gk", away, first), np.einsum("gki,gi->gk", away, second)
    size = np.maximum(np.abs(np.stack([x, y])).max(axis=(0, 2)), 1e-300)[:, None]
    x, y = x / size, y / size
    monomials = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2)
    left, values, right = np.linalg.svd(monomials, full_matrices=False)
    known = values[:, -1] * LARGEST_CONDITION > values[:, 0]
    inverse = np.where(known[:, None], 1 / np.where(known[:, None], values, 1.0), 0.0)
    weights = np.einsum("gji,gj,gkj->gik", right, inverse, left)[:, 3:]
    return weights * np.array([2.0, np.sqrt(2.0), 2.0])[:, None] / (size**2)[:, None]
