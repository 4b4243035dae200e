"""Ragged vertex loops (polygons of different sizes) in VTK's own layout: offsets and indices."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from kirisurf.arrays import frozen


@dataclass(frozen=True, eq=False)
class Loops:
    """A list of t index loops: loop k is `indices[offsets[k]:offsets[k + 1]]`.

    Attributes
    ----------
    offsets : (t + 1,) int
    indices : (s,) int
    """

    offsets: Int[np.ndarray, " t_plus_1"]
    indices: Int[np.ndarray, " s"]

    @classmethod
    def from_lists(cls, loops: Iterable[Sequence[int] | np.ndarray]) -> Loops:
        """Build from a sequence of index sequences."""
        loops = [np.asarray(loop, dtype=np.int64) for loop in loops]
        sizes = np.array([len(loop) for loop in loops], dtype=np.int64)
        offsets = np.concatenate([[0], np.cumsum(sizes)])
        indices = np.concatenate(loops) if loops else np.zeros(0, np.int64)
        return cls(frozen(offsets, np.int64), frozen(indices, np.int64))

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, k: int) -> np.ndarray:
        return self.indices[self.offsets[k] : self.offsets[k + 1]]

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self[k] for k in range(len(self)))

    @property
    def sizes(self) -> np.ndarray:
        """Number of indices of every loop, (t,) int."""
        return np.diff(self.offsets)

    @property
    def owners(self) -> np.ndarray:
        """Loop that every entry of `indices` belongs to, (s,) int."""
        return np.repeat(np.arange(len(self)), self.sizes)

    @property
    def successors(self) -> np.ndarray:
        """Index that follows every entry within its loop, (s,) int: with `indices`, the edges."""
        if not len(self.indices):
            return self.indices
        position = np.arange(len(self.indices)) + 1
        ends = self.offsets[1:][self.sizes > 0]
        position[ends - 1] = self.offsets[:-1][self.sizes > 0]
        return self.indices[position]

    @property
    def edges(self) -> np.ndarray:
        """Directed edges of all loops in order, (s, 2) int."""
        return np.stack([self.indices, self.successors], axis=1)

    def by_size(self) -> dict[int, tuple[np.ndarray, np.ndarray]]:
        """Group loops of equal size k: {k: (numbers of the loops (g,), their indices (g, k))}."""
        groups = {}
        for size in np.unique(self.sizes):
            which = np.flatnonzero(self.sizes == size)
            groups[int(size)] = (which, self.indices[self.offsets[which, None] + np.arange(size)])
        return groups

    def subset(self, which: np.ndarray) -> Loops:
        """Return the chosen loops, in the given order."""
        return Loops.from_lists([self[int(k)] for k in np.asarray(which)])
