"""Where curvature resides, and how far it is the target's, as single values."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float

from analysis.gauss_bonnet import Balance
from analysis.residence import Residence

CONSTANT = 1e-6
"""Spread of the target's curvature over its size below which nothing can correlate with it."""

NONE = 1e-9
"""Curvature, without units, below which a target has none: nothing is said relative to it."""


def residence_numbers(
    found: Residence, angles: Balance, hole: Mapping[str, np.ndarray], good: Bool[np.ndarray, " g"]
) -> dict[str, float]:
    """Return Gauss-Bonnet's terms, where curvature resides, and the target's part in the holes' curvature.

    docs/measures.md gives each by name. A sheet without holes has the terms of Gauss-Bonnet alone.

    Parameters
    ----------
    found : Residence
    angles : Balance
    hole : mapping of str to (g,)
        Fields of the holes.
    good : (g,) bool
        Holes that are not flagged.
    """
    numbers = {
        "sheet_gaussian_curvature": angles.total,
        "sheet_gaussian_curvature_vertices": angles.vertices,
        "sheet_gaussian_curvature_holes": angles.holes,
        "sheet_gaussian_curvature_tiles": angles.tiles,
        "rim_turning": angles.rim,
        "euler_characteristic": float(angles.euler),
        "gauss_bonnet_remainder": angles.remainder,
        "target_gaussian_curvature_total": found.target_curvature,
        "target_gaussian_curvature_under_tiles": float(found.target_tile_curvatures.sum()),
        "target_gaussian_curvature_under_holes": float(found.target_hole_curvatures.sum()),
        "target_absolute_gaussian_curvature_total": found.target_magnitude,
        "target_absolute_gaussian_curvature_under_tiles": float(found.target_tile_magnitudes.sum()),
        "target_absolute_gaussian_curvature_under_holes": float(found.target_hole_magnitudes.sum()),
    }
    if not len(good):
        return numbers
    numbers["integrated_absolute_gaussian_curvature"] = float(np.nansum(found.hole_magnitudes[good]))
    inner = good & angles.is_inner
    numbers["n_inner_holes"] = float(inner.sum())
    if inner.any():
        cells = found.target_cell_curvatures[inner]
        numbers |= {
            "inner_integrated_gaussian_curvature": float(np.nansum(found.hole_curvatures[inner])),
            "inner_angle_defect": float(found.cell_curvatures[inner].sum()),
            "inner_gauss_image_area": float(hole["gauss_image_area"][inner].sum()),
            "inner_target_gaussian_curvature": float(cells.sum()),
        }
        scale = float(np.median(np.abs(cells)))
        for name in ("angle_defect", "gauss_image_area"):
            median = float(np.median(np.abs(hole[name][inner] - cells)))
            numbers[f"{name}_difference_median"] = median
            if scale > NONE:
                numbers[f"{name}_difference_relative"] = median / scale
    for name in ("gaussian_curvature", "mean_curvature"):
        numbers |= part_numbers(name, hole, good)
    return numbers


def part_numbers(name: str, hole: Mapping[str, np.ndarray], good: Bool[np.ndarray, " g"]) -> dict[str, float]:
    """Return what of a curvature of the holes is the target's.

    `_correlation` with that of the target (left out where the target's is constant), `_target_share`
    (sum of |target| over the sum of |target| + |difference|, weighted by area: 1 where the holes have the curvature of
    the target), `_from_fit_median` and `_from_patch_median` (medians of the absolute parts).

    Parameters
    ----------
    name : str
        mean_curvature or gaussian_curvature.
    hole : mapping of str to (g,)
    good : (g,) bool
    """
    value, target, area = hole[name], hole[f"target_{name}"], np.abs(hole["area"])
    known = good & np.isfinite(value) & np.isfinite(target) & np.isfinite(area)
    if not known.any():
        return {}
    value, target, area = value[known], target[known], area[known]
    numbers = {
        f"{name}_{part}_median": float(np.median(np.abs(hole[f"{name}_{part}"][known])))
        for part in ("from_fit", "from_patch")
    }
    whole = float((area * np.abs(target)).sum())
    total = whole + float((area * np.abs(value - target)).sum())
    # K times an area has no unit; H times an area is a length
    if whole > NONE * (1.0 if name == "gaussian_curvature" else np.sqrt(area.sum())):
        numbers[f"{name}_target_share"] = whole / total
    correlation = _correlation(value, target)
    if correlation is not None:
        numbers[f"{name}_correlation"] = correlation
    return numbers


def _correlation(value: Float[np.ndarray, " n"], target: Float[np.ndarray, " n"]) -> float | None:
    spreads = value.std(), target.std()
    if spreads[1] <= CONSTANT * np.abs(target).max() or not spreads[0] > 0:
        return None
    return float(np.mean((value - value.mean()) * (target - target.mean())) / (spreads[0] * spreads[1]))
