"""Sizes of elements: fine at the ligaments, where the sheet bends, coarse in the tiles, which stay rigid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

_PARTS = 64  # of a side, for the integral of what is wanted along it


@dataclass(frozen=True, eq=False)
class Grading:
    """Wanted length of element sides: small at some places, growing with the distance from them.

    Attributes
    ----------
    places : (p, 2)
    finest : (p,)
        Wanted length there.
    growth : float
        Growth of the wanted length per unit of distance.
    coarsest : float
        Largest wanted length.
    """

    places: Float[np.ndarray, "p 2"]
    finest: Float[np.ndarray, " p"]
    growth: float
    coarsest: float

    def sizes(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
        """Return the wanted length at points."""
        if not len(self.places):
            return np.full(len(points), self.coarsest)
        count = min(8, len(self.places))
        apart, which = self._tree.query(points, k=count)
        apart, which = apart.reshape(len(points), count), which.reshape(len(points), count)
        return np.minimum((self.finest[which] + self.growth * apart).min(axis=1), self.coarsest)

    def near(self, points: Float[np.ndarray, "n 2"]) -> Grading:
        """Return the grading without the places that nothing in the box round points feels."""
        reach = (self.coarsest - self.finest) / self.growth
        low, high = points.min(axis=0), points.max(axis=0)
        outside = np.maximum(np.maximum(low - self.places, self.places - high), 0.0)
        felt = np.linalg.norm(outside, axis=1) <= reach
        return Grading(self.places[felt], self.finest[felt], self.growth, self.coarsest)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.places)

    def divided(self, start: Float[np.ndarray, " 2"], end: Float[np.ndarray, " 2"]) -> Float[np.ndarray, " m"]:
        """Return where a side is divided into pieces of the wanted length, as parts of the way; ends left out."""
        way = np.linspace(0.0, 1.0, _PARTS + 1)
        wanted = self.sizes(start + way[:, None] * (end - start))
        density = float(np.linalg.norm(end - start)) / wanted
        total = np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) / _PARTS)]
        pieces = max(1, int(np.ceil(total[-1] - 1e-6)))
        return np.interp(np.arange(1, pieces) / pieces * total[-1], total, way)
