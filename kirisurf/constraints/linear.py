"""Linear rows: sums of components of a few points."""

from __future__ import annotations

import numpy as np


class LinearRows:
    """One row for every group: sum_k c_k . x_k - d, as an equality or, not negative, as an inequality.

    Parameters
    ----------
    name : str
    stencil : (g, p) int
    coefficients : (g, p, 3)
    constants : (g,)
        The d of every row.
    """

    n_rows = 1

    def __init__(self, name: str, stencil: np.ndarray, coefficients: np.ndarray, constants: np.ndarray) -> None:
        self.name = name
        self.stencil = np.asarray(stencil, dtype=np.int64)
        # straight rows: nothing bends
        self.curvature_stencil = self.stencil[:0]
        self._coefficients = np.asarray(coefficients, dtype=float)
        self._constants = np.asarray(constants, dtype=float)

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Values of the rows, (g, 1)."""
        return (np.einsum("gpi,gpi->g", self._coefficients, points[self.stencil]) - self._constants)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 3 p)."""
        return self._coefficients.reshape(len(self.stencil), 1, -1)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives: none."""
        size = 3 * self.stencil.shape[1]
        return np.zeros((0, size, size))


def plane_rows(name: str, vertices: np.ndarray) -> LinearRows:
    """Return rows that keep vertices (k,) in the plane z = 0."""
    count = len(vertices)
    coefficients = np.zeros((count, 1, 3))
    coefficients[:, 0, 2] = 1.0
    return LinearRows(name, np.asarray(vertices)[:, None], coefficients, np.zeros(count))
