"""The sides of holes: which tile lies beyond each, and what is handed out from tiles to the holes round them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from analysis import polygons
from kirisurf.arrays import group_means
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation


def sides_beyond(tessellation: Tessellation) -> Int[np.ndarray, " s"]:
    """Return the tile side that runs against every side of every hole, in the order of `tessellation.holes.indices`.

    Returns
    -------
    (s,) int
        Positions in `tessellation.tiles.indices`.
    """
    tiles, n = tessellation.tiles, tessellation.n_vertices
    key = tiles.indices * n + tiles.successors
    order = np.argsort(key)
    wanted = tessellation.holes.successors * n + tessellation.holes.indices
    return order[np.searchsorted(key[order], wanted)]


def tiles_beyond(tessellation: Tessellation) -> Int[np.ndarray, " s"]:
    """Return the tile beyond every side of every hole, in the order of `tessellation.holes.indices`."""
    return tessellation.tiles.owners[sides_beyond(tessellation)]


def center_fans(points: Float[np.ndarray, "n 3"], loops: Loops) -> Float[np.ndarray, "s 3 3"]:
    """Return a triangle from the mean of a loop's corners to every side, in the order of `loops.indices`."""
    corners = points[loops.indices]
    middles = group_means(corners, loops.owners, len(loops)) if len(corners) else corners
    return np.stack([middles[loops.owners], corners, points[loops.successors]], axis=1)


def to_holes(values: Float[np.ndarray, " t"], tessellation: Tessellation) -> Float[np.ndarray, " g"]:
    """Hand a value of every tile out in equal parts to its sides, and return what every hole gets by its sides.

    What a tile has on the rim goes to nobody.
    """
    tile, holes = tiles_beyond(tessellation), tessellation.holes
    return np.bincount(holes.owners, values[tile] / tessellation.tiles.sizes[tile], len(holes))


def gauss_image_areas(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> Float[np.ndarray, " g"]:
    """Return the area on the unit sphere that the normals of the tiles round every hole enclose, radians.

    By Gauss, the integral of the Gaussian curvature over a piece of surface is the signed area of its normals. A
    sheet of flat tiles has one normal per tile; from tile to tile round a hole they walk round an area that is the
    curvature of the hole with its share of the tiles: positive where they turn as the tiles do, negative on saddles.
    Where only two tiles meet at a vertex, the sum over any group of holes is the area within the group's own rim.

    Parameters
    ----------
    points : (n, 3), units
        Deployed.
    tessellation : Tessellation
    """
    holes, normals = tessellation.holes, polygons.normals(points, tessellation.tiles)
    around = normals[tiles_beyond(tessellation)]
    result = np.zeros(len(holes))
    for size, (which, _) in holes.by_size().items():
        a = around[holes.offsets[which, None] + np.arange(size)]
        b = np.roll(a, -1, axis=1)
        middle = polygons.unit(a.sum(axis=1))[:, None]
        volume = np.einsum("gki,gki->gk", np.broadcast_to(middle, a.shape), np.cross(a, b))
        cosines = 1 + (middle * a).sum(axis=2) + (a * b).sum(axis=2) + (b * middle).sum(axis=2)
        # Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125: solid angle of a triangle
        result[which] = 2 * np.arctan2(volume, cosines).sum(axis=1)
    return result
