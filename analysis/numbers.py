"""Single values of a design: lengths in the user's units unless said, angles in radians, the rest ratios."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from analysis import accuracy, polygons, rigidity, tile_shapes
from analysis.boundary_layer import BoundaryLayer
from analysis.curvature import HoleCurvature
from analysis.openness import Openness
from analysis.patches import HolePatches
from kirisurf.tessellation import Tessellation


def distance_numbers(distance: Float[np.ndarray, " n"]) -> dict[str, float]:
    """Return `distance_rms`, `distance_max` and `distance_mean_signed`, over L as the distances (n,) given."""
    return {
        "distance_rms": accuracy.root_mean_square(distance),
        "distance_max": float(np.abs(distance).max()),
        "distance_mean_signed": float(distance.mean()),
    }


def size_numbers(tessellation: Tessellation, local: Float[np.ndarray, "n 3"], openness: Openness) -> dict[str, float]:
    """Return areas and magnifications, openings at the slit ends, and the shapes of the tiles.

    `tile_area`, `hole_area`, `enclosed_area` (deployed, inside the outline), `contracted_area` (inside the contracted
    outline), `porosity`, `area_magnification`, `linear_magnification`, `extent_magnification` (see
    :class:`analysis.openness.Openness`), `opening_angle_min`, `_mean`, `_max` (over the slit ends), `edge_length_min`,
    `corner_angle_min`, `_max` (of the tiles), `tile_area_spread`, `edge_length_spread` (std over mean).

    Parameters
    ----------
    tessellation : Tessellation
    local : (n, 3), units
        Deployed, near the origin.
    openness : Openness
    """
    tiles = tessellation.tiles
    angles = polygons.corner_angles(local, tiles)
    numbers = {
        "tile_area": openness.tiles,
        "hole_area": openness.holes,
        "enclosed_area": openness.enclosed,
        "contracted_area": openness.contracted,
        "edge_length_min": float(polygons.edge_lengths(local, tiles).min()),
        "corner_angle_min": float(angles.min()),
        "corner_angle_max": float(angles.max()),
        "tile_area_spread": tile_shapes.area_spread(local, tessellation),
        "edge_length_spread": tile_shapes.edge_spread(local, tessellation),
    }
    if openness.tiles > 0:
        numbers["porosity"] = openness.porosity
    if openness.contracted > 0:
        numbers |= {
            "area_magnification": openness.area_magnification,
            "linear_magnification": openness.linear_magnification,
            "extent_magnification": openness.extent_magnification,
        }
    opening = rigidity.openings(local, tiles, tessellation)[tessellation.slit_ends]
    if len(opening):
        numbers |= {
            "opening_angle_min": float(opening.min()),
            "opening_angle_mean": float(opening.mean()),
            "opening_angle_max": float(opening.max()),
        }
    return numbers


def boundary_numbers(layer: BoundaryLayer) -> dict[str, float]:
    """Return two areas over the target's, `boundary_layer_area` and `outline_area_difference`, and the gaps' means.

    `gap_base_mean` and `gap_height_mean` are lengths; see :class:`analysis.boundary_layer.BoundaryLayer`.
    """
    return {
        "boundary_layer_area": layer.area,
        "outline_area_difference": layer.outline_area,
        "gap_base_mean": float(layer.bases.mean()) if len(layer.bases) else float("nan"),
        "gap_height_mean": float(layer.heights.mean()) if len(layer.heights) else float("nan"),
    }


def curvature_numbers(
    hole: Mapping[str, np.ndarray], patches: HolePatches, curvature: HoleCurvature, length: float
) -> dict[str, float]:
    """Return how the holes' curvature compares with the target's; medians over the holes that are not flagged.

    `n_flagged_holes`, `patch_residual_max` (over L), `integrated_gaussian_curvature` and
    `integrated_target_gaussian_curvature` (sums of K times area), and for H and K `_curvature_difference_median` and
    `_curvature_difference_relative` (that over the median of the target's).

    Parameters
    ----------
    hole : mapping of str to (g,)
        Fields of the holes.
    patches : HolePatches
    curvature : HoleCurvature
    length : float
        Median tile edge, units.
    """
    good = ~patches.ill_conditioned
    numbers = {"n_flagged_holes": float((~good).sum())}
    if not len(good):
        return numbers
    area = curvature.areas
    numbers |= {
        "patch_residual_max": float(patches.residuals.max() / length),
        "integrated_gaussian_curvature": float(np.nansum((curvature.gaussian_averaged * area)[good])),
        "integrated_target_gaussian_curvature": float(np.nansum((hole["target_gaussian_curvature"] * area)[good])),
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
