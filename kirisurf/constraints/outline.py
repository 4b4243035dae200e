"""Vertices lie on a planar outline: the frozen second-order model of the signed distance to it vanishes."""

from __future__ import annotations

import numpy as np

from kirisurf.outlines import OutlineProjection


class OnOutline:
    """Signed distance n.(x - p) + k/2 (t.(x - p))^2 - d of chosen vertices to an outline, over L; z plays no part.

    The closest points p, normals n and curvatures k are frozen, and renewed by the solver.

    Parameters
    ----------
    name : str
    vertices : (g,) int
    projection : OutlineProjection
        Of these vertices.
    offsets : (g,), optional
        The d of every vertex: how far outside it is to lie.
    inside : bool
        Rows with the other sign, not negative where a vertex lies no farther outside than d.
    """

    n_rows = 1

    def __init__(
        self,
        name: str,
        vertices: np.ndarray,
        projection: OutlineProjection,
        offsets: np.ndarray | None = None,
        inside: bool = False,
    ) -> None:
        self.name = name
        self._sign = -1.0 if inside else 1.0
        self._offsets = np.zeros(len(vertices)) if offsets is None else offsets
        self.stencil = np.asarray(vertices, dtype=np.int64)[:, None]
        self.curvature_stencil = self.stencil
        self._points, self._normals = projection.points, projection.normals
        self._tangents = np.stack([-projection.normals[:, 1], projection.normals[:, 0]], axis=1)
        self._curvatures = projection.curvatures

    def _along(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        away = points[self.stencil[:, 0], :2] - self._points
        return away, (away * self._tangents).sum(axis=1)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Signed distances, (g, 1)."""
        away, along = self._along(points)
        distances = (away * self._normals).sum(axis=1) + 0.5 * self._curvatures * along**2
        return self._sign * (distances - self._offsets)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 3)."""
        _, along = self._along(points)
        result = np.zeros((len(along), 1, 3))
        result[:, 0, :2] = self._sign * (self._normals + (self._curvatures * along)[:, None] * self._tangents)
        return result

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g, 3, 3)."""
        result = np.zeros((len(multipliers), 3, 3))
        bend = (self._sign * multipliers[:, 0] * self._curvatures)[:, None, None]
        result[:, :2, :2] = bend * self._tangents[:, :, None] * self._tangents[:, None, :]
        return result


class OnScaledOutline:
    """Signed distance to an outline of unknown size, s f(y / s), over L.

    With f the model n.(u - p) + k/2 (t.(u - p))^2 of the outline of size 1 and w = t.(y - s p) it is

        n.(y - s p) + k w^2 / (2 s).

    Parameters
    ----------
    name : str
    vertices : (g,) int
        Their points are y.
    size : int
        The vertex whose first coordinate is s.
    projection : OutlineProjection
        Of y / s.
    """

    n_rows = 1

    def __init__(self, name: str, vertices: np.ndarray, size: int, projection: OutlineProjection) -> None:
        self.name = name
        self.stencil = np.stack([vertices, np.full(len(vertices), size)], axis=1)
        self.curvature_stencil = self.stencil
        self._normals, self._bends = projection.normals, projection.curvatures
        self._tangents = np.stack([-projection.normals[:, 1], projection.normals[:, 0]], axis=1)
        self._out = (projection.points * self._normals).sum(axis=1)
        self._far = (projection.points * self._tangents).sum(axis=1)

    def _at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        y, s = points[self.stencil[:, 0], :2], points[self.stencil[:, 1], 0]
        return y, s, (y * self._tangents).sum(axis=1) - s * self._far

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Signed distances, (g, 1)."""
        y, s, w = self._at(points)
        return ((y * self._normals).sum(axis=1) - s * self._out + 0.5 * self._bends * w**2 / s)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 6)."""
        _, s, w = self._at(points)
        turned = self._bends * w / s
        result = np.zeros((len(s), 1, 6))
        result[:, 0, :2] = self._normals + turned[:, None] * self._tangents
        result[:, 0, 3] = -self._out - turned * self._far - 0.5 * turned * w / s
        return result

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g, 6, 6): of k w^2 / (2 s), which is k / s times the square of (t, -t.p - w / s)."""
        _, s, w = self._at(points)
        direction = np.zeros((len(s), 6))
        direction[:, :2], direction[:, 3] = self._tangents, -self._far - w / s
        scale = multipliers[:, 0] * self._bends / s
        return scale[:, None, None] * direction[:, :, None] * direction[:, None, :]
