"""The numbers of a picked tile or hole, and of the whole fit, in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from viewers.fields import describe_field
from viewers.number_words import number_in_words
from viewers.sheet import Sheet
from viewers.words import CertificateRow, number, row_in_words
from viewers.workbench.events import Certified
from viewers.workbench.state import Selection

_FIRST = {
    "edge_length": "median tile edge",
    "edge_length_spread": "spread of the edges",
    "opening_angle_min": "smallest opening",
    "opening_angle_mean": "mean opening",
    "porosity": "porosity",
    "linear_magnification": "size open / closed",
    "distance_rms": "distance to the target, rms",
    "distance_max": "largest distance",
    "gaussian_curvature_difference_median": "K of holes - K of target, median",
    "mean_curvature_difference_median": "H of holes - H of target, median",
}


@dataclass(frozen=True)
class Line:
    """One number for a reader: what it is, its value and its unit."""

    label: str
    value: str
    unit: str = ""


def picked_lines(sheet: Sheet, selection: Selection | None) -> tuple[Line, ...]:
    """Return every field's value at what is picked; vertex fields as the largest absolute value at its corners.

    Angles are given in degrees; curvature that was integrated stays in radians, as on the color bar.
    """
    loops = None if selection is None else sheet.tiles if selection.kind == "tile" else sheet.holes
    if selection is None or loops is None or selection.number >= len(loops):
        return ()
    loop = loops[selection.number]
    lines = [Line("corners", str(len(loop)))]
    for (where, name), values in sheet.fields.items():
        if where == selection.kind and not (sheet.is_planar and "curvature" in name):
            lines.append(_line(sheet, where, name, float(values[selection.number])))
    for (where, name), values in sheet.fields.items():
        if where == "vertex":
            at = values[loop]
            finite = at[np.isfinite(at)]
            worst = float(finite[np.argmax(np.abs(finite))]) if len(finite) else float("nan")
            line = _line(sheet, where, name, worst)
            lines.append(Line(f"{line.label}, at a corner", line.value, line.unit))
    return tuple(lines)


def certificate_lines(certified: Certified | None) -> tuple[CertificateRow, ...]:
    """Return every row of a certificate that applies, in words."""
    if certified is None:
        return ()
    rows = (
        row_in_words(name, value, certified.limits.get(name), certified.failures)
        for name, value in certified.rows.items()
        if value is not None
    )
    return tuple(rows)


def measure_lines(numbers: Mapping[str, float], units: str | None = None) -> tuple[Line, ...]:
    """Return the measures of a whole fit that a reader asks for first.

    Examples
    --------
    >>> measure_lines({"porosity": 0.25})
    (Line(label='porosity', value='25', unit='%'),)
    """
    rows = {name: number_in_words(name, numbers[name], units or "unit") for name in _FIRST if name in numbers}
    return tuple(
        Line(_FIRST[name], row.value, row.unit.replace("of a tile edge", "edge")) for name, row in rows.items()
    )


def _line(sheet: Sheet, where: str, name: str, value: float) -> Line:
    # only label and unit are wanted: no range is looked for
    field = describe_field(name, where, np.array([value]), sheet.units, (0.0, 1.0))
    if name == "flag":
        return Line("patch", "not determined by the vertices" if value else "trustworthy")
    if field.unit == "rad" and "angle" in name and name not in ("angle_defect", "angle_excess"):
        return Line(field.label, number(round(float(np.degrees(value)), 6)), "\N{DEGREE SIGN}")
    return Line(field.label, number(None if np.isnan(value) else value), field.unit)
