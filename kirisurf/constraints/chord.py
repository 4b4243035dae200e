"""Squared distances between vertices: bounds on openings, and lengths that are wanted."""

from __future__ import annotations

import numpy as np

from kirisurf.constraints.edge import SQUARED_LENGTH_HESSIAN
from kirisurf.slit_ends import SlitEnds
from kirisurf.vectors import dot, gathered


class SquaredDistances:
    """One row for every pair: |a - b|^2 - d^2, over L^2.

    Parameters
    ----------
    name : str
    pairs : (g, 2) int
    distances : (g,)
        The d of every pair, in units of the tile edge.
    """

    n_rows = 1

    def __init__(self, name: str, pairs: np.ndarray, distances: np.ndarray) -> None:
        self.name = name
        self.stencil = np.asarray(pairs, dtype=np.int64)
        self.curvature_stencil = self.stencil
        self._squared = np.asarray(distances, dtype=float) ** 2

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Differences of squares, (g, 1)."""
        a, b = gathered(points, self.stencil)
        return (dot(a - b, a - b) - self._squared)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 6)."""
        a, b = points.take(self.stencil.T, axis=0)
        edge = 2 * (a - b)
        return np.concatenate([edge, -edge], axis=1)[:, None, :]

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g, 6, 6)."""
        return multipliers[:, :, None] * SQUARED_LENGTH_HESSIAN


class OpeningsBelow:
    """One inequality row for every slit end: its opening is at most an angle.

    Sides b and c of a slit are equally long, so that the opening is at most w where

        (1 - cos w) (|b|^2 + |c|^2) - |b - c|^2 >= 0.
    """

    name = "opening"
    n_rows = 1

    def __init__(self, ends: SlitEnds, largest: float) -> None:
        self.stencil = ends.stencil[:, :3]
        self.curvature_stencil = self.stencil
        wide = 1.0 - np.cos(largest)
        # in the points (a, b, c) the row is a quadratic form
        self._form = np.array([[2 * wide, -wide, -wide], [-wide, wide - 1, 1.0], [-wide, 1.0, wide - 1]])

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Values of the rows, (k, 1): not negative where allowed."""
        corner = points[self.stencil]
        return np.einsum("kai,ab,kbi->k", corner, self._form, corner)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (k, 1, 9)."""
        return 2 * np.einsum("ab,kbi->kai", self._form, points[self.stencil]).reshape(-1, 1, 9)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (k, 9, 9)."""
        return multipliers[:, :, None] * (2 * np.kron(self._form, np.eye(3)))
