"""Comparison with a baseline: what is better, same, worse, new, missing."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.regression import BETTER, MISSING, NEW, SAME, TOLERANCES, VERDICTS, WORSE, compared, counts, tolerances

USUAL = tolerances({})
GOOD = {"code": 0, "certified": True, "tiles": 64, "holes": 49, "iterations": 8, "distance_rms": 0.01, "coverage": 0.9}
positive = st.floats(1e-3, 1e3)


def verdict(before: dict, now: dict) -> str:
    return compared({"a": before}, {"a": now}, USUAL)[0].verdict


@given(positive, st.sampled_from(sorted(TOLERANCES)))
def test_what_did_not_change_is_the_same(value: float, measure: str) -> None:
    assert verdict({**GOOD, measure: value}, {**GOOD, measure: value}) == SAME


@given(positive, st.sampled_from(sorted(name for name, each in TOLERANCES.items() if each.better != "equal")))
def test_the_way_there_is_the_opposite_of_the_way_back(value: float, measure: str) -> None:
    """Of two values that differ by far more than the tolerance, one is better than the other, and never both."""
    low, high = {**GOOD, measure: value}, {**GOOD, measure: 5 * value + 10}
    there, back = verdict(low, high), verdict(high, low)
    assert {there, back} == {BETTER, WORSE}
    assert (there == WORSE) == (TOLERANCES[measure].better == "lower")


@pytest.mark.parametrize("measure", sorted(TOLERANCES))
def test_the_tolerance_is_where_it_is_said_to_be(measure: str) -> None:
    tolerance = TOLERANCES[measure]
    before = 100.0
    room = max(tolerance.relative * before, tolerance.absolute)
    for sign in (-1, 1):
        assert verdict({**GOOD, measure: before}, {**GOOD, measure: before + sign * 0.99 * room}) == SAME
        assert verdict({**GOOD, measure: before}, {**GOOD, measure: before + sign * (1.01 * room + 1e-9)}) != SAME


def test_rounding_is_no_regression() -> None:
    """Rigid rows are rounding: ten times as much of it is still none, a tenth of the limit is something."""
    assert verdict({**GOOD, "length": 1e-15}, {**GOOD, "length": 5e-14}) == SAME
    assert verdict({**GOOD, "length": 1e-15}, {**GOOD, "length": 5e-10}) == WORSE


@pytest.mark.parametrize("measure", ["tiles", "holes"])
@pytest.mark.parametrize("step", [-1, 1])
def test_another_number_of_tiles_is_another_sheet(measure: str, step: int) -> None:
    assert verdict(GOOD, {**GOOD, measure: GOOD[measure] + step}) == WORSE


def test_how_it_ended_goes_before_how_near_it_is() -> None:
    failed = {**GOOD, "code": 5, "certified": False, "distance_rms": 1e-9}
    (found,) = compared({"a": GOOD}, {"a": failed}, USUAL)
    assert found.verdict == WORSE and [change.measure for change in found.changes] == ["certified"]
    assert verdict(failed, GOOD) == BETTER
    assert verdict({"code": 3}, {"code": 4}) == WORSE
    assert verdict({"code": 3}, {"code": 3}) == SAME
    assert verdict({**GOOD, "code": 1}, GOOD) == BETTER


def test_a_measure_that_is_gone_is_worse_and_one_that_came_is_not_compared() -> None:
    less = {name: value for name, value in GOOD.items() if name != "coverage"}
    assert verdict(GOOD, less) == WORSE
    assert verdict(GOOD, {**GOOD, "coverage": None}) == WORSE
    assert verdict(GOOD, {**GOOD, "coverage": math.nan}) == WORSE
    assert verdict(less, GOOD) == SAME


def test_one_worse_measure_outweighs_many_better_ones() -> None:
    now = {**GOOD, "distance_rms": 0.001, "coverage": 0.5}
    (found,) = compared({"a": GOOD}, {"a": now}, USUAL)
    assert found.verdict == WORSE
    assert {change.measure: change.verdict for change in found.changes} == {"distance_rms": BETTER, "coverage": WORSE}
    worse = next(change.sentence for change in found.changes if change.verdict == WORSE)
    assert worse == "coverage 0.9 -> 0.5 (-44.4 %, allowed 0.5 %)"


def test_new_and_missing_items_are_said() -> None:
    found = compared({"a": GOOD, "b": GOOD}, {"c": GOOD, "a": GOOD}, USUAL)
    assert [(each.name, each.verdict) for each in found] == [("c", NEW), ("a", SAME), ("b", MISSING)]
    assert counts(found) == {**dict.fromkeys(VERDICTS, 0), NEW: 1, SAME: 1, MISSING: 1}


def test_a_tolerance_of_ones_own_counts() -> None:
    own = tolerances({"distance_rms": 0.5})
    assert compared({"a": GOOD}, {"a": {**GOOD, "distance_rms": 0.014}}, own)[0].verdict == SAME
    assert compared({"a": GOOD}, {"a": {**GOOD, "distance_rms": 0.016}}, own)[0].verdict == WORSE
    with pytest.raises(ValueError, match=r"expected measures among .*, got 'distanc'"):
        tolerances({"distanc": 0.5})
