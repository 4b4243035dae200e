"""Reproduced designs: the numbers of a table, the verdict on them, and the law of the boundary layer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirisurf.published import configurations
from kirisurf.reproducing import Numbers, Reproduced, Wanted, all_reproduced, exponent, reproduced
from kirisurf.reproducing_figures import FIGURES, Law, circling
from kirisurf.spec import FitSpec

SMALL = [Wanted("one", FitSpec(target="rect", cells=(1, 2))), Wanted("two", FitSpec(target="shear", cells=(2, 2)))]


def numbers(**changes: object) -> Numbers:
    rows = {"length": 1e-12, "angle": 2e-12, "planarity": 0.0, "isometry": 3e-12, "closure": 1e-13, "min_edge": 0.3}
    return Numbers.of({**rows, **changes}, (), False, True)  # type: ignore[arg-type]


def result(status: str = "CONVERGED", found: Numbers | None = None, tiles: int = 4, **measures: float) -> Reproduced:
    return Reproduced("x", status, tiles, 1.0, found, measures, None, "" if found else "no such target")


def test_numbers_are_the_largest_of_their_rows() -> None:
    found = numbers(loop=5e-11, boundary=7e-10)
    assert (found.rigid, found.isometry, found.closure, found.largest) == (3e-12, 3e-12, 5e-11, 7e-10)
    assert found.contracted_boundary is None and found.distance_rms is None
    assert math.isinf(numbers(isometry=None).isometry)


@pytest.mark.parametrize(
    ("tried", "words"),
    [
        (result(found=numbers()), ""),
        (result(found=numbers(angle=2e-9)), "rows: expected at most 1e-09, got 2e-09"),
        (result(found=numbers(contracted_boundary=0.07)), "rows: expected at most 1e-09, got 0.07"),
        (result(found=numbers(min_edge=0.04)), "smallest edge: expected at least 0.05, got 0.04"),
        (result("STALLED", numbers()), "Stalled"),
        (result("FAILED"), "no such target"),
    ],
)
def test_the_verdict_names_what_is_missing(tried: Reproduced, words: str) -> None:
    assert bool(tried.shortcomings) == bool(words)
    assert words in "; ".join(tried.shortcomings)


def test_a_design_is_returned_with_its_shape_and_an_impossible_one_with_the_reason() -> None:
    made, design = reproduced(Wanted.of(configurations("2d")[14]))
    assert made.name == "quad_circle_2x2_1" and not made.shortcomings
    assert design is not None and made.shape is not None and made.numbers is not None
    assert made.numbers.boundary is not None and made.numbers.contracted_boundary is not None
    assert np.bincount(made.shape.tones).tolist() == [8, 8]
    square = np.ptp(made.shape.contracted, axis=0)
    assert square[0] == pytest.approx(square[1], rel=1e-9)
    made, design = reproduced(Wanted("moon", FitSpec(target="moon", cells=(2, 2))))
    assert design is None and made.status == "FAILED" and "'moon'" in made.shortcomings[0]


@pytest.mark.slow
def test_several_processes_make_the_same_designs() -> None:
    alone = {each.name: each for each in all_reproduced(SMALL)}
    shared = {each.name: each for each in all_reproduced(SMALL, jobs=2)}
    assert set(shared) == set(alone) == {"one", "two"}
    for name, each in alone.items():
        assert each.shape is not None and shared[name].shape is not None
        np.testing.assert_allclose(shared[name].shape.deployed, each.shape.deployed, atol=1e-9)


def test_the_exponent_of_a_power_is_found() -> None:
    n = np.array([1.0, 3.0, 10.0, 40.0])
    assert exponent(n.tolist(), (7 * n**-0.75).tolist()) == pytest.approx(-0.75)


def test_the_law_is_that_of_the_designs_that_were_reproduced() -> None:
    def sheet(n: int, found: Numbers) -> Reproduced:
        values = {"boundary_layer_area": 1 / n, "gap_base_mean": 2 / n, "gap_height_mean": 3 / n}
        return result(found=found, tiles=n * n, **values)

    law = Law.of([sheet(8, numbers()), sheet(2, numbers()), sheet(4, numbers(angle=1.0))])
    assert law.tiles == (4, 64)
    assert [law.area_exponent, law.base_exponent, law.height_exponent] == pytest.approx([-0.5, -1.0, -1.0])


def test_figures_ask_for_what_they_show() -> None:
    assert [wanted.spec.cells for wanted in circling(5)] == [(2, 2), (3, 3), (4, 4), (5, 5)]
    assert circling()[-1].spec.cells == (20, 20)
    assert {wanted.spec.contracted for wanted in FIGURES["fig2a"]} == {"rectangle:1"}


@pytest.mark.slow
def test_the_boundary_layer_of_the_circled_square_falls_with_the_root_of_the_number_of_tiles() -> None:
    """Fig. 2c: area ~ (number of tiles)^(-1/2), base and height of a gap ~ 1 / (tiles along a side)."""
    results = list(all_reproduced([wanted for wanted in circling(6) if wanted.spec.cells in ((3, 3), (4, 4), (6, 6))]))
    assert [each.shortcomings for each in results] == [(), (), ()]
    law = Law.of(results)
    assert law.area_exponent == pytest.approx(-0.5, abs=0.05)
    assert law.base_exponent == pytest.approx(-1.0, abs=0.1)
    assert law.height_exponent == pytest.approx(-1.0, abs=0.1)
