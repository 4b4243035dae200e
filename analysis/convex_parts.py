"""Tiles cut into convex parts along diagonals, for tests that only know convex bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float, Int

from analysis import polygons
from kirisurf.arrays import frozen
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops

STRAIGHT = np.pi * (1 + 1e-9)
"""Corner from which on a polygon is not convex, in radians; straight up to rounding is convex."""


@dataclass(frozen=True, eq=False)
class ConvexParts:
    """Convex parts of tiles.

    Attributes
    ----------
    corners : (q, k)
        Vertices of every part, counter-clockwise; smaller parts repeat their last one.
    tiles : (q,)
        Tile of every part; the parts of a tile stand together.
    first : (t + 1,)
        Number of the first part of every tile.
    """

    corners: Int[np.ndarray, "q k"]
    tiles: Int[np.ndarray, " q"]
    first: Int[np.ndarray, " t_plus_1"]

    @classmethod
    def of(
        cls, points: Float[np.ndarray, "n 3"], tiles: Loops, hinges: Int[np.ndarray, " m"], widest: float = np.pi
    ) -> ConvexParts:
        """Cut tiles into convex parts, as few as a greedy choice among the diagonals of a triangulation leaves.

        Diagonals are taken away while both parts together stay convex (Hertel and Mehlhorn 1983), which leaves at
        most four times as many parts as there must be.

        Parameters
        ----------
        points : (n, 3), units
        tiles : Loops
        hinges : (m,)
            Vertices at which corners are cut where they are wider than `widest`, and a diagonal starts there.
        widest : float, radians

        Raises
        ------
        UnusableError
            Where a tile has no area, or crosses itself.
        """
        angles = polygons.corner_angles(points, tiles)
        at_hinge = np.isin(tiles.indices, hinges)
        limits = np.where(at_hinge, min(widest * (1 + 1e-9), STRAIGHT), STRAIGHT)
        whole = np.ones(len(tiles), bool)
        np.logical_and.at(whole, tiles.owners, angles <= limits)
        whole |= tiles.sizes == 3
        # a polygon that winds round twice has no reflex corner either
        total = np.bincount(tiles.owners, angles, len(tiles))
        whole &= np.abs(total - (tiles.sizes - 2) * np.pi) < 1e-6
        loops: list[list[np.ndarray]] = [[tiles[k]] if whole[k] else [] for k in range(len(tiles))]
        for k, triangles in _triangles(points, tiles, np.flatnonzero(~whole).tolist()).items():
            at = slice(tiles.offsets[k], tiles.offsets[k + 1])
            flat = polygons.flattened(points[tiles[k]])
            loops[k] = [tiles[k][part] for part in _merged(flat, triangles, limits[at])]
        count = np.array([len(found) for found in loops], np.int64)
        most = max((len(part) for found in loops for part in found), default=3)
        corners = [np.r_[part, np.full(most - len(part), part[-1])] for found in loops for part in found]
        return cls(
            frozen(np.array(corners, np.int64).reshape(-1, most), np.int64),
            frozen(np.repeat(np.arange(len(tiles)), count), np.int64),
            frozen(np.r_[0, np.cumsum(count)], np.int64),
        )


def _triangles(points: np.ndarray, tiles: Loops, which: list[int]) -> dict[int, np.ndarray]:
    """Corner numbers (m, 3), counter-clockwise, of the triangles of the chosen tiles."""
    if not which:
        return {}
    flat = [polygons.flattened(points[tiles[k]]) for k in which]
    shapes = np.array([shapely.Polygon(corners) for corners in flat], object)
    found = shapely.constrained_delaunay_triangles(shapes)
    result = {}
    for k, corners, shape, triangles in zip(which, flat, shapes, found, strict=True):
        size = len(corners)
        places = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
        # the triangles have the coordinates of the corners, bit by bit
        number = (places[:, None] == corners[None]).all(axis=2).argmax(axis=1).reshape(-1, 3)
        a, b, c = corners[number].swapaxes(0, 1)
        turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        number[turn < 0] = number[turn < 0][:, ::-1]
        if len(number) != size - 2 or not shape.is_valid:
            raise UnusableError(f"tile {k}: expected a polygon that does not cross itself, got one that does")
        result[k] = number
    return result


def _merged(corners: np.ndarray, triangles: np.ndarray, limits: np.ndarray) -> list[list[int]]:
    """Parts of one tile: its triangles, glued along diagonals as long as no corner passes its limit."""
    parts: dict[int, list[int]] = dict(enumerate(triangles.tolist()))
    owner = {(a, b): k for k, part in parts.items() for a, b in zip(part, [*part[1:], part[0]], strict=True)}
    inner = [(a, b) for a, b in owner if a < b and (b, a) in owner]
    length = {(a, b): float(np.linalg.norm(corners[a] - corners[b])) for a, b in inner}
    for a, b in sorted(inner, key=length.__getitem__):  # the long ones stay: short ones make slivers
        one, two = owner[a, b], owner[b, a]
        glued = _glued(parts[one], parts[two], a, b)
        if all(_angle(corners, glued, v) <= limits[v] for v in (a, b)):
            parts[one] = glued
            del parts[two]
            for start, end in zip(glued, [*glued[1:], glued[0]], strict=True):
                owner[start, end] = one
    return list(parts.values())


def _glued(one: list[int], two: list[int], a: int, b: int) -> list[int]:
    """The loop round both parts: a -> b is a side of the first, b -> a of the second."""
    i, j = one.index(b), two.index(a)
    return one[i:] + one[:i] + (two[j:] + two[:j])[1:-1]


def _angle(corners: np.ndarray, loop: list[int], vertex: int) -> float:
    """Interior angle at a corner of a counter-clockwise loop, in [0, 2 pi)."""
    i = loop.index(vertex)
    u = corners[loop[(i + 1) % len(loop)]] - corners[vertex]
    v = corners[loop[i - 1]] - corners[vertex]
    return float(np.mod(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v), 2 * np.pi))
