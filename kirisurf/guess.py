"""The initial guess: the regular pattern laid on a flattening and lifted back to the target."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import group_means
from kirisurf.flattening import Flattening
from kirisurf.placement import Placement
from kirisurf.regular import Regular
from kirisurf.tessellation import Tessellation


def lay_tiles(
    tessellation: Tessellation,
    placement: Placement,
    regular: Regular,
    way: Float[np.ndarray, " t"],
) -> Float[np.ndarray, "n 2"]:
    """Lay a pattern in the plane of a flattening, each tile opened as far as the target asks there.

    A tile has the place in the lattice and the turn of its state, and the size at which that state has the cells of
    the lattice; a vertex takes the mean of the places that its tiles give it. With states whose stretch follows the
    conformal scale factor, and where these are similar lattices, the lifted sheet misses its constraints by an amount
    that falls with the tile size.

    Parameters
    ----------
    tessellation : Tessellation
        Of the same cell.
    placement : Placement
    regular : Regular
    way : (t,)
        State of every tile, see :class:`kirisurf.motion.Motion`.
    """
    lattice = regular.lattice
    corners = regular.motion.corners(tessellation.cells, way, lattice)
    corners = corners @ (placement.matrix @ np.linalg.inv(lattice.T)).T + placement.origin
    return group_means(corners, tessellation.tiles.indices, tessellation.n_vertices)


def tile_centers(tessellation: Tessellation, placement: Placement, regular: Regular) -> Float[np.ndarray, "t 2"]:
    """Flat middles of the contracted tiles."""
    corner = fractions(tessellation, regular)[tessellation.tiles.indices]
    middle = group_means(corner, tessellation.tiles.owners, tessellation.n_tiles)
    return middle @ placement.matrix.T + placement.origin


def fractions(tessellation: Tessellation, regular: Regular) -> Float[np.ndarray, "n 2"]:
    """Place of every vertex in the contracted lattice, in columns and rows."""
    return tessellation.contracted @ np.linalg.inv(regular.motion.cell.contracted_shifts)


def lift(flattening: Flattening, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
    """Return flat points on the target, on its smooth surface where it has one."""
    lifted = flattening.lift(points)
    # tiles may be smaller than the triangles: the formula then says more than they do
    smooth = flattening.surface.smooth
    return lifted if smooth is None else smooth.project(lifted)[0]
