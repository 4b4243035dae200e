"""Measures of fits against a baseline: better, same, worse, new or missing, by stated tolerances."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

BETTER, SAME, WORSE, NEW, MISSING = "better", "same", "worse", "new", "missing"
VERDICTS = (WORSE, MISSING, NEW, BETTER, SAME)
"""What attention needs first."""


@dataclass(frozen=True)
class Tolerance:
    """What counts as no change of a measure.

    Attributes
    ----------
    relative : float
        Change over the value before.
    absolute : float
        Change, or size of both values, below which nothing is said: rounding is no regression.
    better : str
        'lower', 'higher', or 'equal' where any change is another sheet.
    """

    relative: float
    absolute: float
    better: str

    def as_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {"relative": self.relative, "absolute": self.absolute, "better": self.better}


_EXACT = Tolerance(0.0, 1e-10, "lower")
TOLERANCES: Mapping[str, Tolerance] = {
    # rigid rows are rounding, far below their limit of 1e-9: a tenth of that is none
    **dict.fromkeys(
        ("length", "angle", "planarity", "isometry", "closure", "loop", "boundary", "contracted_boundary"), _EXACT
    ),
    "gap_contracted": Tolerance(0.02, 1e-10, "lower"),
    "overlap_contracted": _EXACT,
    "intersections": Tolerance(0.0, 0.0, "lower"),
    "opening_min": Tolerance(0.02, 1e-6, "higher"),
    "min_edge": Tolerance(0.02, 1e-6, "higher"),
    "distance_rms": Tolerance(0.02, 1e-6, "lower"),
    "distance_max": Tolerance(0.02, 1e-6, "lower"),
    "reach_rms": Tolerance(0.02, 1e-6, "lower"),
    "reach_max": Tolerance(0.02, 1e-6, "lower"),
    "coverage": Tolerance(0.005, 1e-9, "higher"),
    "coverage_strict": Tolerance(0.005, 1e-9, "higher"),
    "gaussian_curvature_difference_relative": Tolerance(0.05, 1e-4, "lower"),
    "mean_curvature_difference_relative": Tolerance(0.05, 1e-4, "lower"),
    "iterations": Tolerance(0.2, 2.0, "lower"),
    "tiles": Tolerance(0.0, 0.0, "equal"),
    "holes": Tolerance(0.0, 0.0, "equal"),
}
"""The usual tolerances, wide enough for another processor and for libraries of another version."""


@dataclass(frozen=True)
class Change:
    """One measure that is not what it was.

    Attributes
    ----------
    measure : str
    before, now : float, str or None
    verdict : str
        'better' or 'worse'.
    sentence : str
    """

    measure: str
    before: Any
    now: Any
    verdict: str
    sentence: str


@dataclass(frozen=True)
class Compared:
    """One item against the baseline.

    Attributes
    ----------
    name : str
    verdict : str
        One of `VERDICTS`; worse as soon as one measure is worse.
    changes : tuple of Change
    """

    name: str
    verdict: str
    changes: tuple[Change, ...] = ()


def tolerances(own: Mapping[str, float]) -> dict[str, Tolerance]:
    """Return the usual tolerances with some relative ones replaced.

    Raises
    ------
    ValueError
        Where a name is not that of a measure that is compared.
    """
    found = dict(TOLERANCES)
    for name, relative in own.items():
        if name not in found:
            raise ValueError(f"tolerances: expected measures among {', '.join(TOLERANCES)}, got {name!r}")
        found[name] = Tolerance(float(relative), found[name].absolute, found[name].better)
    return found


def compared(
    before: Mapping[str, Mapping[str, Any]],
    now: Mapping[str, Mapping[str, Any]],
    allowed: Mapping[str, Tolerance],
) -> tuple[Compared, ...]:
    """Compare items by name.

    Parameters
    ----------
    before, now : mapping of str to mapping
        Of every item its `code`, `certified`, and measures; a measure that one of both has not is not compared,
        unless it was there and is gone.
    allowed : mapping of str to Tolerance

    Returns
    -------
    tuple of Compared
        In the order of `now`, then what is missing.
    """
    found = [
        _compared_item(name, before[name], values, allowed) if name in before else Compared(name, NEW)
        for name, values in now.items()
    ]
    return (*found, *(Compared(name, MISSING) for name in before if name not in now))


def counts(found: Sequence[Compared]) -> dict[str, int]:
    """Return how many items have each verdict."""
    return {verdict: sum(each.verdict == verdict for each in found) for verdict in VERDICTS}


def _compared_item(
    name: str, before: Mapping[str, Any], now: Mapping[str, Any], allowed: Mapping[str, Tolerance]
) -> Compared:
    changes = _changed_ends(before, now)
    # the numbers of a sheet that is not certified are no measure of one that is
    if not any(change.measure == "certified" or change.verdict == WORSE for change in changes):
        changes += [
            change
            for measure, tolerance in allowed.items()
            if (change := _changed(measure, before.get(measure), now.get(measure), tolerance)) is not None
        ]
    verdicts = {change.verdict for change in changes}
    return Compared(name, WORSE if WORSE in verdicts else BETTER if BETTER in verdicts else SAME, tuple(changes))


def _changed_ends(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[Change]:
    """How the item ended, as a change: certified or not first, then the exit code."""
    was, is_now = before.get("certified"), now.get("certified")
    if bool(was) != bool(is_now):
        words = {True: "certified", False: "not certified"}
        verdict = BETTER if is_now else WORSE
        codes = f"exit code {before.get('code')} -> {now.get('code')}"
        said = f"{words[bool(was)]} before, {words[bool(is_now)]} now ({codes})"
        return [Change("certified", bool(was), bool(is_now), verdict, said)]
    if before.get("code") != now.get("code"):
        old, new = before.get("code"), now.get("code")
        # a warning less is better; a failure of another class is a change that somebody has to look at
        better = bool(is_now) and isinstance(old, int) and isinstance(new, int) and new < old
        return [Change("code", old, new, BETTER if better else WORSE, f"exit code {old} -> {new}")]
    return []


def _changed(measure: str, before: Any, now: Any, tolerance: Tolerance) -> Change | None:
    if not _is_number(before):
        return None
    if not _is_number(now):
        return Change(measure, before, None, WORSE, f"{measure} {before:.6g} -> none")
    if abs(now - before) <= tolerance.absolute or max(abs(now), abs(before)) <= tolerance.absolute:
        return None
    relative = abs(now - before) / abs(before) if before else math.inf
    if relative <= tolerance.relative:
        return None
    lower = now < before
    verdict = WORSE if tolerance.better == "equal" or lower != (tolerance.better == "lower") else BETTER
    share = f"{100 * (now - before) / abs(before):+.3g} %" if before else "from zero"
    allowed = f"{100 * tolerance.relative:g} %" if tolerance.relative else f"{tolerance.absolute:g}"
    return Change(measure, before, now, verdict, f"{measure} {before:.6g} -> {now:.6g} ({share}, allowed {allowed})")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
