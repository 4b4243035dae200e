"""Gauss-Bonnet for a sheet: how much it curves at its corners and in its holes, and how much its rim turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from analysis import polygons
from analysis.hole_sides import tiles_beyond, to_holes
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Balance:
    """Curvature of the sheet of tiles and closed holes, by angles alone: all in radians.

    With angles measured between the sides in space,

        sum over inner vertices (2 pi - angles) + sum over holes (angles - (k - 2) pi) + the same over tiles
        = 2 pi euler - sum along the rim (pi - angles),

    whatever surfaces fill the holes. A flat tile has no excess; a hole between four corners in a plane has none
    either, and curves at its corners alone.

    Attributes
    ----------
    hole_excess : (g,)
        Sum of the angles of a hole of k corners minus (k - 2) pi.
    vertex_shares : (g,)
        Of the angle defects of the hole's corners, each in equal parts to the holes there.
    tile_excess : (t,)
        Sum of the angles of a tile of k corners minus (k - 2) pi.
    tile_shares : (g,)
        Of the excess of the tiles round the hole, each in equal parts to its sides: 0 for flat tiles.
    is_inner : (g,) bool
        All corners of the hole are inner vertices: nothing is missing in its shares.
    vertices, holes, tiles, rim : float
        Totals over inner vertices, holes and tiles, and the turning of the rim.
    euler : int
        Euler characteristic of the sheet, cut where its rim meets itself: 1 for a disk, and one more for every part
        that hangs by a single vertex of the rim.
    """

    hole_excess: Float[np.ndarray, " g"]
    vertex_shares: Float[np.ndarray, " g"]
    tile_excess: Float[np.ndarray, " t"]
    tile_shares: Float[np.ndarray, " g"]
    is_inner: Bool[np.ndarray, " g"]
    vertices: float
    holes: float
    tiles: float
    rim: float
    euler: int

    @property
    def defects(self) -> Float[np.ndarray, " g"]:
        """Curvature of every hole with its share of the tiles round it, (g,); NaN for a hole with a corner on the rim.

        It comes near the integral of the Gaussian curvature over the hole and those shares.
        """
        return np.where(self.is_inner, self.hole_excess + self.vertex_shares + self.tile_shares, np.nan)

    @property
    def total(self) -> float:
        """Curvature of the whole sheet."""
        return self.vertices + self.holes + self.tiles

    @property
    def remainder(self) -> float:
        """What is missing in the identity: rounding."""
        return 2 * np.pi * self.euler - self.rim - self.total


def balance(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> Balance:
    """Return the balance of a sheet.

    Parameters
    ----------
    points : (n, 3), units
        Deployed.
    tessellation : Tessellation

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(3, 3)
    >>> flat = balance(np.pad(pattern.deployed, ((0, 0), (0, 1))), pattern)
    >>> round(flat.total, 9) + 0.0, round(flat.rim / np.pi, 9), flat.euler
    (0.0, 2.0, 1)
    """
    tiles, holes, n = tessellation.tiles, tessellation.holes, tessellation.n_vertices
    fronts = polygons.normals(points, tiles)
    beyond = tiles_beyond(tessellation)
    at_tiles = polygons.angles_in_space(points, tiles, fronts[tiles.owners])
    at_holes = polygons.angles_in_space(points, holes, fronts[beyond] + fronts[beyond[polygons.before(holes)]])

    angles = np.bincount(tiles.indices, at_tiles, n) + np.bincount(holes.indices, at_holes, n)
    rim, n_edges = _rim(tessellation)
    used = np.bincount(tiles.indices, minlength=n) > 0
    inner = used & (np.bincount(rim[:, 0], minlength=n) == 0)
    defects = np.where(inner, 2 * np.pi - angles, 0.0)
    excess, tile_excess = _excess(at_holes, holes), _excess(at_tiles, tiles)

    shared = defects / np.maximum(np.bincount(holes.indices, minlength=n), 1)
    g = len(holes)
    corners = np.bincount(holes.owners, minlength=g)
    # every piece of the rim has as many vertices as sides, once a vertex where it meets itself counts as often
    euler = int(inner.sum()) + len(rim) - n_edges + len(tiles) + g
    return Balance(
        hole_excess=excess,
        vertex_shares=np.bincount(holes.owners, shared[holes.indices], g),
        tile_excess=tile_excess,
        tile_shares=to_holes(tile_excess, tessellation),
        is_inner=np.bincount(holes.owners, inner[holes.indices], g) == corners,
        vertices=float(defects.sum()),
        holes=float(excess.sum()),
        tiles=float(tile_excess.sum()),
        rim=float(np.pi * len(rim) - angles[used & ~inner].sum()),
        euler=euler,
    )


def _excess(angles: np.ndarray, loops: Loops) -> np.ndarray:
    return np.bincount(loops.owners, angles, len(loops)) - (loops.sizes - 2) * np.pi


def _rim(tessellation: Tessellation) -> tuple[np.ndarray, int]:
    """Directed sides (b, 2) of tiles and holes that have nothing on their right, and the number of all edges."""
    edges = np.concatenate([tessellation.tiles.edges, tessellation.holes.edges])
    n = tessellation.n_vertices
    free = ~np.isin(edges @ np.array([n, 1]), edges @ np.array([1, n]))
    return edges[free], int(len(edges) + free.sum()) // 2
