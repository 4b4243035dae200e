"""Certificate rows in words."""

from __future__ import annotations

import pytest

from viewers.words import number, row_in_words


@pytest.mark.parametrize(
    "name, value, limit, verdict",
    [
        ("length", 1e-12, 1e-9, "pass"),
        ("length", 1e-8, 1e-9, "fail"),
        ("length", None, 1e-9, "unchecked"),
        ("length", float("nan"), 1e-9, "fail"),
        ("opening_min", -0.1, 0.0, "fail"),
        ("opening_min", 0.0, 0.0, "fail"),
        ("opening_min", 0.1, 0.0, "pass"),
        ("coverage", 0.8, 0.85, "fail"),
        ("coverage", 0.9, 0.85, "pass"),
        ("loop", None, None, "none"),
        ("reach_max", 3.0, None, "info"),
        ("a_new_row", 3.0, 4.0, "pass"),
    ],
)
def test_rows_without_a_judge_are_held_against_their_limits(name, value, limit, verdict):
    row = row_in_words(name, value, limit)
    assert row.verdict == verdict
    assert row.mark and row.verdict_word


def test_the_judge_has_the_last_word():
    failures = ("length: expected at most 1e-09, got 2e-9", "coverage: could not be checked: no disk")
    assert row_in_words("length", 1e-12, 1e-9, failures).verdict == "fail"
    assert row_in_words("coverage", None, 0.85, failures).verdict == "unchecked"
    assert row_in_words("coverage_strict", None, 0.85, failures).verdict == "none"
    assert row_in_words("gap_contracted", 0.3, 1e-9, failures).verdict == "pass"


def test_limits_say_which_way_they_go():
    assert row_in_words("length", 0.0, 1e-9).limit == "\u2264 1e-9"
    assert row_in_words("min_edge", 0.5, 0.1).limit == "\u2265 0.1"
    assert row_in_words("opening_min", 0.5, 0.0).limit == "> 0"


@pytest.mark.parametrize(
    "value, text",
    [(3, "3"), (3.0, "3"), (0.123456, "0.123"), (1.5e-12, "1.5e-12"), (2e-9, "2e-9"), (None, "\u2013"), ("mm", "mm"),
     (float("nan"), "\u2013"), (float("inf"), "inf"), (True, "True"), (1e300, "1e+300")],
)  # fmt: skip
def test_numbers(value, text):
    assert number(value) == text
