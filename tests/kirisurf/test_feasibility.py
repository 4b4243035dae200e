"""Feasibility: what a target asks, what a tessellation gives, and what is advised."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.feasibility import MET, Range, feasibility, ranges, wide_enough
from kirisurf.flattening import flatten
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from tests.kirisurf.test_layout import square

BY_NAME = {found.name: found for found in ranges()}


@pytest.mark.parametrize("name", list(BY_NAME))
def test_a_flat_target_asks_for_nothing(name: str) -> None:
    surface = square()
    found = feasibility(surface, np.zeros(len(surface.vertices)), BY_NAME[name])
    low, high = BY_NAME[name].ends
    assert found.is_met and found.outside == 0 and found.advice == ""
    assert found.spread == pytest.approx(1)
    np.testing.assert_allclose(found.asked, np.sqrt(low * high), rtol=1e-12)


def test_the_size_of_the_sheet_does_not_matter() -> None:
    surface = sample_surfaces.load("dome", resolution=20)
    scale = flatten(surface).log_scale
    first, second = (feasibility(surface, scale + by, BY_NAME["quad"]) for by in (0.0, 3.0))
    np.testing.assert_allclose(first.asked, second.asked, rtol=1e-12)
    assert (first.outside, first.spread) == pytest.approx((second.outside, second.spread))


@pytest.mark.parametrize("ratio", [1.2, 1.6, 3.0])
@pytest.mark.parametrize("name", ["quad", "kagome", "hexagon"])
def test_the_part_outside_is_known_for_a_scale_that_grows_evenly(name: str, ratio: float) -> None:
    """The logarithm grows evenly from 0 to log ratio across a square: the best window covers its own share."""
    surface = square(60)
    scale = 0.5 * surface.vertices[:, 0] * np.log(ratio)
    found = feasibility(surface, scale, BY_NAME[name])
    covered = min(1.0, np.log(BY_NAME[name].most) / np.log(ratio))
    assert found.outside == pytest.approx(1 - covered, abs=0.04)
    assert found.is_met == (covered >= 1 - MET)
    assert found.spread == pytest.approx(ratio**0.96, rel=0.02)
    if covered == 1:
        assert found.asked.min() * found.asked.max() == pytest.approx(BY_NAME[name].most, rel=1e-9)


def test_no_other_size_covers_more() -> None:
    surface = sample_surfaces.load("peaks", resolution=30)
    scale = flatten(surface).log_scale
    found = feasibility(surface, scale, BY_NAME["quad"])
    area = np.bincount(surface.faces.ravel(), np.repeat(surface.face_areas, 3)) / 3
    low, high = BY_NAME["quad"].ends
    for factor in np.geomspace(0.3, 3, 200):
        asked = factor * np.exp(scale)
        outside = area[(asked < low) | (asked > high)].sum() / area.sum()
        assert outside >= found.outside - 1e-9


def test_what_would_do_is_named_the_narrowest_first() -> None:
    assert wide_enough(1.3, "quad")[0].name == "trihexagonal"
    assert [other.name for other in wide_enough(1.5, "kagome")] == ["right-triangles"]
    assert wide_enough(5.0, "quad") == ()
    for other in wide_enough(1.01, "quad"):
        assert not other.snaps and other.is_even and other.name != "quad"
    assert not BY_NAME["rotating-rectangles"].is_even
    assert str(BY_NAME["rotating-rectangles"]) == "rotating-rectangles (1 to 2 one way and 1.1 the other)"
    assert str(Range("mine", 1.5, 1.5, 1.5, True)) == "mine (1 or 1.5)"


def test_a_start_carries_its_feasibility() -> None:
    surface = sample_surfaces.load("dome", resolution=20)
    found = make_start(surface, FitSpec(target="dome", tessellation="truncated-square", tiles=60)).feasibility
    assert found.given.name == "truncated-square" and len(found.asked) == len(surface.vertices)
    assert "not enough on" in found.sentence and "would do" in found.advice
    snapping = make_start(surface, FitSpec(target="dome", tessellation="islamic-quad", tiles=60)).feasibility
    assert "snaps" in snapping.sentence
    enough = make_start(surface, FitSpec(target="dome", tiles=60)).feasibility
    assert enough.is_met and enough.sentence.endswith("that is enough.")
