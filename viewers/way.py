"""The way of a sheet from flat to deployed, as a computed path has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen


@dataclass(frozen=True, eq=False)
class Way:
    """States in equilibrium, evenly along the way.

    Attributes
    ----------
    states : (k, n, 3)
        From flat to deployed; at least two.
    torsion : float
        lambda.
    drive : str
    """

    states: Float[np.ndarray, "k n 3"]
    torsion: float
    drive: str

    @property
    def words(self) -> str:
        """What is shown, in one line."""
        return f"physical path, lambda = {self.torsion:g}, {self.drive} drive"

    def at(self, share: float) -> Float[np.ndarray, "n 3"]:
        """Return the vertices at a part of the way; between two states, on straight lines.

        Examples
        --------
        >>> way = Way(np.array([[[0.0, 0, 0]], [[1.0, 0, 0]], [[1.0, 4, 0]]]), 0.0, "free")
        >>> way.at(0.75).tolist()
        [[1.0, 2.0, 0.0]]
        """
        last = len(self.states) - 1
        place = float(np.clip(share, 0.0, 1.0)) * last
        k = min(int(place), last - 1)
        part = place - k
        return frozen((1.0 - part) * self.states[k] + part * self.states[k + 1])
