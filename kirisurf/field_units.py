"""Units of the named fields, and what a file with fields says about itself: state, units and origin."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

UNKNOWN = "unit"
"""Stands for the unit of length where the target names none."""

FIELD, FIELD_UNIT, UNIT_OF_LENGTH, ORIGIN, STATE = "field", "field_unit", "unit_of_length", "origin", "state"

_CURVATURES = {"mean_curvature": -1, "gaussian_curvature": -2}
# the power of the unit of length, or the unit itself; everything that is not here is a ratio or a number
_POWERS: Mapping[str, int | str] = MappingProxyType(
    {
        "distance": 1,
        "closure_gap": 1,
        "center": 1,
        "principal_curvature_1": -1,
        "principal_curvature_2": -1,
        "area": 2,
        **{
            form.format(name): power
            for name, power in _CURVATURES.items()
            for form in ("{}", "{}_averaged", "target_{}", "{}_difference", "{}_from_patch", "{}_from_fit")
        },
        **dict.fromkeys(
            (
                "residual_ring",
                "opening_angle",
                "opening_angle_mean",
                "hinge_opening",
                "corner_angle_min",
                "corner_angle_max",
                "tile_angle_deviation",
                "angle_excess",
                "angle_defect",
                "gauss_image_area",
                "integrated_gaussian_curvature",
                "target_integrated_gaussian_curvature",
                "target_integrated_gaussian_curvature_cell",
            ),
            "rad",
        ),
    }
)
_SUPERSCRIPTS = {1: "", 2: "\u00b2", 3: "\u00b3"}


def unit_of_field(name: str, unit: str | None = None) -> str:
    """Return the unit of a field's values; empty for a ratio or a plain number.

    Parameters
    ----------
    name : str
        Such as gaussian_curvature.
    unit : str, optional
        Unit of length, such as mm.

    Examples
    --------
    >>> unit_of_field("gaussian_curvature", "mm"), unit_of_field("opening_angle"), unit_of_field("flag")
    ('1/mm\u00b2', 'rad', '')
    """
    return unit_label(_POWERS.get(name, 0), unit or UNKNOWN)


def unit_label(power: int | str, units: str) -> str:
    """Return a unit to a power as on a color bar; text as it is.

    Examples
    --------
    >>> unit_label(-1, "mm"), unit_label(1, "mm"), unit_label("rad", "mm")
    ('1/mm', 'mm', 'rad')
    """
    if isinstance(power, str):
        return power
    if power == 0:
        return ""
    text = units + _SUPERSCRIPTS.get(abs(power), f"^{abs(power)}")
    return text if power > 0 else f"1/{text}"


def described_file(
    state: str, fields: Iterable[str], unit: str | None = None, origin: ArrayLike = (0.0, 0.0, 0.0)
) -> dict[str, Sequence[str] | np.ndarray]:
    """Return the field data of a VTK file: what its points are, in which unit and frame, and the unit of every field.

    Parameters
    ----------
    state : str
        What the points are, such as deployed.
    fields : iterable of str
        Names of its fields.
    unit : str, optional
        Unit of length.
    origin : (3,)
        To be added to every point for the frame of the target.

    Returns
    -------
    dict
        `state`, `unit_of_length` (one text each), `origin` (1, 3), and the columns `field` and `field_unit` of a table.
    """
    names = sorted(fields)
    return {
        STATE: [state],
        UNIT_OF_LENGTH: [unit or UNKNOWN],
        ORIGIN: np.asarray(origin, dtype=float).reshape(1, 3),
        FIELD: names,
        FIELD_UNIT: [unit_of_field(name, unit) for name in names],
    }
