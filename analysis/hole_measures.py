"""Everything measured on the holes of a sheet beside its target."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from analysis import polygons
from analysis.curvature import HoleCurvature, fundamental_forms, hole_curvature, target_curvature
from analysis.fields import hole_openings
from analysis.gauss_bonnet import Balance, balance
from analysis.hole_sides import gauss_image_areas
from analysis.numbers import curvature_numbers
from analysis.patches import HolePatches, hole_patches
from analysis.residence import Residence, residence
from analysis.residence_numbers import residence_numbers
from kirisurf.closest import ClosestPoints
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class HoleMeasures:
    """Holes with their patches, their curvature and the target's.

    Attributes
    ----------
    patches : HolePatches
        About the mean of the vertices, where products of coordinates lose no digits.
    curvature : HoleCurvature
        Of these patches.
    centers : (g, 3), units
        Of the patches, in the frame of the target.
    angles : Balance
    found : Residence
    fields : mapping of str to (g,)
        Named as in :class:`analysis.measures.Measures`.
    numbers : mapping of str to float
        Of :func:`analysis.numbers.curvature_numbers` and :func:`analysis.residence_numbers.residence_numbers`.
    """

    patches: HolePatches
    curvature: HoleCurvature
    centers: Float[np.ndarray, "g 3"]
    angles: Balance
    found: Residence
    fields: Mapping[str, np.ndarray]
    numbers: Mapping[str, float]


def measure_holes(
    points: Float[np.ndarray, "n 3"],
    tessellation: Tessellation,
    closest: ClosestPoints,
    construction: str = "tiles",
) -> HoleMeasures:
    """Measure the holes of a sheet.

    Parameters
    ----------
    points : (n, 3), units
        Deployed.
    tessellation : Tessellation
    closest : ClosestPoints
        Of the target.
    construction : {"tiles", "corners", "corners_and_normals"}
        How the patches are constructed, see :func:`analysis.patches.hole_patches`. What is not of the patches (angle
        defects, Gauss images, the target) does not depend on it.

    Raises
    ------
    ParameterError
        Where there is no such construction.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> from kirisurf.surface import Surface
    >>> pattern = quad_pattern(2, 2)
    >>> flat = np.pad(pattern.deployed, ((0, 0), (0, 1)))
    >>> square = Surface.from_arrays([[-1, -1, 0], [4, -1, 0], [4, 4, 0], [-1, 4, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> found = measure_holes(flat, pattern, ClosestPoints(square), "corners")
    >>> bool(np.abs(found.fields["gaussian_curvature"]).max() < 1e-9)
    True
    """
    middle = points.mean(axis=0)
    local = points - middle
    patches = hole_patches(local, tessellation, construction)
    curvature = hole_curvature(patches)
    centers = curvature.centers + middle
    angles = balance(local, tessellation)
    found = residence(points, tessellation, curvature, angles, closest)
    fields = _fields(tessellation, local, curvature, centers, closest, found)
    fields |= _parts(tessellation, points, curvature, closest, fields, construction)
    fields["flag"] = patches.ill_conditioned.astype(np.int64)
    length = float(np.median(polygons.edge_lengths(local, tessellation.tiles)))
    numbers = curvature_numbers(fields, patches, curvature, length)
    numbers |= residence_numbers(found, angles, fields, ~patches.ill_conditioned)
    return HoleMeasures(patches, curvature, centers, angles, found, MappingProxyType(fields), MappingProxyType(numbers))


def _fields(
    tessellation: Tessellation,
    local: np.ndarray,
    curvature: HoleCurvature,
    centers: np.ndarray,
    closest: ClosestPoints,
    found: Residence,
) -> dict[str, np.ndarray]:
    """Fields but for the flag and the parts of the curvature."""
    mean, gaussian = target_curvature(closest, centers, curvature.normals)
    smallest, average = hole_openings(tessellation, local)
    return {
        "mean_curvature": curvature.mean,
        "gaussian_curvature": curvature.gaussian,
        "mean_curvature_averaged": curvature.mean_averaged,
        "gaussian_curvature_averaged": curvature.gaussian_averaged,
        "target_mean_curvature": mean,
        "target_gaussian_curvature": gaussian,
        "mean_curvature_difference": curvature.mean - mean,
        "gaussian_curvature_difference": curvature.gaussian - gaussian,
        "principal_curvature_1": curvature.principal[:, 0],
        "principal_curvature_2": curvature.principal[:, 1],
        "integrated_gaussian_curvature": found.hole_curvatures,
        "target_integrated_gaussian_curvature": found.target_hole_curvatures,
        "angle_defect": found.cell_curvatures,
        "gauss_image_area": gauss_image_areas(local, tessellation),
        "target_integrated_gaussian_curvature_cell": found.target_cell_curvatures,
        "area": curvature.areas,
        "opening_angle": smallest,
        "opening_angle_mean": average,
    }


def _parts(
    tessellation: Tessellation,
    points: np.ndarray,
    curvature: HoleCurvature,
    closest: ClosestPoints,
    target: Mapping[str, np.ndarray],
    construction: str,
) -> dict[str, np.ndarray]:
    """How much of the holes' curvature, beside the target's, is the patches' and how much the fit's.

    The same patches through the closest points of the vertices have the curvature of a sheet that lies on the target;
    K = K of the target + (K of that sheet - K of the target) + (K - K of that sheet), and H likewise.
    """
    laid = closest.project(points).points
    patches = hole_patches(laid - laid.mean(axis=0), tessellation, construction)
    forms = fundamental_forms(patches.patches, *patches.centers.T[:, :, None])
    mean, gaussian = forms.mean[:, 0], forms.gaussian[:, 0]
    return {
        "mean_curvature_from_patch": mean - target["target_mean_curvature"],
        "gaussian_curvature_from_patch": gaussian - target["target_gaussian_curvature"],
        "mean_curvature_from_fit": curvature.mean - mean,
        "gaussian_curvature_from_fit": curvature.gaussian - gaussian,
    }
