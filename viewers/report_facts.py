"""What a reader in a hurry wants: the numbers at the top of a report, and the holes that differ most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kirisurf.field_units import unit_label
from viewers.parts import ReportParts
from viewers.report_bins import decade

_RAISED = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")

LARGEST_ROWS = 8
_LARGEST = {
    "hole": "hole",
    "x": "x",
    "y": "y",
    "z": "z",
    "gaussian_curvature": "K",
    "target_gaussian_curvature": "K, target",
    "mean_curvature": "H",
    "target_mean_curvature": "H, target",
    "area": "area",
}


@dataclass(frozen=True)
class Fact:
    """A number that a reader in a hurry wants: its value as markup, its unit, and what it is."""

    value: Any
    unit: str
    words: str


def facts(parts: ReportParts, numbers: Mapping[str, Any], show: Any) -> list[Fact]:
    """Return the numbers for the top of the page.

    Parameters
    ----------
    parts : ReportParts
    numbers : mapping
        Of `report_numbers`.
    show : callable
        Of `shower`.
    """
    certificate, found_facts = parts.certificate, []
    if numbers.get("rigid") is not None:
        found_facts.append(Fact(show("rigid", form="short"), "", "largest rigid residual (lengths over L, radians)"))
    if certificate.get("distance_rms") is not None:
        value = show("certificate", "distance_rms", "value", form="short")
        found_facts.append(Fact(value, "L", "distance of the vertices to the target, root mean square"))
    if certificate.get("coverage") is not None:
        value = show("certificate", "coverage", "value", form="percent")
        found_facts.append(Fact(value, "", "of the target inside the sheet's outline"))
    for name, symbol in (("gaussian_curvature", "Gaussian"), ("mean_curvature", "mean")):
        found = (numbers.get("curvature") or {}).get(name)
        if found and found["target_share"] is not None:
            value = show("curvature", name, "target_share", form="percent")
            found_facts.append(Fact(value, "", f"of the holes' {symbol} curvature is the target's"))
        elif found and found["relative"] is not None:
            value = show("curvature", name, "relative", form="percent")
            found_facts.append(Fact(value, "", f"off the target's {symbol} curvature, in the median"))
    if "area_magnification" in numbers["measures"]:
        value = show("measures", "area_magnification", "shown")
        found_facts.append(Fact(value, "\u00d7", "area when opened, over that when flat"))
    return found_facts


def largest_differences(numbers: Mapping[str, Any], show: Any, units_of_length: str) -> dict[str, Any] | None:
    """Return `columns`, `rows` and `words` of the table of holes whose K is farthest from the target's; None without.

    Every column has one number of decimals, and one power of ten, which its heading names.
    """
    holes = numbers.get("holes") or []
    columns = [name for name in _LARGEST if holes and name in holes[0]]
    if "gaussian_curvature" not in columns or "target_gaussian_curvature" not in columns:
        return None
    apart = np.array(
        [
            np.nan if row.get("flag") else abs(row["gaussian_curvature"] - row["target_gaussian_curvature"])
            for row in holes
        ],
        float,
    )
    order = [int(k) for k in np.argsort(-np.nan_to_num(apart, nan=-1.0), kind="stable") if np.isfinite(apart[k])]
    shown = order[:LARGEST_ROWS]
    units = {"K": -2, "H": -1, "x": 1, "y": 1, "z": 1, "a": 2}
    forms, heads = {"hole": "number"}, ["hole"]
    for name in columns[1:]:
        # a column and the target's beside it are compared: they have one format
        pair = [each for each in columns if each.removeprefix("target_") == name.removeprefix("target_")]
        values = [holes[k][each] for k in shown for each in pair]
        power = decade(*values)
        forms[name] = f"{_decimals([value / 10.0**power for value in values])}@{power}"
        factor = f"10{str(power).translate(_RAISED)} " if power else ""
        heads.append(f"{_LARGEST[name]} ({factor}{unit_label(units[_LARGEST[name][0]], units_of_length)})")
    return {
        "columns": heads,
        "rows": [[show("holes", k, name, form=forms[name]) for name in columns] for k in shown],
        "words": "By the difference in K; x, y, z: center of the hole.",
    }


def _decimals(values: Sequence[float | int]) -> int:
    """Decimals that give the largest of a column three digits, so that the column has one format."""
    largest = max((abs(value) for value in values if value == value), default=0.0)
    return max(0, 2 - int(np.floor(np.log10(largest)))) if largest > 0 else 0
