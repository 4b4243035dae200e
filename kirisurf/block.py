"""Blocks: groups of dimensionless rows, each on its own few vertices, with exact derivatives.

Constraints and objective terms share this one form, so that assembly, checks and solvers treat a new one
like the old ones. A block has g groups of r rows; every group depends on the p vertices of its stencil.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Int


@runtime_checkable
class Block(Protocol):
    """Rows on vertex stencils.

    Attributes
    ----------
    name : str
        What the rows say, for histories and messages.
    stencil : (g, p) int
        Vertices of every group; a vertex may be named twice.
    curvature_stencil : (c, q) int
        Vertices of the second derivatives' blocks (often `stencil` itself).
    n_rows : int
        Rows r per group.
    """

    name: str
    stencil: Int[np.ndarray, "g p"]
    curvature_stencil: Int[np.ndarray, "c q"]
    n_rows: int

    @abstractmethod
    def residual(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "g r"]:
        """Values of all rows."""

    @abstractmethod
    def jacobian(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "g r p*3"]:
        """First derivatives with respect to the coordinates of the stencil."""

    @abstractmethod
    def curvature(
        self, points: Float[np.ndarray, "n 3"], multipliers: Float[np.ndarray, "g r"]
    ) -> Float[np.ndarray, "c q*3 q*3"]:
        """Second derivatives of the rows weighted by multipliers, summed over rows."""


def difference_matrix(first: int, second: int, n: int) -> np.ndarray:
    """Return (3, 3 n): picks the vector from stencil point `second` to stencil point `first`."""
    matrix = np.zeros((3, 3 * n))
    matrix[:, 3 * first : 3 * first + 3] += np.eye(3)
    matrix[:, 3 * second : 3 * second + 3] -= np.eye(3)
    return matrix


def cross_matrix(vectors: np.ndarray) -> np.ndarray:
    """Return (k, 3, 3): the matrices of v x ."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], axis=-2)
