"""Stencils that name a vertex several times, and the same with every vertex named once."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import csr_matrix


class DistinctStencil:
    """Names every vertex of a group once: J'J costs the square of the number of names.

    Parameters
    ----------
    repeated : (g, s) int
        Vertices of every group; some occur several times.

    Attributes
    ----------
    vertices : (g, p) int
        The different ones in increasing order. Groups with fewer than others name their first one again.
    """

    def __init__(self, repeated: Int[np.ndarray, "g s"]) -> None:
        order = np.argsort(repeated, axis=1, kind="stable")
        named = np.take_along_axis(repeated, order, axis=1)
        rank = np.cumsum(np.diff(named, axis=1, prepend=named[:, :1]) != 0, axis=1)
        self.vertices = np.repeat(named[:, :1], int(rank.max(initial=0)) + 1, axis=1)
        np.put_along_axis(self.vertices, rank, named, axis=1)
        places = np.empty_like(rank)
        np.put_along_axis(places, order, rank, axis=1)
        places += self.vertices.shape[1] * np.arange(len(repeated))[:, None]
        entries = np.ones(places.size), (places.ravel(), np.arange(places.size))
        self._sum = csr_matrix(entries, shape=(self.vertices.size, places.size))

    def gathered(self, gradients: Float[np.ndarray, "g s 3"]) -> Float[np.ndarray, "g 1 p3"]:
        """Return a row's derivatives by the vertices from those by the repeated names."""
        return (self._sum @ gradients.reshape(-1, 3)).reshape(len(self.vertices), 1, 3 * self.vertices.shape[1])
