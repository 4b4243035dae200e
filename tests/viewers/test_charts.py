"""Charts are valid SVG that holds the given numbers."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from itertools import pairwise

import numpy as np
import pytest

from viewers.charts import curvature_histogram, curvature_scatter, residual_history, with_unit
from viewers.report_bins import curvature_bins, decade, robust_span
from viewers.report_charts import balance_chart, residence_chart


def test_history_is_the_same_every_time_and_takes_zeros_and_gaps():
    history = [{"length": 1e-2, "angle": 1e-1}, {"length": 1e-6}, {"length": 0.0, "angle": 1e-12}]
    svg = residual_history(history)
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert svg == residual_history(history)


def test_an_empty_history_is_still_a_picture():
    ElementTree.fromstring(residual_history([{}]))


@pytest.mark.parametrize("draw", [curvature_scatter, curvature_histogram])
@pytest.mark.parametrize("count", [0, 1, 5, 300])
def test_curvature_charts_take_any_number_of_holes(draw, count):
    rng = np.random.default_rng(1)
    holes = rng.normal(size=count)
    if count > 2:
        holes[1] = np.nan
        holes[2] = 1e12
    svg = draw(holes, rng.normal(size=count), "Gaussian curvature", "1/mm\u00b2")
    assert ElementTree.fromstring(svg).tag.endswith("svg")


def test_every_hole_is_a_dot():
    holes = np.linspace(-1, 1, 11)
    root = ElementTree.fromstring(curvature_scatter(holes, 0.9 * holes))
    dots = [g for g in root.iter() if g.get("id", "").startswith("PathCollection_1")]
    assert len(dots[0].findall(".//{*}use")) == 11


def test_bins_hold_every_hole_and_count_what_lies_beyond():
    rng = np.random.default_rng(2)
    holes, target = rng.normal(size=200), rng.normal(size=200)
    holes[:3], target[5] = np.nan, np.nan
    holes[10], holes[11], target[12] = 50.0, -50.0, -50.0
    bins = curvature_bins(holes, target, (-4.0, 4.0))
    assert bins.holes.sum() == bins.target.sum() == 196
    assert (bins.below, bins.above) == (2, 1)
    assert bins.edges[0] == -4.0 and bins.edges[-1] == 4.0
    inside = holes[np.isfinite(holes) & np.isfinite(target) & (np.abs(holes) < 4.0)]
    brute = [int(((inside >= a) & (inside < b)).sum()) for a, b in pairwise(bins.edges)]
    assert bins.holes[1:-1].tolist() == brute[1:-1]


@pytest.mark.parametrize("values", [[], [np.nan], [2.0], [0.0, 0.0], [-1.0, 3.0], list(range(100))])
def test_a_span_is_never_empty_and_shows_the_middle(values):
    low, high = robust_span(np.array(values, float))
    assert low < high
    known = np.array([value for value in values if value == value])
    if len(known):
        assert low < np.median(known) < high


def test_spans_of_several_runs_hold_those_of_each():
    a, b = np.linspace(0, 1, 30), np.linspace(-5, 0.5, 30)
    low, high = robust_span(a, b)
    assert low < -4 and high > 0.9


def test_zero_residuals_leave_gaps_and_no_line():
    root = ElementTree.fromstring(residual_history([{"opening": 1e-2}, {"opening": 0.0}, {"opening": 1e-4}]))
    lines = [path.get("d") for path in root.iter("{http://www.w3.org/2000/svg}path") if path.get("d")]
    assert lines and not any("nan" in line.lower() for line in lines)


@pytest.mark.parametrize("count", [0, 1, 5, 2000])
def test_the_chart_of_the_balance_takes_any_number_of_cells(count):
    rng = np.random.default_rng(3)
    defects = rng.normal(size=count) * 1e-3
    if count > 2:
        defects[1] = np.nan
    assert ElementTree.fromstring(balance_chart(defects, rng.normal(size=count) * 1e-3)).tag.endswith("svg")


@pytest.mark.parametrize("tiles", [0.0, 1e-13, 0.5, 1.0])
def test_the_bars_of_residence_take_any_share(tiles):
    shares = {key: {"tiles": tiles, "holes": 1.0 - tiles} for key in ("area", "target", "sheet")}
    root = ElementTree.fromstring(residence_chart(shares))
    assert root.tag.endswith("svg")


@pytest.mark.parametrize("scale", [1e-9, 1e-7, 1e-3, 1.0, 300.0, 1e6])
def test_axes_read_the_same_at_any_scale(scale):
    power = decade(-0.5 * scale, 3.0 * scale)
    assert 1e-2 <= 3.0 * scale / 10.0**power < 1e4 and (power == 0) == (1e-2 <= 3.0 * scale < 1e4)
    holes = scale * np.linspace(-0.5, 3.0, 9)
    for draw in (curvature_scatter, curvature_histogram):
        ElementTree.fromstring(draw(holes, holes, "K", "$a_{"))


def test_labels_of_axes_name_power_and_unit():
    assert with_unit("K", "") == "K" and with_unit("K", "1/mm") == "K  (1/mm)"
    assert with_unit("K", "1/mm", -7) == "K  ($10^{-7}$\u00a01/mm)" and with_unit("K", "", 5) == "K  ($10^{5}$)"
