"""Charts are valid SVG that holds the given numbers."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from viewers.charts import curvature_histogram, curvature_scatter, residual_history


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
