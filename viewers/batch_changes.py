"""Changes of a batch against its baseline: before and now of every measure, in words, with a bar for the eye."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeGuard

from viewers.batch_rows import CODES
from viewers.number_words import number_in_words
from viewers.report_page import formatted
from viewers.words import row_in_words

# certificate rows and facts of a run as the table heads them: name, unit
_WORDS = {
    "distance_rms": ("rms distance", "L"),
    "distance_max": ("largest distance", "L"),
    "reach_rms": ("rms reach", "L"),
    "reach_max": ("farthest reach", "L"),
    "coverage": ("coverage", ""),
    "coverage_strict": ("strict coverage", ""),
    "opening_min": ("smallest opening", "rad"),
    "min_edge": ("smallest edge", "L"),
    "gaussian_curvature_difference_relative": ("K of the holes off the target's, over its median", ""),
    "mean_curvature_difference_relative": ("H of the holes off the target's, over its median", ""),
    "angle_defect_difference_relative": ("angle defects off the target's K, over its median", ""),
    "gauss_image_area_difference_relative": ("K of the cells off the target's, over its median", ""),
    "tiles": ("tiles", ""),
    "holes": ("holes", ""),
    "iterations": ("steps", ""),
    "seconds": ("time", "s"),
    "peak_mb": ("peak memory", "MB"),
    "outcome": ("outcome", ""),
    "code": ("how it ended", ""),
    "status": ("status", ""),
    "certified": ("certified", ""),
}
_RAW_UNITS = {"\N{DEGREE SIGN}": "rad", "%": "", "of a tile edge": "L"}
# a factor says more than percent from here on
_FACTOR = 3.0


@dataclass(frozen=True)
class ShownChange:
    """One measure of an item, before and now.

    Attributes
    ----------
    index : int
        Its place among the changes of the item.
    measure, label, unit : str
    verdict : str
        better, same or worse.
    change : str
        How much, relative to before; empty where that says nothing.
    allowed : str
    bars : (float, float) or None
        Lengths of before and now in percent of the longer; None where they are no numbers from zero on.
    sentence : str
        What stands for all of it where it is no number that changed, but how the item ended.
    """

    index: int
    measure: str
    label: str
    unit: str
    verdict: str
    change: str
    allowed: str
    bars: tuple[float, float] | None
    sentence: str


@dataclass(frozen=True)
class Tolerance:
    """What counts as the same, of one measure, and how often it was not.

    Attributes
    ----------
    measure, label, unit, direction : str
    n_worse, n_better : int
    """

    measure: str
    label: str
    unit: str
    direction: str
    n_worse: int
    n_better: int


def measure_words(name: str) -> tuple[str, str]:
    """Return what a measure is called and its unit, of the value as result.json has it.

    Examples
    --------
    >>> measure_words("distance_rms"), measure_words("length"), measure_words("opening_angle_min")
    (('rms distance', 'L'), ('slit edges match', 'L'), ('smallest opening angle', 'rad'))
    """
    if name in _WORDS:
        return _WORDS[name]
    row = row_in_words(name, None, None, ())
    if row.meaning:
        return row.title[:1].lower() + row.title[1:], row.short_unit
    found = number_in_words(name, None)
    return found.label, _RAW_UNITS.get(found.unit, found.unit)


def shown_changes(entry: Mapping[str, Any], tolerances: Mapping[str, Any]) -> list[ShownChange]:
    """Return the changes of one item that are not the same, worse ones first."""
    shown = [
        _shown(k, change, tolerances.get(str(change.get("measure"))) or {})
        for k, change in enumerate(entry.get("changes") or ())
        if change.get("verdict") != "same"
    ]
    return sorted(shown, key=lambda each: each.verdict != "worse")


def tolerance_rows(comparison: Mapping[str, Any]) -> list[Tolerance]:
    """Return what counts as the same for every measure, in the order of the summary."""
    entries: Sequence[Mapping[str, Any]] = comparison.get("items") or ()
    verdicts = [
        (change.get("measure"), change.get("verdict")) for each in entries for change in each.get("changes") or ()
    ]
    return [
        Tolerance(
            name,
            *measure_words(name),
            {"lower": "lower", "higher": "higher"}.get(str(told.get("better")), "neither: any change is worse"),
            verdicts.count((name, "worse")),
            verdicts.count((name, "better")),
        )
        for name, told in (comparison.get("tolerances") or {}).items()
    ]


def allowed_words(told: Mapping[str, Any], unit: str = "") -> str:
    """Return how far a measure may go, in words: a part of the baseline, or a change in the measure's unit.

    Examples
    --------
    >>> allowed_words({"relative": 0.02, "absolute": 1e-6}, "L"), allowed_words({})
    ('2\N{NO-BREAK SPACE}% or 10^\N{MINUS SIGN}6$\N{NO-BREAK SPACE}L', '')
    """
    parts = [formatted(told["relative"], "percent")] if _is_number(told.get("relative")) and told["relative"] else []
    beside = f"\N{NO-BREAK SPACE}{unit}" if unit else ""
    parts += [formatted(told["absolute"]) + beside] if _is_number(told.get("absolute")) and told["absolute"] else []
    return " or ".join(parts) or ("none" if told else "")


def change_words(before: object, now: object) -> str:
    """Return how much a number changed, in percent or as a factor.

    Examples
    --------
    >>> change_words(0.0084, 0.0126), change_words(0.5, 0.1), change_words(0.0, 1.0)
    ('+50\N{NO-BREAK SPACE}%', '\N{MINUS SIGN}80\N{NO-BREAK SPACE}%', '')
    >>> change_words(1e-14, 1e-9), change_words(0.1, 0.4)
    ('\N{MULTIPLICATION SIGN}\N{NO-BREAK SPACE}10^5$', '\N{MULTIPLICATION SIGN}\N{NO-BREAK SPACE}4')
    """
    if not _is_number(before) or not _is_number(now) or not before:
        return ""
    ratio = now / before
    if ratio >= _FACTOR:
        return f"\N{MULTIPLICATION SIGN}\N{NO-BREAK SPACE}{_factor(ratio)}"
    # against the size of before, so that a number below zero that grows has a plus
    change = (now - before) / abs(before)
    return ("+" if change > 0 else "") + formatted(change, "percent")


def _shown(index: int, change: Mapping[str, Any], told: Mapping[str, Any]) -> ShownChange:
    name = str(change.get("measure") or "")
    label, unit = measure_words(name)
    before, now = change.get("before"), change.get("now")
    is_end = bool(_end_words(name, before, now))
    return ShownChange(
        index,
        name,
        label,
        unit,
        str(change.get("verdict") or ""),
        "" if is_end else change_words(before, now),
        allowed_words(told, unit),
        None if is_end else _bars(before, now),
        _end_words(name, before, now) or ("" if _is_number(before) or _is_number(now) else str(change.get("sentence"))),
    )


def _end_words(measure: str, before: object, now: object) -> str:
    """Return how the item ended before and now; empty of a measure."""
    if measure == "certified" and isinstance(now, bool):
        return "no longer certified" if not now else "certified now, and was not before"
    if measure == "code":
        was, is_now = (CODES.get(code, f"exit code {code}") for code in (before, now))
        return f"{was} before, {is_now} now"
    return ""


def _factor(ratio: float) -> str:
    if ratio < 1000:
        return formatted(float(f"{ratio:.2g}"))
    mantissa, _, power = f"{ratio:.1e}".partition("e")
    return ("" if mantissa == "1.0" else f"{float(mantissa):g}\N{MIDDLE DOT}") + f"10^{int(power)}$"


def _bars(before: object, now: object) -> tuple[float, float] | None:
    if not _is_number(before) or not _is_number(now) or min(before, now) < 0 or not max(before, now):
        return None
    longest = max(before, now)
    return round(100 * before / longest, 1), round(100 * now / longest, 1)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
