"""Everything measured on a finished design, as named fields, tables and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from analysis import accuracy, polygons, rigidity
from analysis.curvature import HoleCurvature, hole_curvature, target_curvature
from analysis.patches import HolePatches, hole_patches
from analysis.tables import hole_rows, number_rows
from kirisurf.arrays import checked, frozen
from kirisurf.closest import ClosestPoints
from kirisurf.errors import UnusableError
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation

Fields = dict[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class Measures:
    """Named fields, tables and numbers of a design.

    Attributes
    ----------
    fields : mapping of (where, name) to array
        `where` is vertex, tile or hole; lengths in the user's units unless the name or the list below says
        otherwise, angles in radians.

        vertex: `distance` (signed, positive on the side of the target's normals), `distance_over_edge`,
        `closure_gap` (to the farthest contracted copy), `residual_ring` (of the vertex's ring, 0 elsewhere).

        tile: `planarity` and `isometry` (over L), `area`, `size_ratio` (mean edge over L),
        `tile_angle_deviation` (largest difference of an angle to that of the regular polygon).

        hole: `mean_curvature`, `gaussian_curvature` (of the patch, at its center), `mean_curvature_averaged`,
        `gaussian_curvature_averaged` (over the hole), `target_mean_curvature`, `target_gaussian_curvature`
        (at the closest point of the center), `mean_curvature_difference`, `gaussian_curvature_difference`
        (center minus target), `area`, `opening_angle` (smallest at a slit end of the hole), `flag` (1: the
        vertices do not determine the patch's curvature).
    tables : mapping of str to list of rows
        `holes`: a row per hole, `numbers`: name and value.
    numbers : mapping of str to float
        Single values of the design.
    """

    fields: Mapping[tuple[str, str], np.ndarray]
    tables: Mapping[str, list[dict]]
    numbers: Mapping[str, float]


def measure(
    tessellation: Tessellation,
    deployed: ArrayLike,
    contracted: ArrayLike,
    surface: Surface,
    closest: ClosestPoints | None = None,
) -> Measures:
    """Measure a design.

    Parameters
    ----------
    tessellation : Tessellation
    deployed : (n, 3), units
    contracted : (n, 2) or (n, 3), units
    surface : Surface
        The target.
    closest : ClosestPoints, optional
        The target's closest-point tree, where one is at hand.

    Raises
    ------
    UnusableError
        Where an array has another shape or a number that is not finite, or the target is not fit for
        closest points.

    Examples
    --------
    >>> import numpy as np
    >>> from kirisurf.pattern import quad_pattern
    >>> from kirisurf.surface import Surface
    >>> pattern = quad_pattern(2, 2)
    >>> flat = np.c_[pattern.deployed, np.zeros(pattern.n_vertices)]
    >>> corners = np.array([[-1.0, -1, 0], [4, -1, 0], [4, 4, 0], [-1, 4, 0]])
    >>> target = Surface.from_arrays(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    >>> measures = measure(pattern, flat, pattern.contracted, target)
    >>> len(measures.fields["hole", "gaussian_curvature"]), round(measures.numbers["porosity"], 6)
    (9, 0.36)
    """
    points = checked(deployed, "deployed vertices", (tessellation.n_vertices, 3))
    width = np.shape(contracted)[1] if np.ndim(contracted) == 2 else 0
    flat = checked(contracted, "contracted vertices", (len(points), 2 if width == 2 else 3))
    length = float(np.median(polygons.edge_lengths(points, tessellation.tiles))) if tessellation.n_tiles else 0.0
    if not length > 0:
        raise UnusableError("deployed vertices: expected tile edges with a length, got a median of 0")
    closest = closest or ClosestPoints(surface)
    # products of coordinates lose digits far from the origin
    middle = points.mean(axis=0)
    local = points - middle
    patches = hole_patches(local, tessellation)
    curvature = hole_curvature(patches)
    centers = curvature.centers + middle
    groups = {
        "vertex": _vertex_fields(tessellation, points, flat, closest, length),
        "tile": _tile_fields(tessellation, local, flat, length),
        "hole": _hole_fields(tessellation, local, curvature, centers, closest)
        | {"flag": patches.ill_conditioned.astype(np.int64)},
    }
    fields = {(where, name): frozen(v, v.dtype) for where, group in groups.items() for name, v in group.items()}
    numbers = _numbers(groups, patches, curvature, surface, length)
    return Measures(
        fields=MappingProxyType(fields),
        tables=MappingProxyType({"holes": hole_rows(centers, groups["hole"]), "numbers": number_rows(numbers)}),
        numbers=MappingProxyType(numbers),
    )


def _vertex_fields(
    tessellation: Tessellation, points: np.ndarray, flat: np.ndarray, closest: ClosestPoints, length: float
) -> Fields:
    distance = accuracy.signed_distances(points, closest)
    residual = np.zeros(tessellation.n_welded)
    rings = rigidity.ring_residuals(points - points.mean(axis=0), tessellation.tiles, tessellation)
    residual[tessellation.ring_vertices] = rings
    return {
        "distance": distance,
        "distance_over_edge": distance / length,
        "closure_gap": rigidity.closure_gaps(flat, tessellation.weld),
        "residual_ring": residual[tessellation.weld],
    }


def _tile_fields(tessellation: Tessellation, local: np.ndarray, flat: np.ndarray, length: float) -> Fields:
    tiles = tessellation.tiles
    edges = np.add.reduceat(polygons.edge_lengths(local, tiles), tiles.offsets[:-1])
    regular = (tiles.sizes - 2) * np.pi / tiles.sizes
    deviation = np.abs(polygons.corner_angles(local, tiles) - regular[tiles.owners])
    return {
        "planarity": rigidity.planar_offsets(local, tiles) / length,
        "isometry": rigidity.shape_changes(local, flat, tiles) / length,
        "area": np.linalg.norm(polygons.area_vectors(local, tiles), axis=1),
        "size_ratio": edges / tiles.sizes / length,
        "tile_angle_deviation": np.maximum.reduceat(deviation, tiles.offsets[:-1]),
    }


def _hole_fields(
    tessellation: Tessellation,
    local: np.ndarray,
    curvature: HoleCurvature,
    centers: np.ndarray,
    closest: ClosestPoints,
) -> Fields:
    mean, gaussian = target_curvature(closest, centers, curvature.normals)
    return {
        "mean_curvature": curvature.mean,
        "gaussian_curvature": curvature.gaussian,
        "mean_curvature_averaged": curvature.mean_averaged,
        "gaussian_curvature_averaged": curvature.gaussian_averaged,
        "target_mean_curvature": mean,
        "target_gaussian_curvature": gaussian,
        "mean_curvature_difference": curvature.mean - mean,
        "gaussian_curvature_difference": curvature.gaussian - gaussian,
        "area": curvature.areas,
        "opening_angle": _hole_openings(tessellation, local),
    }


def _hole_openings(tessellation: Tessellation, local: np.ndarray) -> np.ndarray:
    """Smallest opening at a slit end of every hole; NaN for a hole without one."""
    holes, hinges = tessellation.holes, tessellation.hinges
    n = tessellation.n_vertices
    opening = np.where(tessellation.slit_ends, rigidity.openings(local, tessellation.tiles, tessellation), np.inf)
    # a hole lies on the left of its own sides: they run from the second side of a gap to the first
    leaving = hinges[:, 1] * n + hinges[:, 0]
    order = np.argsort(leaving)
    place = order[np.searchsorted(leaving[order], holes.indices * n + holes.successors)] if len(holes) else order[:0]
    result = np.full(len(holes), np.inf)
    np.minimum.at(result, holes.owners, opening[place])
    return np.where(np.isfinite(result), result, np.nan)


def _numbers(
    groups: Mapping[str, Fields],
    patches: HolePatches,
    curvature: HoleCurvature,
    surface: Surface,
    length: float,
) -> dict[str, float]:
    """Single values. Curvature differences are medians over the holes that are not flagged."""
    distance, tile, hole = groups["vertex"]["distance_over_edge"], groups["tile"], groups["hole"]
    area = float(tile["area"].sum())
    numbers = {
        "edge_length": length,
        "distance_rms": accuracy.root_mean_square(distance),
        "distance_max": float(np.abs(distance).max()),
        "distance_mean_signed": float(distance.mean()),
        "tile_area": area,
        "target_area": surface.area,
        "n_flagged_holes": float(patches.ill_conditioned.sum()),
    }
    if not len(curvature.areas):
        return numbers
    good = ~patches.ill_conditioned
    hole_area = float(np.abs(curvature.areas).sum())
    numbers |= {
        "hole_area": hole_area,
        "porosity": hole_area / (hole_area + area),
        "opening_angle_min": float(np.fmin.reduce(hole["opening_angle"])),
        "patch_residual_max": float(patches.residuals.max() / length),
        "integrated_gaussian_curvature": float(np.nansum((curvature.gaussian_averaged * curvature.areas)[good])),
        "integrated_target_gaussian_curvature": float(
            np.nansum((hole["target_gaussian_curvature"] * curvature.areas)[good])
        ),
    }
    for name in ("gaussian", "mean"):
        known = good & np.isfinite(hole[f"{name}_curvature_difference"])
        if known.any():
            median = float(np.median(np.abs(hole[f"{name}_curvature_difference"][known])))
            numbers[f"{name}_curvature_difference_median"] = median
            # relative to the median of the target, which does not blow up where the target is flat somewhere
            scale = float(np.median(np.abs(hole[f"target_{name}_curvature"][known])))
            if scale > 0:
                numbers[f"{name}_curvature_difference_relative"] = median / scale
    return numbers
