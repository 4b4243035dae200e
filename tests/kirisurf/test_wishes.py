"""Preferences: what is wished for improves, no row breaks, and the sheet stays one that passes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kirisurf.design import Design, fit
from kirisurf.errors import ParameterError
from kirisurf.refit import can_refit
from kirisurf.sizes import slit_openings, tile_edges
from kirisurf.soundness import are_apart
from kirisurf.spec import PREFERENCES
from kirisurf.start import make_start
from kirisurf.status import Status
from kirisurf.wishes import preference

ROWS = ("length", "angle", "isometry", "closure", "boundary", "planarity")
WISHES = [name for name in PREFERENCES if name not in ("balanced", "curvature")]


@cache
def balanced(target: str, cells: int, tessellation: str) -> Design:
    return fit(target, cells=(cells, cells), tessellation=tessellation)


def differences(design: Design) -> float:
    """Root mean square difference of edges and diagonals of the same tile in neighboring cells, over the mean edge."""
    t, points = design.tessellation, design.contracted_points
    place = {tuple(cell): points[tile] for cell, tile in zip(t.cells.tolist(), t.tiles, strict=True)}
    found = []
    for (column, row, k), corners in place.items():
        shape = np.linalg.norm(corners[:, None] - corners, axis=2)
        for other in ((column + 1, row, k), (column, row + 1, k)):
            if other in place:
                found.append(shape - np.linalg.norm(place[other][:, None] - place[other], axis=2))
    return float(np.sqrt(np.mean(np.square(found))))


def reached(design: Design) -> float:
    outer = design.tessellation.outline
    return float(np.linalg.norm(design.surface.outline.project(design.deployed_points[outer, :2]).distances))


def openness(design: Design) -> float:
    """Root mean square difference of the openings from a right angle: wider, the holes of squares close again."""
    openings = slit_openings(design.tessellation, design.deployed_points)
    return float(np.sqrt(np.mean((openings - np.pi / 2) ** 2)))


def unevenness(design: Design) -> float:
    """Spread of edge lengths of one role: the same side of the same tile of the cell."""
    t = design.tessellation
    length = tile_edges(t, design.deployed_points)
    side = np.arange(len(length)) - t.tiles.offsets[t.tiles.owners]
    role = t.cells[t.tiles.owners, 2] * 10 + side
    return float(np.sqrt(np.mean([np.var(length[role == r]) for r in np.unique(role)]))) / float(length.mean())


MEASURES = {"smoothest": differences, "nearest": reached, "open": openness, "uniform": unevenness}


@pytest.mark.parametrize("name", WISHES)
def test_what_is_wished_for_improves_and_every_row_holds(name: str) -> None:
    before, pulled = balanced("egg", 2, "quad"), fit("egg", cells=(2, 2), prefer=name)
    measure = MEASURES[name]
    assert measure(pulled) < measure(before) - 0.02 * abs(measure(before))
    assert pulled.status is Status.CONVERGED and pulled.certificate.passed, pulled.certificate.failures
    assert all(pulled.certificate.rows[row] <= 1e-9 for row in ROWS)
    assert are_apart(pulled.tessellation, pulled.deployed_points[:, :2])
    (said,) = (note for note in pulled.notes if note.startswith("Preference"))
    assert name in said and "nothing was gained" not in said


def test_smoothest_gains_where_a_strong_pull_fails() -> None:
    """Pulled with full strength at once this sheet leaves the rows and does not find back."""
    pulled = fit("circle", cells=(3, 3), tessellation="kagome", prefer="smoothest")
    assert pulled.certificate.passed
    assert differences(pulled) < 0.9 * differences(balanced("circle", 3, "kagome"))


@pytest.mark.parametrize("name", ["open", "uniform"])
def test_curved_targets_have_preferences_too(name: str) -> None:
    before, pulled = (fit("hypar", cells=(2, 2), prefer=p, max_opening=170.0) for p in ("balanced", name))
    assert pulled.certificate.passed, pulled.certificate.failures
    assert MEASURES[name](pulled) < MEASURES[name](before)


def bent(design: Design) -> float:
    """Median part of the holes' Gaussian curvature that is the fit's."""
    return design.measures.numbers["gaussian_curvature_from_fit_median"]


@pytest.mark.parametrize(("target", "tessellation"), [("hypar", "quad"), ("peaks", "quad"), ("hypar", "kagome")])
def test_holes_of_a_pulled_sheet_are_curved_as_the_target_is(target: str, tessellation: str) -> None:
    options = {"cells": (4, 4), "tessellation": tessellation}
    before, pulled = fit(target, **options), fit(target, prefer="curvature", **options)
    assert pulled.certificate.passed, pulled.certificate.failures
    assert bent(pulled) < 0.5 * bent(before)
    assert pulled.certificate.rows["distance_rms"] < 0.02
    (said,) = (note for note in pulled.notes if note.startswith("Preference"))
    assert "curvature" in said and "nothing was gained" not in said


def test_curvature_is_preferred_also_among_sheets_with_both_states_unknown() -> None:
    before, pulled = (fit("hypar", cells=(3, 3), prefer=p, max_opening=170.0) for p in ("balanced", "curvature"))
    assert pulled.certificate.passed, pulled.certificate.failures
    assert bent(pulled) < 0.5 * bent(before)


def test_fits_with_a_preference_are_not_refitted_as_if_they_had_none() -> None:
    design = fit("hypar", cells=(2, 2))
    start = make_start(design.surface, design.spec)
    assert can_refit(design.surface, design.spec, start)
    for name in (name for name in PREFERENCES if name != "balanced"):
        assert not can_refit(design.surface, replace(design.spec, prefer=name), start)


def test_a_sheet_on_its_target_leaves_nothing_to_prefer() -> None:
    before, pulled = (fit("hypar", cells=(2, 2), closeness="exact", prefer=p) for p in ("balanced", "curvature"))
    np.testing.assert_array_equal(pulled.deployed_points, before.deployed_points)
    assert any(note.startswith("Preference") and note.endswith("there were none.") for note in pulled.notes)


def test_planar_targets_have_no_curvature_to_prefer() -> None:
    design = fit("circle", cells=(2, 2), prefer="curvature")
    assert design.certificate.passed, design.certificate.failures
    assert any("a planar target has none" in note for note in design.notes)
    with pytest.raises(ParameterError, match="expected a curved target"):
        preference("curvature", design.tessellation, design.deployed_points, design.surface.outline)


def test_a_sheet_that_meets_no_rows_is_not_pulled() -> None:
    design = fit("circle", cells=(2, 2), prefer="open", max_steps=1)
    assert design.status is Status.STEP_LIMIT
    assert not any(note.startswith("Preference") for note in design.notes)
    assert len(design.result.fit.history) <= 3


def asked(design: Design) -> dict[str, float]:
    """Smallest corner and largest opening in degrees, and smallest edge over the median, measured from the points."""
    t, x = design.tessellation, design.deployed_points
    before, here, after = x[t.corners].transpose(1, 0, 2)
    u, v = before - here, after - here
    corner = np.arccos((u * v).sum(1) / np.linalg.norm(u, axis=1) / np.linalg.norm(v, axis=1))
    edges = tile_edges(t, x)
    return {
        "min_corner": float(np.degrees(corner.min())),
        "max_opening": float(np.degrees(slit_openings(t, x).max())),
        "min_edge": float(edges.min() / np.median(edges)),
        "min_angle": float(np.degrees(slit_openings(t, x).min())),
    }


@pytest.mark.parametrize(("name", "value"), [("min_corner", 60.0), ("max_opening", 50.0), ("min_edge", 0.7)])
def test_sizes_that_are_asked_for_are_honored(name: str, value: float) -> None:
    free, design = asked(balanced("circle", 3, "quad")), fit("circle", cells=(3, 3), **{name: value})
    found = asked(design)
    sign = -1 if name.startswith("max") else 1
    assert sign * found[name] >= sign * value - 1e-6
    # the wish is one: without it the sheet is another
    assert sign * free[name] < sign * value
    assert design.certificate.passed, design.certificate.failures


@pytest.mark.parametrize(("name", "value"), [("min_edge", 1.0), ("min_angle", 88.0)])
def test_sizes_that_cannot_be_are_not_passed_off(name: str, value: float) -> None:
    """A circle of squares of one size, or all of them fully open: there is none."""
    design = fit("circle", cells=(2, 2), max_seconds=3.0, **{name: value})
    assert design.status is not Status.CONVERGED or not design.certificate.passed
    assert design.deployed_points.shape == (design.tessellation.n_vertices, 3)
    assert np.isfinite(design.deployed_points).all()
