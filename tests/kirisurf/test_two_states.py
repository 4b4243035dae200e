"""The problem with both states: the regular pattern solves it, and where both apply it says what the other one says."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.contract import contract
from kirisurf.contracted_shape import ContractedShape
from kirisurf.contracted_solution import laid_start
from kirisurf.formulation import Formulation, Weights
from kirisurf.pattern import quad_pattern
from kirisurf.pipeline import fit_surface
from kirisurf.problem import Problem
from kirisurf.scaling import unit_scale
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.tessellation import Tessellation
from kirisurf.two_states import Shape, TwoStates
from tests.kirisurf.block_laws import check_block
from tests.kirisurf.both_states import NAMES, bumpy, regular, regular_points, turned


def problem(tessellation: Tessellation, points: np.ndarray, shape: Shape | None = None) -> Problem:
    return TwoStates(tessellation, points, None, Weights(), shape or Shape()).problem_at(points)


@pytest.mark.parametrize("name", NAMES)
def test_the_regular_pattern_meets_every_row(name: str) -> None:
    tessellation = regular(name, 3, 2)
    points = regular_points(tessellation)
    found = problem(tessellation, points)
    np.testing.assert_allclose(found.equality_rows(points), 0.0, atol=1e-12)
    assert found.inequality_rows(points).min() > 0
    # and fairly: nothing pulls it away
    assert np.abs(found.gradient(points)).max() < 1e-12


@pytest.mark.parametrize("name", ["quad", "islamic-triangle"])
def test_every_block_of_the_problem_obeys_the_laws(name: str) -> None:
    tessellation = regular(name)
    points = bumpy(regular_points(tessellation), noise=0.02)
    found = problem(tessellation, points, Shape(0.1, 0.05, 1.5, 0.5))
    for block in (*found.equalities, *found.inequalities, *(term.block for term in found.terms)):
        if len(block.stencil):
            check_block(block, points, invariant=False)


@pytest.mark.parametrize("name", NAMES)
def test_rows_do_not_depend_on_where_either_state_lies(name: str) -> None:
    tessellation = regular(name)
    points = bumpy(regular_points(tessellation), noise=0.02)
    n = tessellation.n_vertices
    moved = np.vstack([turned(points[:n], 0.8, (2, 3)), turned(points[n:], -1.9, (-4, 1))])
    found = problem(tessellation, points)
    np.testing.assert_allclose(found.equality_rows(moved), found.equality_rows(points), atol=1e-10)
    np.testing.assert_allclose(found.inequality_rows(moved), found.inequality_rows(points), atol=1e-10)


@pytest.mark.parametrize("tessellation", ["quad", "kagome"])
def test_both_problems_have_the_same_sheets(tessellation: str) -> None:
    """A sheet of either problem is one of the other: its contracted points are those that contraction finds."""
    surface = sample_surfaces.load("hypar", resolution=16)
    spec = FitSpec(target="hypar", cells=(2, 2), tessellation=tessellation)
    for both in (False, True):
        result = fit_surface(surface, spec.changed(max_opening=175.0) if both else spec)
        assert result.fit.status is Status.CONVERGED
        pattern = result.tessellation
        frame, scaled = unit_scale(surface, pattern, result.fit.points)
        points = frame.into(result.fit.points)
        one = Formulation(pattern, points, scaled, Weights()).problem_at(points)
        np.testing.assert_allclose(one.equality_rows(points), 0.0, atol=1e-10)
        full = laid_start(pattern, points, ContractedShape())
        two = TwoStates(pattern, full, scaled, Weights(), Shape()).problem_at(full)
        np.testing.assert_allclose(two.equality_rows(full), 0.0, atol=1e-9)
        # a point that is none breaks rows of both
        off = bumpy(full, noise=1e-3)
        assert np.abs(one.equality_rows(off[: pattern.n_vertices])).max() > 1e-5
        assert np.abs(two.equality_rows(off)).max() > 1e-5


def test_contraction_is_laid_on_given_points() -> None:
    pattern = quad_pattern(2, 2, 0.5)
    points = np.column_stack([pattern.deployed, np.zeros(pattern.n_vertices)])
    like = turned(np.column_stack([pattern.contracted, np.zeros(len(points))]), 0.6, (9, -4))[:, :2]
    np.testing.assert_allclose(contract(pattern, points, like=like).points, like, atol=1e-12)
