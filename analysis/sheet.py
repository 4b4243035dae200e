"""The sheet as its two files give it: both states, the welding, and everything that follows from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from analysis import polygons
from kirisurf.arrays import checked, frozen
from kirisurf.derive import derive_tessellation
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation

WELD_RADIUS = 1e-6
"""Distance over L within which contracted vertices are copies of one welded vertex."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """Both states of a sheet with their topology, derived from nothing but points and tiles.

    Attributes
    ----------
    points : (n, 3), units
        Deployed vertices in the user's frame.
    local : (n, 3), units
        The same about their mean, where products of coordinates lose no digits.
    flat : (n, 3), units
        Contracted vertices as read, z = 0 where they came as (n, 2).
    plane : (n, 2), units
        Contracted vertices in their own plane, tiles counter-clockwise (a sheet seen from behind is mirrored).
    tiles : Loops
    numbers : (n,) int
        Vertex number in the input, for messages (vertices that no tile uses are left out here).
    edge_length : float
        L: the median deployed tile edge, units.
    tessellation : Tessellation or None
        What follows from tiles and welding; None where no sheet has this topology.
    problem : str
        Why there is no tessellation.
    """

    points: Float[np.ndarray, "n 3"]
    local: Float[np.ndarray, "n 3"]
    flat: Float[np.ndarray, "n 3"]
    plane: Float[np.ndarray, "n 2"]
    tiles: Loops
    numbers: Int[np.ndarray, " n"]
    edge_length: float
    tessellation: Tessellation | None
    problem: str = ""

    def place(self, vertex: int | np.integer, contracted: bool = False) -> str:
        """Return where a vertex is, in words: its number in the file and its coordinates, deployed unless asked."""
        x, y, z = (self.flat if contracted else self.points)[vertex]
        return f"vertex {self.numbers[vertex]} ({x:.6g}, {y:.6g}, {z:.6g})"


def read_sheet(deployed: ArrayLike, contracted: ArrayLike, tiles: Loops, weld: ArrayLike | None = None) -> Sheet:
    """Return the sheet that two states of the same tiles make.

    Parameters
    ----------
    deployed : (n, 3), units
    contracted : (n, 2) or (n, 3), units
    tiles : Loops
    weld : (n,) int, optional
        Contracted vertex of every vertex; by default contracted vertices closer than 1e-6 L are one.

    Raises
    ------
    UnusableError
        Where shapes differ, a number is not finite, an index is out of range, a tile has fewer than three
        vertices or one vertex twice, or no tile edge has a length.
    """
    points = checked(deployed, "deployed vertices", (None, 3))
    flat = np.asarray(contracted)
    width = flat.shape[1] if flat.ndim == 2 else 0
    flat = checked(flat, "contracted vertices", (len(points), 2 if width == 2 else 3))
    if width == 2:
        flat = np.pad(flat, ((0, 0), (0, 1)))
    _check_tiles(tiles, len(points))
    used = np.unique(tiles.indices)
    labels = None if weld is None else checked(weld, "weld", (len(points),), np.int64)[used]
    if len(used) < len(points):
        tiles = Loops(tiles.offsets, frozen(np.searchsorted(used, tiles.indices), np.int64))
        points, flat = frozen(points[used]), flat[used]

    edge_length = float(np.median(polygons.edge_lengths(points, tiles)))
    if not edge_length > 0:
        raise UnusableError("deployed vertices: expected tile edges with a length, got a median of 0")
    if labels is None:
        labels = coincident(flat, WELD_RADIUS * edge_length)
    plane = _in_own_plane(flat, tiles)
    tessellation, problem = None, ""
    try:
        tessellation = derive_tessellation(plane, plane, tiles, labels)
    except UnusableError as reason:
        problem = str(reason)
    return Sheet(
        points=frozen(points),
        local=frozen(points - points.mean(axis=0)),
        flat=frozen(flat),
        plane=frozen(plane),
        tiles=tiles,
        numbers=frozen(used, np.int64),
        edge_length=edge_length,
        tessellation=tessellation,
        problem=problem,
    )


def coincident(points: Float[np.ndarray, "n d"], radius: float) -> Int[np.ndarray, " n"]:
    """Number the groups of points that chains of steps up to `radius` connect: (n,) int."""
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def count_pieces(tiles: Loops) -> int:
    """Return the number of parts that hinges (shared vertices) hold together: 1 for one sheet."""
    n = int(tiles.indices.max()) + 1
    graph = coo_matrix((np.ones(len(tiles.indices)), (tiles.indices, n + tiles.owners)), shape=(n + len(tiles),) * 2)
    labels = connected_components(graph, directed=False)[1]
    return len(np.unique(labels[n:]))


def hole_fans(
    points: Float[np.ndarray, "n 3"], holes: Loops
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, "k 3"]]:
    """Return the points with the center of every hole appended, and triangles from the centers to the holes' sides."""
    sizes = np.maximum(holes.sizes, 1)
    centers = np.stack([np.bincount(holes.owners, points[holes.indices, i], len(holes)) for i in range(3)], axis=1)
    every = np.concatenate([points, centers / sizes[:, None]])
    return every, np.stack([len(points) + holes.owners, holes.indices, holes.successors], axis=1)


def _check_tiles(tiles: Loops, n: int) -> None:
    if not len(tiles):
        raise UnusableError("tiles: expected at least one, got none")
    if tiles.indices.min(initial=0) < 0 or tiles.indices.max(initial=0) >= n:
        raise UnusableError(
            f"tiles: expected vertex numbers from 0 to {n - 1}, got {tiles.indices.min()} to {tiles.indices.max()}"
        )
    if tiles.sizes.min() < 3:
        k = int(tiles.sizes.argmin())
        raise UnusableError(f"tiles: expected at least 3 vertices, got {tiles.sizes[k]} in tile {k}")
    for which, indices in tiles.by_size().values():
        ordered = np.sort(indices, axis=1)
        repeated = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
        if repeated.any():
            k = int(which[repeated.argmax()])
            raise UnusableError(f"tiles: expected different vertices, got one twice in tile {k}")


def _in_own_plane(flat: np.ndarray, tiles: Loops) -> np.ndarray:
    """Contracted points in 2-D: as they are where they lie in a plane z = const, else in their best plane."""
    relative = flat - flat.mean(axis=0)
    if np.ptp(flat[:, 2]) > 0:
        size = np.linalg.svd(relative, full_matrices=False)
        if not np.ptp(flat[:, 2]) <= 1e-12 * size[1][0]:
            relative = relative @ size[2].T
            if np.linalg.det(size[2]) < 0:
                relative[:, 1] *= -1
    facing = polygons.area_vectors(np.c_[relative[:, :2], np.zeros(len(flat))], tiles)[:, 2]
    if np.median(np.sign(facing)) < 0:
        relative = relative * np.array([-1.0, 1.0, 1.0])
    return np.ascontiguousarray(relative[:, :2])
