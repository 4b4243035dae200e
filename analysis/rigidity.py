"""The rigid rows of the certificate: whether the two states are one sheet of rigid, flat tiles.

Functions of points and tiles return plain arrays; functions of a sheet return the worst value and where it is.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from analysis import polygons
from analysis.finding import NOTHING, Finding
from analysis.sheet import Sheet
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation

NEAR_MISS = 0.05
"""Slit ends closer than this part of the slit's shorter side were meant to be welded."""


def edge_mismatch(sheet: Sheet, tessellation: Tessellation) -> Finding:
    """Return max | |e1| - |e2| | / L over the two copies of every slit edge, deployed."""
    pairs = tessellation.edge_pairs
    if not len(pairs):
        return NOTHING
    lengths = np.linalg.norm(sheet.local[pairs[:, :, 1]] - sheet.local[pairs[:, :, 0]], axis=2)
    difference = np.abs(lengths[:, 0] - lengths[:, 1]) / sheet.edge_length
    k = int(difference.argmax())
    return Finding(float(difference[k]), f"the slit edge from {sheet.place(pairs[k, 0, 0])}")


def ring_residuals(
    points: Float[np.ndarray, "n 3"], tiles: Loops, tessellation: Tessellation
) -> Float[np.ndarray, " r"]:
    """Return the sum of the deployed tile angles round every interior contracted vertex minus 2 pi, radians."""
    angles = polygons.corner_angles(points, tiles)
    rings = tessellation.rings
    return np.bincount(rings.owners, angles[rings.indices], len(rings)) - 2 * np.pi


def planar_offsets(points: Float[np.ndarray, "n 3"], tiles: Loops) -> Float[np.ndarray, " t"]:
    """Return the largest distance of a vertex to the best plane of its tile, per tile, units."""
    result = np.zeros(len(tiles))
    for size, (which, indices) in tiles.by_size().items():
        if size > 3:
            relative = points[indices] - points[indices].mean(axis=1, keepdims=True)
            values, vectors = np.linalg.eigh(np.einsum("gki,gkj->gij", relative, relative))
            across = vectors[:, :, 0]
            # squares of lengths lose the plane of a sliver
            thin = ~(values[:, 1] > 1e-4 * values[:, 2])
            across[thin] = np.linalg.svd(relative[thin], full_matrices=False)[2][:, 2]
            result[which] = np.abs(np.einsum("gki,gi->gk", relative, across)).max(axis=1)
    return result


def shape_changes(deployed: Float[np.ndarray, "n 3"], flat: Float[np.ndarray, "n d"], tiles: Loops) -> np.ndarray:
    """Return the largest change of a vertex-to-vertex distance of every tile between the states, (t,) units."""
    result = np.zeros(len(tiles))
    for size, (which, indices) in tiles.by_size().items():
        a, b = np.triu_indices(size, 1)
        before = np.linalg.norm(deployed[indices[:, a]] - deployed[indices[:, b]], axis=2)
        after = np.linalg.norm(flat[indices[:, a]] - flat[indices[:, b]], axis=2)
        result[which] = np.abs(before - after).max(axis=1)
    return result


def closure_gaps(flat: Float[np.ndarray, "n d"], weld: np.ndarray) -> Float[np.ndarray, " n"]:
    """Return the largest distance of every contracted vertex to another copy of its welded vertex, units."""
    order = np.argsort(weld, kind="stable")
    counts = np.bincount(weld)
    copies = Loops(np.r_[0, np.cumsum(counts)], order)
    result = np.zeros(len(flat))
    for _, indices in copies.by_size().values():
        if indices.shape[1] > 1:
            apart = np.linalg.norm(flat[indices][:, :, None] - flat[indices][:, None], axis=3)
            result[indices] = apart.max(axis=2)
    return result


def closure(sheet: Sheet, tessellation: Tessellation) -> Finding:
    """Return the largest spread of the contracted copies of a vertex / L.

    Slits that almost close count as well: two sides that meet at a hinge, and whose ends come within 0.05 of
    the shorter one of each other without being welded, were meant to close. None where no vertex has a copy.
    """
    gaps = closure_gaps(sheet.flat, tessellation.weld) / sheet.edge_length
    open_hinges = tessellation.hinges[~tessellation.slit_ends]
    first, middle, second = (sheet.flat[open_hinges[:, k]] for k in range(3))
    apart = np.linalg.norm(first - second, axis=1)
    shorter = np.minimum(np.linalg.norm(first - middle, axis=1), np.linalg.norm(second - middle, axis=1))
    near = apart < NEAR_MISS * shorter
    apart = apart / sheet.edge_length
    if tessellation.n_welded == len(gaps) and not near.any():
        return NOTHING
    k = int(gaps.argmax())
    found = Finding(float(gaps[k]), sheet.place(k))
    if near.any():
        worst = int(np.flatnonzero(near)[apart[near].argmax()])
        if apart[worst] > (found.value or 0.0):
            found = Finding(
                float(apart[worst]), f"the slit at {sheet.place(open_hinges[worst, 1])}, which does not close"
            )
    return found


def openings(points: Float[np.ndarray, "n 3"], tiles: Loops, tessellation: Tessellation) -> Float[np.ndarray, " k"]:
    """Return the signed opening of every hinge of `tessellation.hinges`, radians in (-pi, pi].

    The angle from the first to the second side of the gap about the mean of the two tiles' unit normals,
    both sides seen along that axis. Positive where the gap is open, negative where the tiles overlap.
    """
    hinges = tessellation.hinges
    normals = polygons.normals(points, tiles)
    first, second = hinge_tiles(tessellation).T
    axis = polygons.unit(normals[first] + normals[second])
    u = points[hinges[:, 0]] - points[hinges[:, 1]]
    v = points[hinges[:, 2]] - points[hinges[:, 1]]
    sine = np.einsum("ki,ki->k", axis, np.cross(u, v))
    along = np.einsum("ki,ki->k", u, axis) * np.einsum("ki,ki->k", v, axis)
    return np.arctan2(sine, np.einsum("ki,ki->k", u, v) - along)


def folds(points: Float[np.ndarray, "n 3"], tiles: Loops, tessellation: Tessellation) -> Float[np.ndarray, " k"]:
    """Return the angle between the normals of the two tiles at every hinge, radians in [0, pi]."""
    normals = polygons.normals(points, tiles)
    a, b = (normals[tile] for tile in hinge_tiles(tessellation).T)
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ki,ki->k", a, b))


def hinge_tiles(tessellation: Tessellation) -> Int[np.ndarray, "k 2"]:
    """Return the tiles of the first and of the second side of every hinge."""
    n = tessellation.n_vertices
    previous, vertex, following = tessellation.corners.T
    entering, leaving = previous * n + vertex, vertex * n + following
    first, second = np.argsort(entering), np.argsort(leaving)
    hinges = tessellation.hinges
    corners = (
        first[np.searchsorted(entering[first], hinges[:, 0] * n + hinges[:, 1])],
        second[np.searchsorted(leaving[second], hinges[:, 1] * n + hinges[:, 2])],
    )
    return np.stack([tessellation.tiles.owners[corner] for corner in corners], axis=1)
