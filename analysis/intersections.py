"""Tiles that cross in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float, Int
from scipy.sparse import coo_matrix

from analysis import polygons
from kirisurf.loops import Loops

TOUCH = 1e-6
"""Depth over the tile edge up to which tiles touch and do not cross."""


def crossing_pairs(
    points: Float[np.ndarray, "n 3"], tiles: Loops, edge_length: float, touch: float = TOUCH
) -> Int[np.ndarray, "x 2"]:
    """Return the pairs of tiles without a common vertex that cross.

    Two flat polygons cross where both reach through the other's plane and their chords on the line of the two
    planes overlap, all by more than `touch` edge lengths, or where they lie in one plane and overlap. Touching
    is not crossing, so that the closed sheet and the flat pattern have none. Candidates come from a tree of
    bounding boxes.

    Parameters
    ----------
    points : (n, 3), units
    tiles : Loops
    edge_length : float, units
    touch : float, over the edge length

    Returns
    -------
    (x, 2) int
        Tile numbers, the smaller first.
    """
    near = touch * edge_length
    pairs = _candidates(points, tiles, near)
    if not len(pairs):
        return pairs
    normals = polygons.normals(points, tiles)
    centers = _means(points, tiles)
    crossed, level = _crossed(points, tiles, normals, centers, pairs, near)
    coplanar = np.flatnonzero(level)
    crossed[coplanar] = _overlap_in_plane(points, tiles, normals, centers, pairs[coplanar], near)
    return pairs[crossed]


def _candidates(points: np.ndarray, tiles: Loops, near: float) -> np.ndarray:
    """Pairs of tiles whose boxes overlap and that share no vertex; boxes along the sheet's principal axes."""
    relative = points - points.mean(axis=0)
    local = relative @ np.linalg.svd(relative, full_matrices=False)[2].T
    starts = tiles.offsets[:-1]
    low = np.minimum.reduceat(local[tiles.indices], starts, axis=0)
    high = np.maximum.reduceat(local[tiles.indices], starts, axis=0)
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    i, j = shapely.STRtree(boxes).query(boxes)
    keep = i < j
    i, j = i[keep].astype(np.int64), j[keep].astype(np.int64)
    # the third axis, and boxes that share no more than a side
    keep = (np.minimum(high[i], high[j]) - np.maximum(low[i], low[j]) > -near).all(axis=1)
    i, j = i[keep], j[keep]
    n = int(tiles.indices.max()) + 1
    incidence = coo_matrix((np.ones(len(tiles.indices)), (tiles.owners, tiles.indices)), shape=(len(tiles), n)).tocsr()
    sharing = (incidence @ incidence.T).tocoo()
    keep = ~np.isin(i * len(tiles) + j, sharing.row.astype(np.int64) * len(tiles) + sharing.col)
    return np.stack([i[keep], j[keep]], axis=1)


def _means(points: np.ndarray, tiles: Loops) -> np.ndarray:
    total = np.add.reduceat(points[tiles.indices], tiles.offsets[:-1], axis=0)
    return total / tiles.sizes[:, None]


def _crossed(
    points: np.ndarray, tiles: Loops, normals: np.ndarray, centers: np.ndarray, pairs: np.ndarray, near: float
) -> tuple[np.ndarray, np.ndarray]:
    """For every pair: do the tiles cross along the line of their planes, and does one lie in the other's plane?"""
    first = _heights(points, tiles, normals, centers, pairs)
    second = _heights(points, tiles, normals, centers, pairs[:, ::-1])
    level = (np.abs(first.extent).max(axis=1) <= near) | (np.abs(second.extent).max(axis=1) <= near)
    both = (np.minimum(-first.extent[:, 0], first.extent[:, 1]) > near) & (
        np.minimum(-second.extent[:, 0], second.extent[:, 1]) > near
    )
    line = polygons.unit(np.cross(normals[pairs[:, 0]], normals[pairs[:, 1]]))
    chords = [side.chords(points, tiles, centers[pairs[:, 0]], line, both) for side in (first, second)]
    crossed = np.zeros(len(pairs), bool)
    for pair in np.flatnonzero(both).tolist():
        # a convex tile has one chord on the line, a concave one may have several
        one, two = (owned[pair].reshape(-1, 2) for owned in chords)
        common = np.minimum(one[:, None, 1], two[None, :, 1]) - np.maximum(one[:, None, 0], two[None, :, 0])
        crossed[pair] = bool((common > near).any())
    return crossed, level


@dataclass(frozen=True)
class _Heights:
    """Heights of the first tiles' vertices over the second tiles' planes, edge by edge.

    owners (e,) pair of every edge; positions (e,) its place in `tiles.indices`; start, end (e,) heights of its
    ends; extent (p, 2) lowest and highest of every pair.
    """

    owners: np.ndarray
    positions: np.ndarray
    start: np.ndarray
    end: np.ndarray
    extent: np.ndarray

    def chords(
        self, points: np.ndarray, tiles: Loops, origins: np.ndarray, line: np.ndarray, wanted: np.ndarray
    ) -> dict[int, np.ndarray]:
        """Where the tiles' edges pass the planes: sorted places along the line, for every wanted pair."""
        passing = np.flatnonzero(wanted[self.owners] & ((self.start >= 0) != (self.end >= 0)))
        owner, position = self.owners[passing], self.positions[passing]
        a, b = points[tiles.indices[position]], points[tiles.successors[position]]
        t = self.start[passing] / (self.start[passing] - self.end[passing])
        place = np.einsum("ei,ei->e", a + t[:, None] * (b - a) - origins[owner], line[owner])
        order = np.lexsort((place, owner))
        pairs, first, count = np.unique(owner[order], return_index=True, return_counts=True)
        ordered = place[order]
        return {int(p): ordered[f : f + c] for p, f, c in zip(pairs, first, count, strict=True)}


def _heights(points: np.ndarray, tiles: Loops, normals: np.ndarray, centers: np.ndarray, pairs: np.ndarray) -> _Heights:
    sizes = tiles.sizes[pairs[:, 0]]
    owner = np.repeat(np.arange(len(pairs)), sizes)
    begin = np.cumsum(sizes) - sizes
    position = tiles.offsets[pairs[owner, 0]] + np.arange(len(owner)) - begin[owner]
    other = pairs[owner, 1]
    normal, center = normals[other], centers[other]
    start = np.einsum("ei,ei->e", points[tiles.indices[position]] - center, normal)
    end = np.einsum("ei,ei->e", points[tiles.successors[position]] - center, normal)
    extent = np.stack([np.minimum.reduceat(start, begin), np.maximum.reduceat(start, begin)], axis=1)
    return _Heights(owner, position, start, end, extent)


def _overlap_in_plane(
    points: np.ndarray, tiles: Loops, normals: np.ndarray, centers: np.ndarray, pairs: np.ndarray, near: float
) -> np.ndarray:
    """Do the two coplanar tiles of every pair overlap by more than a strip of width `near`?"""
    first, second = polygons.frames(normals[pairs[:, 1]])

    def flat(tile: np.ndarray) -> np.ndarray:
        result = np.empty(len(tile), object)
        for size in np.unique(tiles.sizes[tile]):
            which = np.flatnonzero(tiles.sizes[tile] == size)
            corner = points[tiles.indices[tiles.offsets[tile[which], None] + np.arange(size)]]
            corner = corner - centers[pairs[which, 1], None]
            u, v = (np.einsum("gki,gi->gk", corner, axis[which]) for axis in (first, second))
            result[which] = shapely.polygons(np.stack([u, v], axis=2))
        return shapely.make_valid(result)

    if not len(pairs):
        return np.zeros(0, bool)
    one, two = flat(pairs[:, 0]), flat(pairs[:, 1])
    met = np.flatnonzero(shapely.intersects(one, two))
    result = np.zeros(len(pairs), bool)
    common = shapely.intersection(one[met], two[met])
    result[met] = shapely.area(common) > near * np.maximum(shapely.length(common), near)
    return result
