"""Fields: named quantities on vertices, tiles or holes, with the label, unit and range to color them by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.errors import ParameterError
from kirisurf.field_units import unit_of_field

ROBUST_PERCENT = 98.0

# name: (label, power of the user's unit or "rad" or "" where it is a ratio, signed)
_KNOWN: dict[str, tuple[str, bool]] = {
    "distance": ("distance to the target", True),
    "distance_over_edge": ("distance to the target / tile edge", True),
    "closure_gap": ("closure gap", False),
    "residual_ring": ("ring residual", True),
    "planarity": ("planarity / tile edge", False),
    "isometry": ("isometry / tile edge", False),
    "area": ("area", False),
    "size_ratio": ("tile edge / median tile edge", False),
    "tile_angle_deviation": ("deviation of tile angles", False),
    "opening_angle": ("smallest opening angle", False),
    "opening_angle_mean": ("mean opening angle", False),
    "smallest_edge": ("shortest edge of the tile / median tile edge", False),
    "corner_angle_min": ("smallest tile angle", False),
    "corner_angle_max": ("largest tile angle", False),
    "area_magnification": ("area when open / area when closed", False),
    "asked_stretch": ("stretch that the target asks for", False),
    "flag": ("flag", False),
    "principal_curvature_1": ("larger principal curvature", True),
    "principal_curvature_2": ("smaller principal curvature", True),
    "angle_excess": ("angle excess of the tile", True),
    "angle_defect": ("curvature of the hole's cell by angles", True),
    "gauss_image_area": ("curvature of the hole's cell by normals", True),
    "integrated_gaussian_curvature": ("K integrated over the hole", True),
    "target_integrated_gaussian_curvature": ("K of the target, integrated beneath", True),
    "target_integrated_gaussian_curvature_cell": ("K of the target, integrated beneath the cell", True),
}
_CURVATURES = {"mean_curvature": "mean curvature H", "gaussian_curvature": "Gaussian curvature K"}
_VARIANTS = {
    "{}": "{}",
    "{}_averaged": "{}, averaged over the hole",
    "target_{}": "{} of the target",
    "{}_difference": "{}, hole minus target",
    "{}_from_patch": "{}, part of too few tiles",
    "{}_from_fit": "{}, part of the fit",
}
_KNOWN |= {
    variant.format(name): (words.format(label), True)
    for name, label in _CURVATURES.items()
    for variant, words in _VARIANTS.items()
}


@dataclass(frozen=True, eq=False)
class Field:
    """A quantity to color by.

    Attributes
    ----------
    name : str
        Its name among the measures, such as gaussian_curvature.
    where : str
        vertex, tile or hole.
    values : (k,)
        One number per vertex, tile or hole; NaN where there is none.
    label, unit : str
        What it is in words, and its unit; the unit of a ratio is empty.
    limits : (float, float)
        Values at the ends of the color bar; symmetric about zero for a signed field.
    signed : bool
        True where the sign matters: a diverging map centered at zero.
    range_note : str
        How the limits were chosen, in words; empty where they are the extremes.
    marks : tuple of float
        Values that the color bar marks by a line, such as the ends of what is possible.
    """

    name: str
    where: str
    values: Float[np.ndarray, " k"]
    label: str
    unit: str
    limits: tuple[float, float]
    signed: bool
    range_note: str = ""
    marks: tuple[float, ...] = ()

    @property
    def exceeds(self) -> tuple[bool, bool]:
        """Whether values lie below and above the color bar."""
        finite = self.values[np.isfinite(self.values)]
        if not len(finite):
            return False, False
        return bool(finite.min() < self.limits[0]), bool(finite.max() > self.limits[1])


def describe_field(
    name: str,
    where: str,
    values: np.ndarray,
    units: str = "unit",
    limits: tuple[float, float] | None = None,
    percent: float = ROBUST_PERCENT,
) -> Field:
    """Return a field with label, unit and a robust range.

    A signed field has the range [-r, r] with r the given percentile of the absolute values, so that zero
    is white and a few wild values do not wash out the rest; an unsigned one has the percentiles
    100 - percent and percent. With fewer than 20 values the extremes are used.

    Parameters
    ----------
    name, where : str
    values : (k,)
        NaN where there is no value.
    units : str
        The user's unit of length.
    limits : (float, float), optional
        A range to use instead, such as that of another map beside this one.
    percent : float
        In (50, 100].

    Raises
    ------
    ParameterError
        Where `percent` is out of range or `where` is unknown.

    Examples
    --------
    >>> field = describe_field("mean_curvature", "hole", np.array([-1.0, 0.5, 3.0]), "mm")
    >>> field.label, field.unit, field.limits
    ('mean curvature H', '1/mm', (-3.0, 3.0))
    """
    if where not in ("vertex", "tile", "hole"):
        raise ParameterError(f"where of field {name}: expected vertex, tile or hole, got {where!r}")
    if not 50 < percent <= 100:
        raise ParameterError(f"percent: expected more than 50 and at most 100, got {percent}")
    values = frozen(np.asarray(values, float).ravel())
    finite = values[np.isfinite(values)]
    label, signed = _KNOWN.get(name, (name.replace("_", " "), bool((finite < 0).any())))
    note = ""
    if limits is None:
        if len(finite) < 20:
            percent = 100.0
        limits = _robust_limits(finite, signed, percent)
        if percent < 100 and len(finite) and (finite.min() < limits[0] or finite.max() > limits[1]):
            note = f"range: {percent:g}th percentile" + (" of the absolute value" if signed else "")
    return Field(name, where, values, label, unit_of_field(name, units), limits, signed, note)


def name_unit(units: str, length: float | int) -> str:
    """Return the unit of length after a number: the word unit gets its plural, symbols stay."""
    return "units" if units == "unit" and length != 1 else units


def _robust_limits(finite: np.ndarray, signed: bool, percent: float) -> tuple[float, float]:
    if not len(finite):
        return (-1.0, 1.0) if signed else (0.0, 1.0)
    if signed:
        reach = float(np.percentile(np.abs(finite), percent)) or float(np.abs(finite).max()) or 1.0
        return -reach, reach
    low, high = (float(p) for p in np.percentile(finite, [100 - percent, percent]))
    if percent == 100 or low >= 0:
        low = 0.0 if 0 <= low < 0.5 * high else low
    if high - low <= 1e-12 * max(abs(high), abs(low)):
        low, high = (low - 0.5 * abs(low), high + 0.5 * abs(high)) if high else (0.0, 1.0)
    return low, high
