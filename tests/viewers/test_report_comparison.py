"""A comparison shows every run, marks the better one where there is one, and ranks nothing that does not compare."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from kirisurf.errors import ParameterError
from tests.viewers.report_page import Page
from viewers.parts import ReportParts
from viewers.report import report_html, write_report
from viewers.report_comparison import (
    HIGHER,
    LOWER,
    LOWER_ON_ONE_TARGET,
    best_of,
    compares,
    comparison_html,
    comparison_numbers,
    differing_options,
)


@pytest.fixture(autouse=True)
def quick_charts(monkeypatch):
    for name in ("residual_history", "curvature_scatter", "curvature_histogram"):
        monkeypatch.setattr(f"viewers.charts.{name}", lambda *_: "<svg/>")


@pytest.fixture
def parts(sheet, tmp_path) -> ReportParts:
    Image.new("RGB", (4, 3), "white").save(tmp_path / "deployed.png")
    return ReportParts(
        title="first",
        target_name="hypar",
        units="mm",
        result={"tiles": 36, "holes": 25, "iterations": 7, "edge_length": 0.2},
        certificate={"length": 1e-13, "coverage": 0.9, "distance_rms": 0.02, "loop": None},
        limits={"length": 1e-9},
        failures=(),
        fields=sheet.fields,
        numbers={"porosity": 0.25, "gaussian_curvature_difference_median": 0.5},
        pictures={"deployed": tmp_path / "deployed.png", "gaussian_curvature": tmp_path / "deployed.png"},
        spec={"tessellation": "quad", "cells": "4x4"},
        seconds={"total": 1.25},
    )


@pytest.mark.parametrize("count", [2, 3, 7, 12, 30])
def test_every_run_has_its_column_and_its_pictures(parts, count):
    runs = [replace(parts, title=f"run {k}") for k in range(count)]
    page = Page(comparison_html(runs))
    assert all(page.text.count(f"run {k}") >= 2 for k in range(count))
    images = [a for tag, a in page.tags if tag == "img"]
    assert len(images) == count * (2 + 2) and all(a["alt"] for a in images)
    assert [a["data-row"] for a in page.having("data-row")] == list(parts.certificate)
    letters = [run["letter"] for run in comparison_numbers(runs)["runs"]]
    assert len(set(letters)) == count


def test_seconds_are_shown_and_failing_rows_marked(parts):
    bad = replace(parts, title="bad", failures=("length: expected at most 1e-09, got 1: bad",), warnings=("Careful.",))
    page = Page(comparison_html([parts, bad]))
    seconds = [shown for shown in page.shown if shown.pointer.endswith("/seconds")]
    assert [float(shown.value) for shown in seconds] == [1.25, 1.25]
    cells = [a["class"] for tag, a in page.tags if tag == "td" and "fail" in a.get("class", "").split()]
    assert len(cells) == 1
    assert "1 of 2 certified" in page.text and "Careful." in page.text and "got 1: bad" in page.text


def test_what_cannot_be_built_is_not_the_best(parts):
    near = replace(parts, certificate={**parts.certificate, "distance_rms": 1e-6}, failures=("length: bad",))
    far = replace(parts, certificate={**parts.certificate, "distance_rms": 0.5})
    assert marked(comparison_html([near, parts, far])) == {"/runs/1/certificate/distance_rms/value"}
    assert marked(comparison_html([replace(near, failures=()), parts, far])) == {
        "/runs/0/certificate/distance_rms/value"
    }


def marked(html: str) -> set[str]:
    """Pointers of the numbers in cells that are marked as the best."""
    found = set()
    for cell in html.split("<td")[1:]:
        if "best" in cell.split(">")[0]:
            found |= {shown.pointer for shown in Page(f"<td{cell.split('</td>')[0]}</td>").shown}
    return found


@pytest.mark.parametrize(
    ("name", "values", "same", "best"),
    [
        ("distance_rms", [0.2, 0.1, 0.3], True, {1}),
        ("distance_rms", [0.1, 0.1, 0.3], False, {0, 1}),
        ("distance_rms", [0.1, 0.1000001, 0.3], True, {0, 1}),
        ("distance_rms", [0.1, 0.1], True, set()),
        ("distance_rms", [None, 0.1], True, set()),
        ("distance_rms", [float("nan"), 0.1, 0.2], True, {1}),
        ("coverage", [0.5, 0.75], False, {1}),
        ("length", [1e-13, 1e-12], True, set()),
        ("porosity", [0.1, 0.2], True, set()),
        ("gaussian_curvature_difference_median", [0.1, 0.2], True, {0}),
        ("gaussian_curvature_difference_median", [0.1, 0.2], False, set()),
    ],
)
def test_the_best_of_a_row(name, values, same, best):
    assert best_of(name, values, same) == best


def test_no_number_is_better_both_ways():
    assert not (LOWER & HIGHER or LOWER & LOWER_ON_ONE_TARGET or HIGHER & LOWER_ON_ONE_TARGET)


def test_different_targets_and_units_are_named_and_not_ranked(parts):
    assert compares([parts, parts])
    for other in (replace(parts, target_name="peaks"), replace(parts, units="m")):
        assert not compares([parts, other])
        better = replace(other, numbers={**parts.numbers, "gaussian_curvature_difference_median": 0.1})
        page = comparison_html([parts, better])
        assert "different targets or in different units" in Page(page).text
        assert not marked(page)
    assert "different targets" not in Page(comparison_html([parts, parts])).text


def test_options_that_differ_are_shown_and_the_others_not(parts):
    other = replace(parts, spec={"tessellation": "kagome", "cells": "4x4", "max_steps": 3})
    assert differing_options([parts, other]) == {"tessellation": ["quad", "kagome"], "max_steps": [None, 3]}
    text = Page(comparison_html([parts, other])).text
    assert "kagome" in text and "max steps" in text and "4x4" not in text
    assert "all runs have the same options" in Page(comparison_html([parts, parts])).text


def test_planar_runs_and_runs_without_pictures_stand_beside_others(parts):
    flat = {key: 1e-14 * values if "curvature" in key[1] else values for key, values in parts.fields.items()}
    planar = replace(parts, title="planar", fields=flat)
    dark = replace(parts, title="dark", pictures={}, no_pictures="No OpenGL here.")
    bare = ReportParts("bare", "none")
    page = Page(comparison_html([planar, dark, bare]))
    assert "No OpenGL here." in page.text and "bare" in page.text
    images = [a for tag, a in page.tags if tag == "img"]
    assert len(images) == 1 + 2


def test_flagged_holes_do_not_break_the_common_axes(parts):
    wild = np.array(parts.fields["hole", "gaussian_curvature"])
    wild[0] = np.nan
    fields = {**parts.fields, ("hole", "gaussian_curvature"): wild}
    Page(comparison_html([parts, replace(parts, fields=fields)]))


def test_names_are_escaped(parts):
    evil = "<img src=x onerror=alert(1)>&\"'"
    page = Page(comparison_html([parts, replace(parts, title=evil, target_name=evil, units=evil, spec={evil: evil})]))
    assert not [a for a in page.having("src") if a["src"] == "x"] and not page.having("onerror")
    assert evil in page.text


def test_files_are_written_by_their_suffix_and_need_a_run(parts, tmp_path):
    one = write_report([parts], tmp_path / "one.html").read_text(encoding="utf-8")
    assert one == report_html(parts)
    both = write_report([parts, parts], tmp_path / "both.html").read_text(encoding="utf-8")
    assert both == comparison_html([parts, parts]) and "http" not in both
    assert '"runs"' in write_report([parts, parts], tmp_path / "both.json").read_text(encoding="utf-8")
    with pytest.raises(ParameterError, match="at least one run"):
        write_report([], tmp_path / "none.html")


def test_openings_by_design_are_explained(parts):
    limits = {**parts.limits, "gap_contracted": 1e-9}
    hexagons = replace(parts, certificate={**parts.certificate, "gap_contracted": 0.3}, limits=limits)
    assert "by design" in Page(comparison_html([parts, hexagons])).text
    assert "by design" not in Page(comparison_html([parts, parts])).text
