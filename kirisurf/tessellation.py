"""The tessellation: topology of a kirigami pattern and its standard layouts.

Deployed and contracted state share one vertex index space. Tiles that hinge share a vertex; the two
sides of a slit are separate vertices, which `weld` maps to one contracted vertex. Everything else
(slits, rings, holes, hinges, the outer boundary) is derived from `tiles` and `weld` in
:mod:`kirisurf.derive`, so that rectangles, trimmed outlines and foreign files go through one constructor.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.loops import Loops


@dataclass(frozen=True, eq=False)
class Tessellation:
    """A pattern of t tiles on n vertices that contracts to w welded vertices.

    Attributes
    ----------
    deployed : (n, 2)
        Standard deployed layout in the plane (unit: one unit cell is about 1).
    contracted : (n, 2)
        Standard contracted layout; welded copies coincide.
    weld : (n,)
        Contracted vertex of every vertex, 0 ... w - 1.
    tiles : Loops
        Counter-clockwise vertex loop of every tile.
    cells : (t, 3)
        Unit cell (column, row) of every tile and its number within the cell.
    edge_pairs : (e, 2, 2)
        The two copies of every slit edge: [[a, b], [c, d]] with a ~ c and b ~ d welded, the tile of
        (a, b) on the left of a -> b, the other tile on the left of d -> c.
    corners : (a, 3)
        Tile corners (previous vertex, vertex, next vertex), in the order of `tiles.indices`.
    rings : Loops
        Corners round every interior contracted vertex: their angles sum to 2 pi.
    ring_vertices : (r,)
        Contracted vertex of every ring.
    holes : Loops
        Vertices round every closed hole, counter-clockwise seen from the front (the hole on the left).
    hole_tiles : Loops
        Tiles round every hole, each once.
    openings : Loops
        Tile sides round every hole that have no partner on contraction, as positions in `tiles.indices`, in the
        hole's order: they bound what stays open there. Empty where the hole closes, as all do for quad and kagome.
    hinges : (k, 5)
        One row for every gap between two neighboring tiles at a hinge: (end of the first tile's side,
        hinge vertex, end of the second tile's side, other neighbor of the hinge vertex in the second
        tile, and in the first). Counter-clockwise about the hinge vertex, the gap lies between the two sides.
    slit_ends : (k,) bool
        True where the two sides are the copies of one slit edge: the gap closes on contraction.
    outline : (o,)
        Outer vertices in counter-clockwise order, notches left out.
    sides : mapping of str to (s,) int
        Named parts of the outline: bottom, right, top, left for a rectangle; outline for a trimmed one.
    name : str
    """

    deployed: Float[np.ndarray, "n 2"]
    contracted: Float[np.ndarray, "n 2"]
    weld: Int[np.ndarray, " n"]
    tiles: Loops
    cells: Int[np.ndarray, "t 3"]
    edge_pairs: Int[np.ndarray, "e 2 2"]
    corners: Int[np.ndarray, "a 3"]
    rings: Loops
    ring_vertices: Int[np.ndarray, " r"]
    holes: Loops
    hole_tiles: Loops
    openings: Loops
    hinges: Int[np.ndarray, "k 5"]
    slit_ends: np.ndarray
    outline: Int[np.ndarray, " o"]
    sides: Mapping[str, np.ndarray]
    name: str = "quad"

    @property
    def has_openings(self) -> bool:
        """Does anything stay open by design inside the contracted sheet?"""
        return bool((self.openings.sizes > 0).any())

    @property
    def n_vertices(self) -> int:
        """Number of deployed vertices."""
        return len(self.weld)

    @property
    def n_welded(self) -> int:
        """Number of contracted vertices."""
        return int(self.weld.max()) + 1 if len(self.weld) else 0

    @property
    def n_tiles(self) -> int:
        """Number of tiles."""
        return len(self.tiles)
