"""The initial guess: the regular pattern laid on a flattening and lifted back to the target."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import group_means
from kirisurf.flattening import Flattening
from kirisurf.placement import Placement
from kirisurf.tessellation import Tessellation


def rotation_from_stretch(stretch: np.ndarray, least: float, most: float) -> np.ndarray:
    """Tile rotation (radians) of rotating squares at a stretch cos(a) + sin(a), kept within [least, most]."""
    sine = np.clip(np.asarray(stretch) ** 2 - 1.0, 0.0, 1.0)
    return np.clip(0.5 * np.arcsin(sine), least, most)


def lay_quads(
    tessellation: Tessellation,
    placement: Placement,
    flattening: Flattening,
    log_stretch: Float[np.ndarray, " t"],
    least_opening: float = np.radians(6.0),
    most_opening: float = np.radians(84.0),
) -> Float[np.ndarray, "n 3"]:
    """Lay a quad pattern on a flattening, each tile opened as far as the target asks there, and lift it.

    A tile is a square turned by half the local opening, alternately left and right; a vertex takes the
    mean of the places that its tiles give it. With the opening that follows the conformal scale factor the
    sheet meets every constraint up to the second order in the tile size, the angle sums included.

    Parameters
    ----------
    tessellation : Tessellation
        Quad pattern; `contracted` is the lattice.
    placement : Placement
    flattening : Flattening
        Gives the positions.
    log_stretch : (t,)
        Logarithm of the stretch (deployed over contracted length) at the middle of every tile.
    least_opening, most_opening : float
        Range of the slits' opening angle in radians.
    """
    tiles = tessellation.tiles.indices.reshape(-1, 4)
    centers = tessellation.contracted[tiles].mean(axis=1)
    rotation = rotation_from_stretch(np.exp(log_stretch), 0.5 * least_opening, 0.5 * most_opening)
    parity = np.where((tessellation.cells[:, 2] == 0) | (tessellation.cells[:, 2] == 3), 1.0, -1.0)
    cosine, sine = np.cos(rotation), np.sin(rotation) * parity
    size = 1.0 / (cosine + np.abs(sine))
    turn = size[:, None, None] * np.stack([np.stack([cosine, -sine], 1), np.stack([sine, cosine], 1)], 1)
    offsets = np.einsum("tij,tkj->tki", turn, tessellation.contracted[tiles] - centers[:, None])
    corners = (centers[:, None] + offsets) @ placement.matrix.T + placement.origin
    return flattening.lift(group_means(corners.reshape(-1, 2), tiles.ravel(), tessellation.n_vertices))


def tile_centers(tessellation: Tessellation, placement: Placement) -> Float[np.ndarray, "t 2"]:
    """Flat middles of the tiles of a quad pattern."""
    tiles = tessellation.tiles.indices.reshape(-1, 4)
    return tessellation.contracted[tiles].mean(axis=1) @ placement.matrix.T + placement.origin
