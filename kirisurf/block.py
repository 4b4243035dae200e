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


@runtime_checkable
class Differences(Block, Protocol):
    """A block whose groups are differences of two groups of another block. To be one is an option, for speed.

    A least-squares term of such rows costs as much as the other block: its J'J is that of every inner group,
    times its number of pairs, minus the products across each pair.

    Attributes
    ----------
    inner : Block
        What is compared.
    pairs : (g, 2) int
        Group k is inner group pairs[k, 0] minus inner group pairs[k, 1].
    """

    inner: Block
    pairs: Int[np.ndarray, "g 2"]

    @abstractmethod
    def folded(self, multipliers: Float[np.ndarray, "g r"]) -> Float[np.ndarray, "i r"]:
        """Multipliers of the inner rows that stand for multipliers of the differences."""
