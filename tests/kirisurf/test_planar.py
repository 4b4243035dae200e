"""Fits of planar targets: every row holds, tips lie on the outline, and the result moves with the target."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from kirisurf.judging import certified
from kirisurf.outlines import Outline, outline
from kirisurf.pipeline import FitResult, fit_surface
from kirisurf.rim import rectangle_rim
from kirisurf.soundness import are_apart
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.targets import flat_target

RIGID = ("length", "angle", "planarity", "isometry", "closure", "boundary")


def fitted(curve: Outline, **options: object) -> tuple[FitResult, FitSpec]:
    spec = FitSpec(target=curve.name, **options)
    return fit_surface(flat_target(curve), spec), spec


def check_passed(result: FitResult, spec: FitSpec) -> None:
    """Every row of the certificate, and what it does not say: the deployed tiles lie side by side."""
    assert result.fit.status is Status.CONVERGED
    found = certified(
        spec,
        result.fit.points,
        result.contracted.points,
        result.tessellation.tiles,
        result.surface,
        None,
        (result.boundary, result.contracted_boundary),
    )
    assert found.passed, found.failures
    assert all(found.rows[row] <= 1e-9 for row in RIGID)
    assert (result.fit.points[:, 2] == 0).all()
    assert are_apart(result.tessellation, result.fit.points[:, :2])
    curve = result.surface.outline
    apart = np.abs(curve.project(result.fit.points[result.boundary.vertices, :2]).distances)
    assert apart.max() <= 1e-9 * result.fit.edge_length


@pytest.mark.parametrize(
    ("name", "tessellation", "cells"),
    [
        ("circle", "quad", (2, 2)),
        ("egg", "quad", (3, 3)),
        ("circle", "kagome", (2, 2)),
        ("egg", "hexagon", (2, 2)),
        ("rect", "islamic-quad", (2, 2)),
        ("disc", "trihexagonal", (2, 2)),
    ],
)
def test_rectangular_patterns_fill_outlines(name: str, tessellation: str, cells: tuple[int, int]) -> None:
    result, spec = fitted(outline(name), tessellation=tessellation, cells=cells)
    check_passed(result, spec)
    # tips of each side on their side of the outline, not on another
    assert (result.boundary.distances(result.fit.points) <= 1e-9 * result.fit.edge_length).all()
    assert result.freedom is not None and result.freedom > 0


@pytest.mark.parametrize(("name", "tessellation"), [("disc", "quad"), ("heart", "quad")])
def test_trimmed_patterns_fill_outlines(name: str, tessellation: str) -> None:
    result, spec = fitted(outline(name), tessellation=tessellation, tiles=60)
    check_passed(result, spec)
    if name == "heart":
        # every corner of the outline has a tip on it
        apart = np.linalg.norm(outline(name).corners[:, None] - result.fit.points[:, :2], axis=2).min(axis=1)
        assert apart.max() <= 1e-9 * result.fit.edge_length


@pytest.mark.parametrize(("shape", "ratio"), [("rectangle", None), ("rectangle:1.3", 1.3)])
def test_contracted_rectangles(shape: str, ratio: float | None) -> None:
    result, spec = fitted(outline("circle"), cells=(2, 2), contracted=shape)
    check_passed(result, spec)
    flat, rim = result.contracted.points, rectangle_rim(result.tessellation.contracted)
    low, high = flat.min(axis=0), flat.max(axis=0)
    for k, (axis, bound) in enumerate(((1, low[1]), (0, high[0]), (1, high[1]), (0, low[0]))):
        np.testing.assert_allclose(flat[rim.side(k), axis], bound, atol=1e-9 * result.fit.edge_length)
    if ratio is not None:
        width, height = high - low
        assert width / height == pytest.approx(ratio, abs=1e-9)


@pytest.mark.parametrize("name", ["egg", "star"])
def test_contracted_outlines(name: str) -> None:
    """The contracted rim lies on an outline of that shape, upright and in any size."""
    result, spec = fitted(outline("circle"), cells=(2, 2), contracted=name)
    check_passed(result, spec)
    followed = result.contracted_boundary
    assert followed is not None
    assert followed.distances(result.contracted.points).max() <= 1e-9 * result.fit.edge_length
    size = np.sqrt(followed.outline.area / outline(name).area)
    np.testing.assert_allclose(np.ptp(followed.outline.box, axis=0), size * np.ptp(outline(name).box, axis=0))


@pytest.mark.parametrize("motion", ["moved", "grown"])
def test_the_sheet_moves_with_the_outline(motion: str) -> None:
    curve = outline("egg")
    matrix, shift = {
        "moved": (np.eye(2), np.array([30.0, -20.0])),
        "grown": (1e4 * np.eye(2), np.zeros(2)),
    }[motion]
    first, second = (fitted(o, cells=(2, 2))[0] for o in (curve, curve.transformed(matrix, shift)))
    assert first.fit.status is second.fit.status is Status.CONVERGED
    unit = second.fit.edge_length
    expected = first.fit.points[:, :2] @ matrix.T + shift
    np.testing.assert_allclose(second.fit.points[:, :2], expected, atol=1e-6 * unit)


def test_a_turned_outline_is_filled_too() -> None:
    c, s = np.cos(0.4), np.sin(0.4)
    check_passed(*fitted(outline("egg").transformed([[c, -s], [s, c]], [1.0, 2.0]), cells=(2, 2)))


def test_what_cannot_be_ends_honestly() -> None:
    """Two by two squares cannot make a circle, and contracted a rectangle of 50 to 1."""
    result, _ = fitted(outline("circle"), cells=(1, 1), contracted="rectangle:50", max_seconds=4.0)
    assert result.fit.status not in (Status.CONVERGED, Status.STEP_LIMIT)
    assert np.isfinite(result.fit.points).all() and np.isfinite(result.contracted.points).all()
    assert any("% of the way" in note for note in result.notes)


@pytest.mark.parametrize("limit", [{"max_steps": 4}, {"max_seconds": 1e-3}])
def test_limits_hold_for_all_parts_of_the_way_together(limit: dict[str, float]) -> None:
    result, _ = fitted(outline("star"), cells=(2, 2), **limit)
    assert result.fit.status in (Status.STEP_LIMIT, Status.TIME_LIMIT)
    # each of at most five solves also records where it began
    assert len(result.fit.history) <= 4 + 5


def test_interrupted_on_the_way_keeps_a_sheet() -> None:
    result = fit_surface(flat_target(outline("star")), FitSpec(target="star", cells=(2, 2)), should_stop=lambda: True)
    assert result.fit.status is Status.INTERRUPTED
    assert np.isfinite(result.fit.points).all()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"tiles": 60, "contracted": "rectangle"}, "--cells"),
        ({"cells": (2, 2), "contracted": "eg"}, "did you mean 'egg'"),
    ],
)
def test_options_that_do_not_go_together_are_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        fitted(outline("circle"), **options)


@pytest.mark.parametrize("name", ["star", "disc", "heart"])
def test_the_flat_sheet_follows_an_outline_with_and_without_corners(name: str) -> None:
    spec = FitSpec(target="circle", cells=(2, 2), contracted=name)
    result = fit_surface(flat_target(outline("circle")), spec)
    assert result.fit.status is Status.CONVERGED
    assert result.contracted_boundary is not None
    distances = result.contracted_boundary.distances(result.contracted.points)
    assert distances.max() <= 1e-9 * result.fit.edge_length
    # an outline without corners leaves those of the rectangular pattern outside, which is said
    assert any("flat sheet lie outside" in said for said in result.warnings) == (name != "star")
