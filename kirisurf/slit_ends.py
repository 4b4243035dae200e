"""Slit ends: where two neighboring tiles hinge, and which of their vertices tell their normals.

Seen from a hinge a, the side to b belongs to one tile and the side to c to the other; d is one more vertex of c's
tile and e one of b's. The normal of c's tile is that of c x d, of b's that of e x b, for which the next neighbors
in the tile will do where its corner is neither straight nor reflex. There, the vertex that sees the side under the
steepest angle takes their place, with a sign.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.arrays import frozen
from kirisurf.tessellation import Tessellation

CLEAR = np.sin(np.radians(20.0))
"""Sine of the corner from which the next neighbors tell the normal well enough."""


@dataclass(frozen=True, eq=False)
class SlitEnds:
    """All slit ends of a tessellation.

    Attributes
    ----------
    stencil : (k, 5)
        (a, b, c, d, e) of every slit end.
    signs : (2, k)
        Sign of c x d along the normal of c's tile, and of e x b along that of b's.
    """

    stencil: Int[np.ndarray, "k 5"]
    signs: Float[np.ndarray, "2 k"]

    @classmethod
    def of(cls, tessellation: Tessellation) -> SlitEnds:
        """Find the slit ends."""
        stencil = tessellation.hinges[tessellation.slit_ends][:, [1, 0, 2, 3, 4]].copy()
        a, b, c, _, e = stencil.T
        signs = np.ones((2, len(stencil)))
        # of c's tile: the corner at a, whose next vertex is c; of b's: the one whose next vertex is e
        for row, (other, side, after) in enumerate(((3, c, c), (4, b, e))):
            sine = _sines(tessellation.contracted, a, side, stencil[:, other])
            inward = sine if row == 0 else -sine
            for k in np.flatnonzero(inward < CLEAR):
                tile = _tile_of(tessellation, int(a[k]), int(after[k]))
                rest = tile[(tile != a[k]) & (tile != side[k])]
                count = np.full(len(rest), k)
                steep = _sines(tessellation.contracted, a[count], side[count], rest)
                steep = steep if row == 0 else -steep
                best = int(np.argmax(np.abs(steep) > np.abs(steep).max() - 1e-9))
                stencil[k, other], signs[row, k] = rest[best], np.sign(steep[best])
        return cls(frozen(stencil, np.int64), frozen(signs))


def _sines(points: np.ndarray, a: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    u, v = points[c] - points[a], points[d] - points[a]
    return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / (np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1))


def _tile_of(tessellation: Tessellation, start: int, end: int) -> np.ndarray:
    """The tile with the directed edge from start to end."""
    tiles = tessellation.tiles
    k = int(np.flatnonzero((tiles.indices == start) & (tiles.successors == end))[0])
    return tiles[int(tiles.owners[k])]
