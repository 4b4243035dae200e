"""Fields of a design: one value per vertex, tile or hole."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from analysis import accuracy, polygons, rigidity, tile_shapes
from analysis.openness import tile_magnification
from analysis.residence import Residence
from kirisurf.closest import ClosestPoints
from kirisurf.tessellation import Tessellation

Fields = dict[str, np.ndarray]


def vertex_fields(
    tessellation: Tessellation,
    points: Float[np.ndarray, "n 3"],
    flat: Float[np.ndarray, "n d"],
    closest: ClosestPoints,
    length: float,
) -> Fields:
    """Return the fields of the vertices, as :class:`analysis.measures.Measures` names them.

    Parameters
    ----------
    tessellation : Tessellation
    points : (n, 3), units
        Deployed.
    flat : (n, 2) or (n, 3), units
        Contracted.
    closest : ClosestPoints
        Of the target.
    length : float
        Median tile edge, units.
    """
    distance = accuracy.signed_distances(points, closest)
    local = points - points.mean(axis=0)
    residual = np.zeros(tessellation.n_welded)
    residual[tessellation.ring_vertices] = rigidity.ring_residuals(local, tessellation.tiles, tessellation)
    ends = tessellation.slit_ends
    opening = rigidity.openings(local, tessellation.tiles, tessellation)[ends]
    at = tessellation.hinges[ends, 1]
    count = np.bincount(at, minlength=len(points))
    total = np.bincount(at, opening, len(points))
    return {
        "distance": distance,
        "distance_over_edge": distance / length,
        "closure_gap": rigidity.closure_gaps(flat, tessellation.weld),
        "residual_ring": residual[tessellation.weld],
        "opening_angle_mean": np.where(count > 0, total / np.maximum(count, 1), np.nan),
    }


def tile_fields(
    tessellation: Tessellation,
    local: Float[np.ndarray, "n 3"],
    flat: Float[np.ndarray, "n d"],
    hole_areas: Float[np.ndarray, " g"],
    length: float,
    found: Residence,
) -> Fields:
    """Return the fields of the tiles; parameters as :func:`vertex_fields`, with deployed points near the origin."""
    tiles = tessellation.tiles
    edges = np.add.reduceat(polygons.edge_lengths(local, tiles), tiles.offsets[:-1])
    smallest, largest = tile_shapes.corner_angle_range(local, tessellation)
    return {
        "planarity": rigidity.planar_offsets(local, tiles) / length,
        "isometry": rigidity.shape_changes(local, flat, tiles) / length,
        "area": np.linalg.norm(polygons.area_vectors(local, tiles), axis=1),
        "size_ratio": edges / tiles.sizes / length,
        "smallest_edge": tile_shapes.smallest_edges(local, tessellation) / length,
        "corner_angle_min": smallest,
        "corner_angle_max": largest,
        "tile_angle_deviation": tile_shapes.angle_deviation(local, tessellation),
        "area_magnification": tile_magnification(local, flat, tessellation, hole_areas),
        "angle_excess": found.tile_curvatures,
        "target_integrated_gaussian_curvature": found.target_tile_curvatures,
    }


def hole_openings(
    tessellation: Tessellation, local: Float[np.ndarray, "n 3"]
) -> tuple[Float[np.ndarray, " g"], Float[np.ndarray, " g"]]:
    """Return the smallest and the mean opening at the slit ends of every hole, radians; NaN for a hole without one."""
    holes, hinges = tessellation.holes, tessellation.hinges
    n, g = tessellation.n_vertices, len(holes)
    opening = rigidity.openings(local, tessellation.tiles, tessellation)
    # a hole lies on the left of its own sides: they run from the second side of a gap to the first
    leaving = hinges[:, 1] * n + hinges[:, 0]
    order = np.argsort(leaving)
    wanted = holes.indices * n + holes.successors
    place = order[np.minimum(np.searchsorted(leaving[order], wanted), max(len(order) - 1, 0))]
    # beside a designed opening, corners of a hole are those of a single tile, and no hinge
    ends = (leaving[place] == wanted) & tessellation.slit_ends[place]
    place, owners = place[ends], holes.owners[ends]
    smallest = np.full(g, np.inf)
    np.minimum.at(smallest, owners, opening[place])
    count = np.bincount(owners, minlength=g)
    average = np.bincount(owners, opening[place], g) / np.maximum(count, 1)
    return np.where(count > 0, smallest, np.nan), np.where(count > 0, average, np.nan)
