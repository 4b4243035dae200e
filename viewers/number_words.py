"""Single measures in words: what they are called, in which unit, and under which heading."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from kirisurf.field_units import unit_label
from viewers.words import number

# name: (heading, what it is, power of the user's unit, or "deg", "%", "rad" or "edge", or "" for a ratio)
_NUMBERS: dict[str, tuple[str, str, int | str]] = {
    "edge_length": ("Tiles", "median edge", 1),
    "edge_length_min": ("Tiles", "shortest edge", 1),
    "edge_length_spread": ("Tiles", "spread of the edges (standard deviation / mean)", "%"),
    "tile_area_spread": ("Tiles", "spread of the areas (standard deviation / mean)", "%"),
    "corner_angle_min": ("Tiles", "smallest corner angle", "deg"),
    "corner_angle_max": ("Tiles", "largest corner angle", "deg"),
    "opening_angle_min": ("Opening", "smallest opening angle", "deg"),
    "opening_angle_mean": ("Opening", "mean opening angle", "deg"),
    "opening_angle_max": ("Opening", "largest opening angle", "deg"),
    "porosity": ("Opening", "porosity: holes / tiles and holes", "%"),
    "area_magnification": ("Opening", "area inside the outline, open / closed", ""),
    "linear_magnification": ("Opening", "its square root", ""),
    "extent_magnification": ("Opening", "longest extent, open / closed", ""),
    "tile_area": ("Areas", "tiles", 2),
    "hole_area": ("Areas", "closed holes", 2),
    "enclosed_area": ("Areas", "inside the outline, open", 2),
    "contracted_area": ("Areas", "inside the outline, closed", 2),
    "target_area": ("Areas", "target", 2),
    "boundary_layer_area": ("Rim", "part of the target outside tiles and holes", "%"),
    "outline_area_difference": ("Rim", "area between the two outlines / target", "%"),
    "gap_base_mean": ("Rim", "gaps at the outline: mean base", 1),
    "gap_height_mean": ("Rim", "gaps at the outline: mean height", 1),
    "distance_rms": ("Distance to the target", "root mean square", "edge"),
    "distance_max": ("Distance to the target", "largest", "edge"),
    "distance_mean_signed": ("Distance to the target", "mean, with its sign", "edge"),
    "n_flagged_holes": ("Curvature of the holes", "holes without a trustworthy patch", ""),
    "patch_residual_max": ("Curvature of the holes", "largest distance of a vertex to its patch", "edge"),
    "gaussian_curvature_target_share": ("Curvature of the holes", "K: part of it that is the target's, by area", "%"),
    "mean_curvature_target_share": ("Curvature of the holes", "H: part of it that is the target's, by area", "%"),
    "gaussian_curvature_correlation": ("Curvature of the holes", "K: correlation of holes and target", ""),
    "mean_curvature_correlation": ("Curvature of the holes", "H: correlation of holes and target", ""),
    "gaussian_curvature_difference_median": ("Curvature of the holes", "median of |K of a hole - K of the target|", -2),
    "gaussian_curvature_difference_relative": (
        "Curvature of the holes",
        "the same over the median |K| of the target",
        "%",
    ),
    "gaussian_curvature_from_fit_median": ("Curvature of the holes", "its part from the fit, median", -2),
    "gaussian_curvature_from_patch_median": ("Curvature of the holes", "its part from too few tiles, median", -2),
    "mean_curvature_difference_median": ("Curvature of the holes", "median of |H of a hole - H of the target|", -1),
    "mean_curvature_difference_relative": ("Curvature of the holes", "the same over the median |H| of the target", "%"),
    "mean_curvature_from_fit_median": ("Curvature of the holes", "its part from the fit, median", -1),
    "mean_curvature_from_patch_median": ("Curvature of the holes", "its part from too few tiles, median", -1),
    "integrated_gaussian_curvature": ("Integrated curvature", "K integrated over the holes' patches", "rad"),
    "integrated_absolute_gaussian_curvature": ("Integrated curvature", "|K| integrated likewise", "rad"),
    "integrated_target_gaussian_curvature": ("Integrated curvature", "K of the target times the holes' areas", "rad"),
    "target_gaussian_curvature_total": ("Integrated curvature", "K of the target, all of it", "rad"),
    "target_gaussian_curvature_under_tiles": ("Integrated curvature", "K of the target beneath the tiles", "rad"),
    "target_gaussian_curvature_under_holes": ("Integrated curvature", "K of the target beneath the holes", "rad"),
    "target_absolute_gaussian_curvature_total": ("Integrated curvature", "|K| of the target, all of it", "rad"),
    "target_absolute_gaussian_curvature_under_tiles": (
        "Integrated curvature",
        "|K| of the target beneath the tiles",
        "rad",
    ),
    "target_absolute_gaussian_curvature_under_holes": (
        "Integrated curvature",
        "|K| of the target beneath the holes",
        "rad",
    ),
    "sheet_gaussian_curvature": ("Gauss-Bonnet", "curvature of the whole sheet, by angles", "rad"),
    "sheet_gaussian_curvature_vertices": ("Gauss-Bonnet", "of it at inner vertices (angle defects)", "rad"),
    "sheet_gaussian_curvature_holes": ("Gauss-Bonnet", "of it in holes (angle excess)", "rad"),
    "sheet_gaussian_curvature_tiles": ("Gauss-Bonnet", "of it in tiles (angle excess)", "rad"),
    "rim_turning": ("Gauss-Bonnet", "turning of the rim", "rad"),
    "euler_characteristic": ("Gauss-Bonnet", "Euler characteristic", ""),
    "gauss_bonnet_remainder": ("Gauss-Bonnet", "what is missing to 2\u03c0 \u00d7 Euler characteristic", "rad"),
    "n_inner_holes": ("Gauss-Bonnet", "holes without a corner on the rim", ""),
    "inner_target_gaussian_curvature": ("Gauss-Bonnet", "over their cells: K of the target", "rad"),
    "inner_angle_defect": ("Gauss-Bonnet", "over their cells: the sheet by angles", "rad"),
    "inner_gauss_image_area": ("Gauss-Bonnet", "over their cells: the sheet by normals", "rad"),
    "inner_integrated_gaussian_curvature": ("Gauss-Bonnet", "of it within the holes' patches", "rad"),
    "angle_defect_difference_median": ("Gauss-Bonnet", "median of |cell by angles - cell of the target|", "rad"),
    "angle_defect_difference_relative": ("Gauss-Bonnet", "the same over the median of the target's cells", "%"),
    "gauss_image_area_difference_median": ("Gauss-Bonnet", "median of |cell by normals - cell of the target|", "rad"),
    "gauss_image_area_difference_relative": ("Gauss-Bonnet", "the same over the median of the target's cells", "%"),
}
_ORDER = {heading: k for k, heading in enumerate(dict.fromkeys(entry[0] for entry in _NUMBERS.values()))}
_OTHER = "Other measures"
BALANCE = "Gauss-Bonnet"
CURVED = ("Curvature of the holes", "Integrated curvature", BALANCE)
"""The headings of what a planar target has none of."""


@dataclass(frozen=True)
class NumberRow:
    """One measure for a reader.

    Attributes
    ----------
    name, heading, label, value, unit : str
        `value` is formatted; `unit` is empty for a ratio.
    number : float or None
        The value in that unit.
    """

    name: str
    heading: str
    label: str
    value: str
    unit: str
    number: float | int | None = None


def number_in_words(name: str, value: float | int | None, units: str = "unit") -> NumberRow:
    """Return a measure with its heading, label and unit; angles become degrees, shares percent.

    Parameters
    ----------
    name : str
        Among `measures` of result.json; an unknown one keeps its name, without underscores.
    value : float or None
    units : str
        The user's unit of length.

    Examples
    --------
    >>> row = number_in_words("opening_angle_min", 0.5235987755982988)
    >>> row.label, row.value, row.unit
    ('smallest opening angle', '30', '\N{DEGREE SIGN}')
    """
    heading, label, power = _NUMBERS.get(name, (_OTHER, name.replace("_", " ").replace("gaussian", "Gaussian"), ""))
    unit = {"deg": "\N{DEGREE SIGN}", "%": "%", "edge": "of a tile edge", "": ""}.get(str(power))
    if unit is None:
        unit = unit_label(power, units)
    if value is not None and isinstance(power, str):
        value = {"deg": math.degrees(value), "%": 100 * value}.get(power, value)
    # an angle of 30 degrees comes out of radians with a rounding error in its last digit
    rounded = round(value, 9) if isinstance(value, float) and power == "deg" else value
    return NumberRow(name, heading, label, number(rounded), unit, rounded)


def measures_by_heading(numbers: Mapping[str, float | int | None], units: str = "unit") -> dict[str, list[NumberRow]]:
    """Return every measure in words under its heading, in the order of docs/measures.md; unknown ones come last."""
    rows = [number_in_words(name, value, units) for name, value in numbers.items()]
    found: dict[str, list[NumberRow]] = {}
    order = {name: k for k, name in enumerate(_NUMBERS)}
    for row in sorted(rows, key=lambda row: (_ORDER.get(row.heading, len(_ORDER)), order.get(row.name, len(order)))):
        found.setdefault(row.heading, []).append(row)
    return found


CURVATURE = "Curvature of the holes"
