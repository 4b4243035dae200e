"""Everything measured on a finished design, as named fields, tables and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from analysis import polygons
from analysis.boundary_layer import measure_boundary_layer
from analysis.fields import tile_fields, vertex_fields
from analysis.hole_measures import measure_holes
from analysis.numbers import boundary_numbers, distance_numbers, size_numbers
from analysis.openness import measure_openness
from analysis.tables import hole_rows, number_rows
from kirisurf.arrays import checked, frozen
from kirisurf.closest import ClosestPoints
from kirisurf.errors import UnusableError
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Measures:
    """Named fields, tables and numbers of a design.

    Attributes
    ----------
    fields : mapping of (where, name) to array
        `where` is vertex, tile or hole; lengths in the user's units unless the name or the list below says
        otherwise, angles in radians.

        vertex: `distance` (signed, positive on the side of the target's normals), `distance_over_edge`,
        `closure_gap` (to the farthest contracted copy), `residual_ring` (of the vertex's ring, 0 elsewhere),
        `opening_angle_mean` (over the slit ends at the vertex, NaN where there is none).

        tile: `planarity` and `isometry` (over L), `area`, `size_ratio` (mean edge over L), `smallest_edge` (over L),
        `corner_angle_min`, `corner_angle_max`, `tile_angle_deviation` (largest difference of an angle to that of the
        regular pattern), `area_magnification` (deployed over contracted, holes handed out to the tiles round them;
        NaN at the rim), `angle_excess` (0 for a flat tile), `target_integrated_gaussian_curvature` (under the tile).

        hole: `mean_curvature`, `gaussian_curvature`, `principal_curvature_1` (the larger), `principal_curvature_2` (of
        the patch, at its center), `mean_curvature_averaged`, `gaussian_curvature_averaged`,
        `integrated_gaussian_curvature` (over the hole), `target_mean_curvature`, `target_gaussian_curvature` (at the
        closest point of the center), `mean_curvature_difference`, `gaussian_curvature_difference` (center minus
        target) and their two parts `mean_curvature_from_patch`, `gaussian_curvature_from_patch`,
        `mean_curvature_from_fit`, `gaussian_curvature_from_fit`, `angle_defect`, `gauss_image_area` (curvature of the
        hole with its share of the tiles, by angles, NaN at the rim, and by normals),
        `target_integrated_gaussian_curvature` (beneath the hole), `target_integrated_gaussian_curvature_cell` (beneath
        the hole and its share of the tiles), `area`, `opening_angle` (smallest at a slit end of the hole),
        `opening_angle_mean`, `flag` (1: the vertices do not determine the patch's curvature).
    tables : mapping of str to list of rows
        `holes`: a row per hole, `numbers`: name and value.
    numbers : mapping of str to float
        Single values of the design, those of :mod:`analysis.numbers`.
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
    target_outline: ArrayLike | None = None,
) -> Measures:
    """Measure a design.

    docs/measures.md gives every measure in words and by its formula.

    Parameters
    ----------
    tessellation : Tessellation
    deployed : (n, 3), units
    contracted : (n, 2) or (n, 3), units
    surface : Surface
        The target.
    closest : ClosestPoints, optional
        The target's closest-point tree, where one is at hand.
    target_outline : (m, 2), units, optional
        For a planar target, whose sheet lies in z = 0: corners of its outline, the last joined to the first. The
        boundary layer and the gaps along the outline are then measured.

    Raises
    ------
    UnusableError
        Where an array has another shape or a number that is not finite, the target is not fit for closest points,
        or its outline is no simple polygon.

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
    local = points - points.mean(axis=0)
    holes = measure_holes(points, tessellation, closest)
    flagged = holes.patches.ill_conditioned
    # a patch that is not determined is no measure of what it covers
    vectors = np.linalg.norm(polygons.area_vectors(local, tessellation.holes), axis=1)
    hole_areas = np.where(flagged, vectors, np.abs(holes.curvature.areas))
    groups = {
        "vertex": vertex_fields(tessellation, points, flat, closest, length),
        "tile": tile_fields(tessellation, local, flat, hole_areas, length, holes.found),
        "hole": dict(holes.fields),
    }
    fields = {(where, name): frozen(v, v.dtype) for where, group in groups.items() for name, v in group.items()}
    openness = measure_openness(local, flat, tessellation, hole_areas)
    numbers = {"edge_length": length}
    numbers |= distance_numbers(groups["vertex"]["distance_over_edge"])
    numbers |= size_numbers(tessellation, local, openness) | {"target_area": surface.area}
    if target_outline is not None:
        numbers |= boundary_numbers(measure_boundary_layer(points, tessellation, target_outline))
    numbers |= holes.numbers
    return Measures(
        fields=MappingProxyType(fields),
        tables=MappingProxyType({"holes": hole_rows(holes.centers, groups["hole"]), "numbers": number_rows(numbers)}),
        numbers=MappingProxyType(numbers),
    )
