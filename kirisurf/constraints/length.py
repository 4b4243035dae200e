"""The two copies of a slit edge have one length: (|e1|^2 - |e2|^2) / L^2 = 0."""

from __future__ import annotations

import numpy as np

from kirisurf.block import difference_matrix
from kirisurf.tessellation import Tessellation

_FIRST, _SECOND = difference_matrix(0, 1, 4), difference_matrix(2, 3, 4)
_HESSIAN = 2 * (_FIRST.T @ _FIRST - _SECOND.T @ _SECOND)


class EqualLengths:
    """One row for every slit edge; points are in units of the tile edge."""

    name = "length"
    n_rows = 1

    def __init__(self, tessellation: Tessellation) -> None:
        self.stencil = tessellation.edge_pairs.reshape(-1, 4)
        self.curvature_stencil = self.stencil

    def residual(self, points: np.ndarray) -> np.ndarray:
        """|e1|^2 - |e2|^2, (e, 1)."""
        a, b, c, d = np.moveaxis(points[self.stencil], 1, 0)
        first, second = a - b, c - d
        return (np.einsum("ki,ki->k", first, first) - np.einsum("ki,ki->k", second, second))[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (e, 1, 12)."""
        a, b, c, d = np.moveaxis(points[self.stencil], 1, 0)
        return 2 * np.concatenate([a - b, b - a, d - c, c - d], axis=1)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (e, 12, 12)."""
        return multipliers[:, 0, None, None] * _HESSIAN
