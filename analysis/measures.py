"""Everything measured on a finished design, as named fields, tables and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from analysis import polygons
from analysis.boundary_layer import measure_boundary_layer
from analysis.curvature import hole_curvature
from analysis.fields import hole_fields, tile_fields, vertex_fields
from analysis.numbers import boundary_numbers, curvature_numbers, distance_numbers, size_numbers
from analysis.openness import measure_openness
from analysis.patches import hole_patches
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
        NaN at the rim).

        hole: `mean_curvature`, `gaussian_curvature` (of the patch, at its center), `mean_curvature_averaged`,
        `gaussian_curvature_averaged` (over the hole), `target_mean_curvature`, `target_gaussian_curvature`
        (at the closest point of the center), `mean_curvature_difference`, `gaussian_curvature_difference`
        (center minus target), `area`, `opening_angle` (smallest at a slit end of the hole), `opening_angle_mean`,
        `flag` (1: the vertices do not determine the patch's curvature).
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
    # products of coordinates lose digits far from the origin
    middle = points.mean(axis=0)
    local = points - middle
    patches = hole_patches(local, tessellation)
    curvature = hole_curvature(patches)
    centers = curvature.centers + middle
    # a patch that is not determined is no measure of what it covers
    vectors = np.linalg.norm(polygons.area_vectors(local, tessellation.holes), axis=1)
    hole_areas = np.where(patches.ill_conditioned, vectors, np.abs(curvature.areas))
    groups = {
        "vertex": vertex_fields(tessellation, points, flat, closest, length),
        "tile": tile_fields(tessellation, local, flat, hole_areas, length),
        "hole": hole_fields(tessellation, local, curvature, centers, closest)
        | {"flag": patches.ill_conditioned.astype(np.int64)},
    }
    fields = {(where, name): frozen(v, v.dtype) for where, group in groups.items() for name, v in group.items()}
    openness = measure_openness(local, flat, tessellation, hole_areas)
    numbers = {"edge_length": length}
    numbers |= distance_numbers(groups["vertex"]["distance_over_edge"])
    numbers |= size_numbers(tessellation, local, openness) | {"target_area": surface.area}
    if target_outline is not None:
        numbers |= boundary_numbers(measure_boundary_layer(points, tessellation, target_outline))
    numbers |= curvature_numbers(groups["hole"], patches, curvature, length)
    return Measures(
        fields=MappingProxyType(fields),
        tables=MappingProxyType({"holes": hole_rows(centers, groups["hole"]), "numbers": number_rows(numbers)}),
        numbers=MappingProxyType(numbers),
    )
