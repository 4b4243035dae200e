"""Certificate rows in words."""

from __future__ import annotations

import re

import numpy as np
import pytest

from analysis.limits import LIMITS
from analysis.measures import measure
from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface
from viewers.number_words import measures_by_heading, number_in_words
from viewers.words import CAPTIONS, OPEN_CAPTIONS, PLANAR_CAPTIONS, number, row_in_words


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
        ("boundary", None, 1e-9, "none"),
        ("contracted_boundary", None, 1e-9, "none"),
        ("boundary", 1e-8, 1e-9, "fail"),
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
     (float("nan"), "\u2013"), (float("inf"), "inf"), (True, "True"), (1e300, "1e+300"),
     (1079.6, "1080"), (-99999.4, "-99999"), (123456.5, "1.23e5"), (999.96, "1000")],
)  # fmt: skip
def test_numbers(value, text):
    assert number(value) == text


@pytest.mark.parametrize("name", LIMITS)
def test_every_row_has_words(name):
    row = row_in_words(name, 0.5, 1.0)
    assert row.title != name.replace("_", " ") and row.meaning and row.unit


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("edge_length", 2.0, "2 mm"),
        ("tile_area", 2.5, "2.5 mm\u00b2"),
        ("gaussian_curvature_difference_median", 0.1, "0.1 1/mm\u00b2"),
        ("opening_angle_max", 1.5707963267948966, "90 \u00b0"),
        ("porosity", 0.5, "50 %"),
        ("area_magnification", 2.0, "2"),
        ("distance_rms", 0.02, "0.02 of a tile edge"),
        ("porosity", None, "\u2013 %"),
        ("porosity", float("nan"), "\u2013 %"),
        ("a_new_measure", 3, "3"),
    ],
)
def test_measures_have_values_in_their_units(name, value, text):
    row = number_in_words(name, value, "mm")
    assert f"{row.value} {row.unit}".strip() == text
    assert row.label and "_" not in row.label


def test_measures_are_ordered_by_heading_and_unknown_ones_come_last():
    found = measures_by_heading({"mine": 1.0, "distance_max": 0.1, "porosity": 0.5, "edge_length": 1.0})
    assert list(found) == ["Tiles", "Opening", "Distance to the target", "Other measures"]
    assert [row.name for rows in found.values() for row in rows] == ["edge_length", "porosity", "distance_max", "mine"]


def test_every_measure_has_words():
    pattern = quad_pattern(3, 3)
    points = np.c_[pattern.deployed, 0.05 * pattern.deployed[:, 0] ** 2]
    corners = np.array([[-1.0, -1, 0], [6, -1, 0], [6, 6, 0], [-1, 6, 0]])
    target = Surface.from_arrays(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    flat = measure(pattern, points * [1, 1, 0], pattern.contracted, target, target_outline=corners[:, :2])
    bent = measure(pattern, points, pattern.contracted, target)
    assert "Other measures" not in measures_by_heading({**bent.numbers, **flat.numbers})


@pytest.mark.parametrize("name", LIMITS)
def test_limits_and_relations_agree_and_units_are_short(name):
    row = row_in_words(name, 0.5, 1.0)
    assert row.limit == f"{row.relation} 1"
    assert row.short_unit == {"of a tile edge": "L", "rad": "rad"}.get(row.unit, "")


def test_a_measure_keeps_its_value_in_the_unit_shown():
    assert number_in_words("opening_angle_max", np.pi / 2, "mm").number == pytest.approx(90)
    assert number_in_words("porosity", 0.5, "mm").number == 50
    assert number_in_words("rim_turning", 6.5, "mm").unit == "rad"
    assert number_in_words("porosity", None, "mm").number is None


def test_captions_name_no_number_that_the_page_would_have_to_know():
    for caption in (*CAPTIONS.values(), *PLANAR_CAPTIONS.values(), *OPEN_CAPTIONS.values()):
        assert not re.search(r"\d", caption.replace("2\u03c0", "")) and caption.endswith(".")
