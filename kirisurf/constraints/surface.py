"""Vertices lie on the target: the frozen second-order model of the signed distance vanishes."""

from __future__ import annotations

import numpy as np

from kirisurf.projection import Projection


class OnSurface:
    """Signed distance d(x) = n.(x - p) - 1/2 (x - p).S(x - p) of chosen vertices to the target, over L.

    The closest points p, normals n and shape operators S are frozen: re-evaluated inside a line search
    they are not smooth on a mesh.

    Parameters
    ----------
    vertices : (k,) int
        Which vertices.
    projection : Projection
        Of all vertices.
    """

    name = "surface"
    n_rows = 1

    def __init__(self, vertices: np.ndarray, projection: Projection) -> None:
        self.stencil = np.asarray(vertices, dtype=np.int64)[:, None]
        self.curvature_stencil = self.stencil
        self._points = projection.points[vertices]
        self._normals = projection.normals[vertices]
        self._shape = projection.shape_operators[vertices]

    def _away(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return x - p and S (x - p), (k, 3) each."""
        away = points[self.stencil[:, 0]] - self._points
        return away, (self._shape @ away[:, :, None])[:, :, 0]

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Signed distances, (k, 1)."""
        away, bent = self._away(points)
        return np.einsum("ki,ki->k", away, self._normals - 0.5 * bent)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (k, 1, 3)."""
        _, bent = self._away(points)
        return (self._normals - bent)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 3, 3)."""
        return -multipliers[:, 0, None, None] * self._shape
