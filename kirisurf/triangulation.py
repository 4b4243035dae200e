"""Tiles cut into triangles along diagonals: what makes a polygon rigid, flat and of one orientation.

A tile of k corners has k - 3 diagonals. With its edges they fix its shape in the plane; the four corners round each
diagonal in one plane make it flat; its k - 2 triangles tell whether it is turned over, also where it is not convex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.arrays import frozen
from kirisurf.errors import UnusableError
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class TriangulatedTiles:
    """Triangles and diagonals of all tiles of a tessellation.

    Attributes
    ----------
    triangles : (q, 3)
        Vertices, counter-clockwise.
    diagonals : (d, 4)
        (a, b, c, e): the diagonal runs from a to c; b and e complete its triangles (a, b, c) and (a, c, e).
    """

    triangles: Int[np.ndarray, "q 3"]
    diagonals: Int[np.ndarray, "d 4"]

    @classmethod
    def of(cls, tessellation: Tessellation) -> TriangulatedTiles:
        """Triangulate the tiles, equal ones of all cells alike.

        Raises
        ------
        UnusableError
            Where a contracted tile cannot be triangulated, since it crosses itself.
        """
        tiles, which = tessellation.tiles, tessellation.cells[:, 2]
        keys = np.stack([which, tiles.sizes], axis=1)
        triangles, diagonals = [np.zeros((0, 3), np.int64)], [np.zeros((0, 4), np.int64)]
        for key in np.unique(keys, axis=0):
            alike = np.flatnonzero((keys == key).all(axis=1))
            loops = tiles.indices[tiles.offsets[alike][:, None] + np.arange(key[1])]
            three, four = polygon_triangles(tessellation.contracted[loops[0]])
            triangles.append(loops[:, three].reshape(-1, 3))
            diagonals.append(loops[:, four].reshape(-1, 4))
        return cls(frozen(np.concatenate(triangles), np.int64), frozen(np.concatenate(diagonals), np.int64))


def polygon_triangles(corners: Float[np.ndarray, "k 2"]) -> tuple[Int[np.ndarray, "q 3"], Int[np.ndarray, "d 4"]]:
    """Triangulate a counter-clockwise simple polygon so that its smallest angle is as large as possible.

    Dynamic programming over sub-polygons (Klincsek 1980), k^3 steps.

    Returns
    -------
    triangles : (k - 2, 3) int
        Corners, counter-clockwise.
    diagonals : (k - 3, 4) int
        As in :class:`TriangulatedTiles`.

    Raises
    ------
    UnusableError
        Where every triangulation has a triangle without area, or turned over.

    Examples
    --------
    >>> polygon_triangles(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]))[1].tolist()
    [[0, 1, 2, 3]]
    """
    k = len(corners)
    if k == 3:
        return np.array([[0, 1, 2]]), np.zeros((0, 4), np.int64)
    quality = np.full((k, k), np.inf)
    apex = np.full((k, k), -1)
    for span in range(2, k):
        for i in range(k - span):
            j = i + span
            options = [min(quality[i, m], quality[m, j], _smallest_angle(corners, i, m, j)) for m in range(i + 1, j)]
            # the last of those that are equal but for rounding
            best = int(np.flatnonzero(np.array(options) >= max(options) - 1e-9)[-1])
            quality[i, j], apex[i, j] = options[best], i + 1 + best
    if not quality[0, k - 1] > 0:
        raise UnusableError(f"tile: expected a simple polygon of {k} corners, counter-clockwise, got one without area")
    triangles, diagonals, todo = [], [], [(0, k - 1, -1)]
    while todo:
        i, j, beyond = todo.pop()
        if j - i < 2:
            continue
        m = int(apex[i, j])
        triangles.append([i, m, j])
        if beyond >= 0:
            diagonals.append([i, m, j, beyond])
        todo += [(i, m, j), (m, j, i)]
    return np.array(triangles), np.array(diagonals, np.int64).reshape(-1, 4)


def _smallest_angle(corners: np.ndarray, i: int, m: int, j: int) -> float:
    """Smallest angle of a triangle; negative where it is turned over."""
    a, b, c = corners[[i, m, j]]
    u, v, w = b - a, c - b, a - c
    twice = u[0] * v[1] - u[1] * v[0]
    return float(min(np.arctan2(twice, -(p @ q)) for p, q in ((u, v), (v, w), (w, u))))
