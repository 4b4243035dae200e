"""The rim of an open target: the sheet stays inside it, and its outline reaches for it."""

from __future__ import annotations

import numpy as np

from kirisurf.projection import Projection

NEAR = 1.5
"""Distance (tile edges) from the rim within which a vertex can feel it."""


class RimDistance:
    """Distance beyond the rim along its conormal, b.(x - q), over L, weighted by side.

    A vertex beyond the rim is pulled back; an outline vertex inside is pulled outward by the smaller weight
    `reach`; any other vertex inside feels nothing. Every vertex near the rim has its row, also where it is
    slack now, since a vertex may cross the rim in a later step.

    Parameters
    ----------
    outline : (n,) bool
        Vertices of the sheet's outline.
    projection : Projection
        Of all n vertices.
    points : (n, 3)
        The points that were projected.
    reach : float
        Weight of an outline vertex inside the rim; that of a vertex beyond it is 1.
    """

    name = "rim"
    n_rows = 1

    def __init__(self, outline: np.ndarray, projection: Projection, points: np.ndarray, reach: float) -> None:
        n = len(outline)
        self.stencil = np.arange(n)[:, None]
        self.curvature_stencil = self.stencil[:0]
        near = np.linalg.norm(points - projection.rim_points, axis=1) < NEAR
        near |= projection.on_rim | outline
        self._inside = np.where(outline, np.sqrt(reach), 0.0)
        self._points = projection.rim_points
        self._conormals = np.where(near[:, None], projection.rim_conormals, 0.0)

    def _beyond(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # of a problem with both states, the deployed points come first
        beyond = np.einsum("ki,ki->k", points[: len(self._points)] - self._points, self._conormals)
        return beyond, np.where(beyond > 0, 1.0, self._inside)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Weighted distances beyond the rim, (n, 1)."""
        beyond, weight = self._beyond(points)
        return (weight * beyond)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (n, 1, 3)."""
        _, weight = self._beyond(points)
        return (weight[:, None] * self._conormals)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives: none, the rows are linear pieces."""
        return np.zeros((0, 3, 3))
